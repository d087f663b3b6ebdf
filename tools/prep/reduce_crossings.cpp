// SPDX-License-Identifier: AGPL-3.0-or-later
#include "prep/reduce_crossings.hpp"

#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>

#include "prep/box.hpp"
#include "prep/cone_finder.hpp"
#include "prep/replace_tets.hpp"

namespace tetprep {
namespace {

/// Tets at whose corners cones are looked for at the same time, by all threads, before any of these is made.
/// A constant, for the result depends on it.
constexpr std::size_t kBatch = 1024;
/// Tets that one task measures.
constexpr std::size_t kPart = 4096;
/// Optimize::fast looks at the corners of this share of the tets, those with the largest faces: they hold
/// much of the area.
constexpr double kFastShare = 0.02;
/// There, a face in a space that surfaces close off from the outside counts for this share of its size: no
/// ray enters an opaque solid.
constexpr double kInside = 0.25;
/// Rounds over what has changed: each gains less than the one before.
constexpr int kFastRounds = 10, kBestRounds = 16;
/// Grids of which Optimize::best tries every cell for a new vertex have 2^level cells along the box, from
/// here on, and in all at most one for so many tets.
constexpr int kFirstLevel = 2;
constexpr std::size_t kTetsPerCell = 32;

class Reducer {
 public:
  Reducer(TetMesh& mesh, Progress& progress)
      : mesh_(mesh), progress_(progress), replacer_(mesh), finders_([&] { return ConeFinder(mesh_); }) {}

  CrossingReport run(Optimize effort) {
    const double box = box_area();
    report_.area_before = measure() / box;
    const std::vector<bool> used = used_points();
    changed_.assign(mesh_.tets.size(), 0);
    round_.assign(mesh_.tets.size(), 0);
    // Large faces first: what becomes of the small ones depends on them.
    improve(area_of_share(kFastShare), kFastRounds, 0, effort == Optimize::best ? 0.3 : 1);
    if (effort == Optimize::best) {
      const std::size_t most_cells = mesh_.tets.size() / kTetsPerCell;
      for (int level = kFirstLevel; std::size_t{1} << 3 * level <= most_cells; ++level) add_points(level);
      improve(0, kBestRounds, 0.4, 1);
    }
    close_gaps(mesh_);
    drop_points(used);
    report_.area_after = report_.area_before - gained_ / box;
    return report_;
  }

 private:
  /// Looks at the corners of all tets with a free face of at least `least_area`, then at those of such tets
  /// that have come, for so many rounds or until nothing is found. Progress goes from `start` to `end`.
  void improve(float least_area, int rounds, double start, double end) {
    std::vector<Index> current, next;
    for (std::size_t t = 0; t < mesh_.tets.size(); ++t)
      if (is_worth_a_look(static_cast<Index>(t), least_area)) current.push_back(static_cast<Index>(t));
    std::vector<std::array<Cone, 4>> cones(kBatch);
    for (int round = 0; round < rounds && !current.empty(); ++round) {
      ++this_round_;
      for (const Index t : current) round_[t] = this_round_;
      // A batch is spread over all of space, so that few cones of it meet. Finding takes nearly all of the
      // time, and changes nothing: all threads do it. Then the replacements are made one by one.
      const std::size_t batches = (current.size() + kBatch - 1) / kBatch;
      for (std::size_t batch = 0; batch < batches; ++batch) {
        const std::size_t count = (current.size() - batch + batches - 1) / batches;
        const auto tet = [&](std::size_t i) { return current[batch + i * batches]; };
        tbb::parallel_for(std::size_t{0}, count, [&](std::size_t i) { find(tet(i), cones[i]); });
        ++this_batch_;
        for (std::size_t i = 0; i < count; ++i) {
          for (const Cone& cone : cones[i]) {
            if (cone.tets.empty()) continue;
            if (!is_outdated(cone)) {
              make(cone, least_area, next);
            } else if (is_worth_a_look(tet(i), least_area)) {
              next.push_back(tet(i));  // another one was faster
            }
          }
        }
        const double done = (round + static_cast<double>(batch + 1) / static_cast<double>(batches)) / rounds;
        progress_.fraction(start + (end - start) * std::sqrt(done));  // each round is shorter
      }
      std::sort(next.begin(), next.end());
      next.erase(std::unique(next.begin(), next.end()), next.end());
      std::erase_if(next, [&](Index t) { return is_gap(mesh_, t); });
      current.swap(next);
      next.clear();
    }
  }

  bool is_worth_a_look(Index t, float least_area) const {
    return !is_gap(mesh_, t) && worth(t) >= least_area;
  }

  /// Of a look at tet t: the area of its largest free face, or less. Of one precision, so that equal faces
  /// are.
  float worth(Index t) const {
    const bool outside = mesh_.region.empty() || mesh_.region[t] == 0;
    return static_cast<float>((outside ? 1 : kInside) * largest_free_face(mesh_, t));
  }

  void find(Index t, std::array<Cone, 4>& cones) {
    // Every vertex is looked at from the first of its tets alone.
    const auto is_elsewhere = [&](Index other) { return other < t && round_[other] == this_round_; };
    ConeFinder& finder = finders_.local();
    for (std::size_t k = 0; k < 4; ++k)
      if (is_gap(mesh_, t) || round_[t] != this_round_ || !finder.find(t, k, is_elsewhere, cones[k]))
        cones[k].tets.clear();
  }

  bool is_outdated(const Cone& cone) const {
    return std::any_of(cone.tets.begin(), cone.tets.end(),
                       [&](Index t) { return changed_[t] == this_batch_; });
  }

  void make(const Cone& cone, double least_area, std::vector<Index>& next) {
    for (const Index t : cone.tets) changed_[t] = this_batch_;
    for (const Index t : replacer_.apply(cone)) {
      if (t >= changed_.size()) {
        changed_.resize(t + 1);
        round_.resize(t + 1);
      }
      changed_[t] = this_batch_;
      round_[t] = 0;
      if (worth(t) >= least_area) next.push_back(t);
    }
    gained_ += cone.gain;
    ++report_.replacements;
  }

  /// Tries a new vertex in the middle of every cell of a grid, with 2^level cells along the box.
  void add_points(int level) {
    const Box box = bounds_of(mesh_.points);
    const double edge = std::ldexp(box.extent(), -level);
    std::array<int, 3> cells{};
    for (std::size_t k = 0; k < 3; ++k)
      cells[k] = std::max(1, static_cast<int>(std::ceil((box.high[k] - box.low[k]) / edge)));
    struct Place {
      Index tet;
      GridPoint point;
    };
    std::vector<Place> places;
    Index t = 0;
    for (int x = 0; x < cells[0]; ++x) {
      for (int y = 0; y < cells[1]; ++y) {
        for (int z = 0; z < cells[2]; ++z) {
          // Back and forth, so that the way from each to the next is short.
          const std::array<int, 3> cell{x, x % 2 == 0 ? y : cells[1] - 1 - y,
                                        (x * cells[1] + y) % 2 == 0 ? z : cells[2] - 1 - z};
          GridPoint point{};
          for (std::size_t k = 0; k < 3; ++k)
            point[k] = box.low[k] + static_cast<std::int32_t>(
                                        std::lround((cell[k] + 0.5) * (box.high[k] - box.low[k]) / cells[k]));
          if (walk_to(point, t)) places.push_back({t, point});
        }
      }
    }
    std::vector<Cone> cones(kBatch);
    std::vector<Index> ignored;
    const std::size_t batches = (places.size() + kBatch / 4 - 1) / (kBatch / 4);
    for (std::size_t batch = 0; batch < batches; ++batch) {
      const std::size_t count = (places.size() - batch + batches - 1) / batches;
      const auto place = [&](std::size_t i) -> Place& { return places[batch + i * batches]; };
      tbb::parallel_for(std::size_t{0}, count, [&](std::size_t i) {
        cones[i].tets.clear();
        if (!is_gap(mesh_, place(i).tet))
          if (!finders_.local().find_new(place(i).tet, place(i).point, cones[i])) cones[i].tets.clear();
      });
      ++this_batch_;
      for (std::size_t i = 0; i < count; ++i) {
        if (cones[i].tets.empty() || is_outdated(cones[i])) continue;
        cones[i].apex = static_cast<Index>(mesh_.points.size());
        make(cones[i], 0, ignored);
        ++report_.new_points;
      }
    }
  }

  /// Walks from tet t (or another, if it is gone) to the one that holds `place`, through faces of all kinds.
  bool walk_to(const GridPoint& place, Index& t) const {
    while (is_gap(mesh_, t)) t = static_cast<Index>((t + 1) % mesh_.tets.size());
    constexpr std::size_t kMostSteps = 10000;
    for (std::size_t step = 0; step < kMostSteps; ++step) {
      const auto& v = mesh_.tets[t];
      const auto& p = mesh_.points;
      std::size_t beyond = 4;
      for (std::size_t i = 0; i < 4 && beyond == 4; ++i) {
        const std::size_t k = (i + step) % 4;  // in turn: so it does not go in circles
        const auto& face = kFaceCorners[k];
        if (tetfmt::orientation(p[v[face[0]]], p[v[face[1]]], p[v[face[2]]], place) < 0) beyond = k;
      }
      if (beyond == 4) return true;
      if (mesh_.neighbors[t][beyond] == kNone) return false;
      t = mesh_.neighbors[t][beyond];
    }
    return false;
  }

  /// What a look is worth at `share` of the tets, or more.
  float area_of_share(double share) const {
    std::vector<float> areas(mesh_.tets.size());
    tbb::parallel_for(std::size_t{0}, areas.size(),
                      [&](std::size_t t) { areas[t] = worth(static_cast<Index>(t)); });
    const auto at =
        areas.end() - 1 - static_cast<std::ptrdiff_t>(share * static_cast<double>(areas.size() - 1));
    std::nth_element(areas.begin(), at, areas.end());
    return *at;
  }

  std::vector<bool> used_points() const {
    std::vector<bool> used(mesh_.points.size(), false);
    for (const auto& tet : mesh_.tets)
      for (const Index v : tet) used[v] = true;
    return used;
  }

  /// Takes away the points that belonged to some tet and no longer do.
  void drop_points(std::vector<bool> used_before) {
    const std::vector<bool> used = used_points();
    used_before.resize(used.size(), true);
    std::vector<Index> new_number(used.size());
    Index count = 0;
    for (std::size_t i = 0; i < used.size(); ++i) {
      new_number[i] = count;
      if (used[i] || !used_before[i]) mesh_.points[count++] = mesh_.points[i];
    }
    report_.dropped_points = static_cast<Index>(used.size() - count);
    if (report_.dropped_points == 0) return;
    mesh_.points.resize(count);
    for (auto& tet : mesh_.tets)
      for (Index& v : tet) v = new_number[v];
  }

  /// Makes every tet positive, and returns the area of all faces between two tets that no triangle
  /// constrains.
  double measure() {
    const std::size_t count = mesh_.tets.size();
    std::vector<double> sums((count + kPart - 1) / kPart, 0.0);  // added in one order, whatever the threads
    tbb::parallel_for(std::size_t{0}, sums.size(), [&](std::size_t part) {
      for (std::size_t t = part * kPart; t < std::min(count, (part + 1) * kPart); ++t) {
        const auto tet = static_cast<Index>(t);
        make_positive(tet);
        for (std::size_t k = 0; k < 4; ++k)
          if (is_free_face(mesh_, tet, k)) sums[part] += face_area(mesh_, tet, k) / 2;  // half is beyond
      }
    });
    double sum = 0;
    for (const double part : sums) sum += part;
    return sum;
  }

  void make_positive(Index t) {
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
  TetReplacer replacer_;
  tbb::enumerable_thread_specific<ConeFinder> finders_;
  std::vector<std::uint32_t> changed_;  ///< of each tet the last batch that changed it
  std::vector<std::uint32_t> round_;    ///< the last that looks at it
  std::uint32_t this_batch_ = 0, this_round_ = 0;
  double gained_ = 0;
  CrossingReport report_;
};

}  // namespace

CrossingReport reduce_crossings(TetMesh& mesh, Optimize effort, Progress& progress) {
  if (effort == Optimize::none) return {};
  return Reducer(mesh, progress).run(effort);
}

}  // namespace tetprep
