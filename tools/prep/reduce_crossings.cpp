// SPDX-License-Identifier: AGPL-3.0-or-later
#include "prep/reduce_crossings.hpp"

#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <utility>

#include "prep/box.hpp"
#include "prep/flips.hpp"
#include "prep/take_tets.hpp"

namespace tetprep {
namespace {

using Face = std::array<Index, 3>;

/// Optimize::fast considers a flip only if the faces that it would replace have this many times the area that
/// there is per tetrahedron: large faces are few and hold most of the area. On the armadillo (52,000
/// triangles) that is a tenth of the flips and of the time, and rays then cross 5 to 15 % more tetrahedra
/// than with all.
constexpr double kWorthwhile = 5;
/// Tets whose flips are looked for at the same time, by all threads, before any of these is made. A constant,
/// for the result depends on it.
constexpr std::size_t kBatch = 16384;

Face face_of(const std::array<Index, 4>& tet, std::size_t opposite) {
  Face face{};
  for (std::size_t k = 0, n = 0; k < 4; ++k)
    if (k != opposite) face[n++] = tet[k];
  return face;
}

Face sorted(Face face) {
  std::sort(face.begin(), face.end());
  return face;
}

/// Carries out flips, and keeps the rest of the mesh in step.
class Flipper {
 public:
  explicit Flipper(TetMesh& mesh) : mesh_(mesh), original_(static_cast<Index>(mesh.tets.size())) {}

  /// The tets that have come, until the next call. All of flip.old_tets must still be there.
  const std::vector<Index>& apply(const Flip& flip) {
    rim_.clear();
    for (const Index t : flip.old_tets) {
      for (std::size_t k = 0; k < 4; ++k) {
        const Index outside = mesh_.neighbors[t][k];
        if (std::find(flip.old_tets.begin(), flip.old_tets.end(), outside) != flip.old_tets.end()) continue;
        rim_.push_back({sorted(face_of(mesh_.tets[t], k)), outside, mesh_.face_triangle[t][k]});
      }
    }
    made_.clear();
    for (std::size_t i = 0; i < flip.new_tets.size(); ++i) {
      made_.push_back(i < flip.old_tets.size() ? flip.old_tets[i] : fresh(flip.old_tets[0]));
      mesh_.tets[made_[i]] = flip.new_tets[i];
    }
    for (std::size_t i = flip.new_tets.size(); i < flip.old_tets.size(); ++i) {
      mesh_.tets[flip.old_tets[i]].fill(kNone);
      free_.push_back(flip.old_tets[i]);
    }
    for (const Index t : made_)
      for (std::size_t k = 0; k < 4; ++k) link(t, k);
    return made_;
  }

  bool is_gone(Index t) const { return mesh_.tets[t][0] == kNone; }

  /// Closes the gaps that removed tets have left. Added ones go where those were that they came from: the
  /// order follows space.
  void compact() {
    std::vector<Index> added(anchor_.size());
    for (std::size_t i = 0; i < added.size(); ++i) added[i] = static_cast<Index>(i);
    std::stable_sort(added.begin(), added.end(), [&](Index a, Index b) { return anchor_[a] < anchor_[b]; });
    std::vector<Index> left;
    left.reserve(mesh_.tets.size());
    auto next = added.begin();
    for (Index t = 0; t < original_; ++t) {
      if (!is_gone(t)) left.push_back(t);
      for (; next != added.end() && anchor_[*next] == t; ++next)
        if (const Index a = original_ + *next; !is_gone(a)) left.push_back(a);
    }
    take_tets(mesh_, left);
  }

 private:
  /// A face on the boundary of what is being replaced.
  struct Rim {
    Face face;  ///< ascending
    Index outside, triangle;
  };

  /// Finds what lies across face k of the new tet t: the rim's outside, or another new one.
  void link(Index t, std::size_t k) {
    const Face face = sorted(face_of(mesh_.tets[t], k));
    mesh_.face_triangle[t][k] = kNone;
    for (const Rim& rim : rim_) {
      if (rim.face != face) continue;
      mesh_.neighbors[t][k] = rim.outside;
      mesh_.face_triangle[t][k] = rim.triangle;
      if (rim.outside == kNone) return;
      for (std::size_t j = 0; j < 4; ++j) {
        const Index apex = mesh_.tets[rim.outside][j];
        if (std::find(face.begin(), face.end(), apex) == face.end()) mesh_.neighbors[rim.outside][j] = t;
      }
      return;
    }
    for (const Index other : made_) {
      if (other == t) continue;
      for (std::size_t j = 0; j < 4; ++j) {
        if (sorted(face_of(mesh_.tets[other], j)) != face) continue;
        mesh_.neighbors[t][k] = other;
        return;
      }
    }
  }

  /// A place for a new tet among the likes of tet `origin`.
  Index fresh(Index origin) {
    Index t = static_cast<Index>(mesh_.tets.size());
    if (!free_.empty()) {
      t = free_.back();
      free_.pop_back();
    } else {
      if (mesh_.tets.capacity() == mesh_.tets.size()) {  // doubling would take much memory for few tets
        const std::size_t room = mesh_.tets.size() + mesh_.tets.size() / 16 + 64;
        mesh_.tets.reserve(room);
        mesh_.neighbors.reserve(room);
        mesh_.face_triangle.reserve(room);
        mesh_.region.reserve(mesh_.region.empty() ? 0 : room);
      }
      mesh_.tets.emplace_back();
      mesh_.neighbors.emplace_back();
      mesh_.face_triangle.emplace_back();
      if (!mesh_.region.empty()) mesh_.region.emplace_back();
      anchor_.push_back(origin < original_ ? origin : anchor_[origin - original_]);
    }
    if (!mesh_.region.empty()) mesh_.region[t] = mesh_.region[origin];
    return t;
  }

  TetMesh& mesh_;
  Index original_;             ///< tets at the start; what was added has numbers from there on
  std::vector<Index> anchor_;  ///< of each added tet the original one that it came from, or near to it
  std::vector<Index> free_;    ///< places of tets that are gone
  std::vector<Rim> rim_;
  std::vector<Index> made_;
};

class Reducer {
 public:
  Reducer(TetMesh& mesh, Progress& progress) : mesh_(mesh), progress_(progress), flipper_(mesh) {}

  CrossingReport run(Optimize effort) {
    CrossingReport report;
    const double free_area = measure();
    // A flip replaces up to six faces that make up the threshold or more: one of them has a sixth of it.
    const double threshold =
        effort == Optimize::best ? 0 : kWorthwhile * free_area / static_cast<double>(mesh_.tets.size());
    const double large = threshold / 6;
    std::vector<Index> current, next;
    for (std::size_t t = 0; t < largest_face_.size(); ++t)
      if (largest_face_[t] >= large) current.push_back(static_cast<Index>(t));

    tbb::enumerable_thread_specific<FlipFinder> finders([&] { return FlipFinder(mesh_, threshold); });
    bool first_pass = true;
    const auto find = [&](Index t, Flip& flip) {
      if (flipper_.is_gone(t) || (!first_pass && largest_face(t) < large)) return false;
      // In the first pass, every ring is looked at from the first of its tets alone.
      const auto is_elsewhere = [&](Index other) {
        return first_pass && other < t && largest_face_[other] >= large;
      };
      return finders.local().find(t, is_elsewhere, flip);
    };

    double gained = 0;
    std::size_t done = 0, expected = current.size() + current.size() / 2;
    changed_.assign(mesh_.tets.size(), 0);
    queued_.assign(mesh_.tets.size(), 0);
    std::vector<Flip> flips(kBatch);
    std::vector<char> found(kBatch);
    // Every tet once, then those that flips have made, until none of them allows another flip. Finding takes
    // nearly all of the time, and changes nothing: all threads do it. Then the flips are made one by one.
    while (!current.empty()) {
      for (std::size_t first = 0; first < current.size(); first += kBatch) {
        const std::size_t count = std::min(kBatch, current.size() - first);
        tbb::parallel_for(std::size_t{0}, count,
                          [&](std::size_t i) { found[i] = find(current[first + i], flips[i]) ? 1 : 0; });
        ++batch_;
        for (std::size_t i = 0; i < count; ++i) {
          if (found[i] == 0) continue;
          // Another flip of this batch may have been faster.
          if (is_outdated(flips[i]) && !find(current[first + i], flips[i])) continue;
          gained += flips[i].gain;
          ++report.flips;
          make(flips[i], next);
        }
        done += count;
        progress_.fraction(std::min(1.0, static_cast<double>(done) / static_cast<double>(expected)));
      }
      current.swap(next);
      next.clear();
      first_pass = false;
      for (const Index t : current) queued_[t] = 0;
    }
    if (report.flips > 0) flipper_.compact();
    const double box = box_area();
    report.area_before = free_area / box;
    report.area_after = (free_area - gained) / box;
    return report;
  }

 private:
  void make(const Flip& flip, std::vector<Index>& next) {
    for (const Index t : flip.old_tets) changed_[t] = batch_;
    for (const Index t : flipper_.apply(flip)) {
      if (t >= changed_.size()) {
        changed_.resize(t + 1);
        queued_.resize(t + 1);
      }
      changed_[t] = batch_;
      if (std::exchange(queued_[t], 1) == 0) next.push_back(t);
    }
  }

  bool is_outdated(const Flip& flip) const {
    return std::any_of(flip.old_tets.begin(), flip.old_tets.end(),
                       [&](Index t) { return changed_[t] == batch_; });
  }

  double face_area(std::size_t t, std::size_t opposite) const {
    const Face f = face_of(mesh_.tets[t], opposite);
    return triangle_area(mesh_.points[f[0]], mesh_.points[f[1]], mesh_.points[f[2]]);
  }

  double largest_face(std::size_t t) const {
    return std::max({face_area(t, 0), face_area(t, 1), face_area(t, 2), face_area(t, 3)});
  }

  /// Makes every tet positive, fills largest_face_, and returns the area of all faces between two tets that
  /// no triangle constrains.
  double measure() {
    const std::size_t count = mesh_.tets.size();
    largest_face_.resize(count);
    std::vector<double> sums((count + kBatch - 1) / kBatch, 0.0);  // added in one order, whatever the threads
    tbb::parallel_for(std::size_t{0}, sums.size(), [&](std::size_t block) {
      for (std::size_t t = block * kBatch; t < std::min(count, (block + 1) * kBatch); ++t) {
        make_positive(t);
        double largest = 0;
        for (std::size_t k = 0; k < 4; ++k) {
          const double area = face_area(t, k);
          largest = std::max(largest, area);
          const bool free = mesh_.face_triangle[t][k] == kNone && mesh_.neighbors[t][k] != kNone;
          if (free) sums[block] += area / 2;  // the tet beyond has the other half
        }
        largest_face_[t] = static_cast<float>(largest);
      }
    });
    double sum = 0;
    for (const double part : sums) sum += part;
    return sum;
  }

  void make_positive(std::size_t t) {
    auto& v = mesh_.tets[t];
    const auto& p = mesh_.points;
    if (tetfmt::orientation(p[v[0]], p[v[1]], p[v[2]], p[v[3]]) > 0) return;
    std::swap(v[0], v[1]);
    std::swap(mesh_.neighbors[t][0], mesh_.neighbors[t][1]);
    std::swap(mesh_.face_triangle[t][0], mesh_.face_triangle[t][1]);
  }

  double box_area() const {
    const Box box = bounds_of(mesh_.points);
    std::array<double, 3> edge{};
    for (std::size_t k = 0; k < 3; ++k) edge[k] = box.high[k] - box.low[k];
    return 2 * (edge[0] * edge[1] + edge[1] * edge[2] + edge[2] * edge[0]);
  }

  TetMesh& mesh_;
  Progress& progress_;
  Flipper flipper_;
  std::vector<float> largest_face_;  ///< its area, of every tet at the start
  std::vector<Index> changed_;       ///< the last batch that changed a tet
  Index batch_ = 0;
  std::vector<char> queued_;  ///< tets of the next pass
};

}  // namespace

CrossingReport reduce_crossings(TetMesh& mesh, Optimize effort, Progress& progress) {
  if (effort == Optimize::none) return {};
  return Reducer(mesh, progress).run(effort);
}

}  // namespace tetprep
