// SPDX-License-Identifier: AGPL-3.0-or-later
#include "prep/reduce_crossings.hpp"

#include <algorithm>
#include <cmath>
#include <deque>
#include <limits>
#include <utility>

#include "tetfmt/orientation.hpp"

namespace tetprep {
namespace {

using tetfmt::kNone;
using Tet = std::array<Index, 4>;
using Face = std::array<Index, 3>;

/// Rings of more tetrahedra are left alone: they are rare, and filling one costs the cube of its size.
constexpr std::size_t kMaxRing = 12;
/// A move must gain at least this share of the area it touches; rounding then cannot make two moves undo each
/// other for ever.
constexpr double kLeastGain = 1e-6;
/// Optimize::fast considers a move only if the faces that it would replace have this many times the area that
/// there is per tetrahedron: large faces are few and hold most of the area. On the armadillo (52,000
/// triangles) that is a tenth of the flips and of the time, and rays then cross 5 to 15 % more tetrahedra
/// than with all.
constexpr double kWorthwhile = 5;

Face face_of(const Tet& tet, std::size_t opposite) {
  Face face{};
  for (std::size_t k = 0, n = 0; k < 4; ++k)
    if (k != opposite) face[n++] = tet[k];
  return face;
}

Face sorted(Face face) {
  std::sort(face.begin(), face.end());
  return face;
}

class Reducer {
 public:
  Reducer(TetMesh& mesh, Progress& progress) : mesh_(mesh), progress_(progress) {}

  CrossingReport run(Optimize effort) {
    CrossingReport report;
    const auto [hull_area, free_area] = measure();
    threshold_ =
        effort == Optimize::best ? 0 : kWorthwhile * free_area / static_cast<double>(mesh_.tets.size());
    std::vector<Index> current(mesh_.tets.size()), next;
    for (std::size_t t = 0; t < current.size(); ++t) current[t] = static_cast<Index>(t);
    queued_.assign(mesh_.tets.size(), false);
    large_.resize(mesh_.tets.size());
    for (std::size_t t = 0; t < large_.size(); ++t) large_[t] = is_large(static_cast<Index>(t));
    const std::size_t total = current.size();
    std::size_t done = 0;
    // Every tetrahedron once, then those that moves have made, until none of them allows another move.
    while (!current.empty()) {
      for (const Index t : current) {
        if (++done % 4096 == 0)
          progress_.fraction(std::min(1.0, static_cast<double>(done) / (1.5 * static_cast<double>(total))));
        if (!improve(t)) continue;
        ++report.flips;
        for (const Index made : made_) {
          if (queued_[made]) continue;
          queued_[made] = true;
          next.push_back(made);
        }
      }
      current.swap(next);
      next.clear();
      first_pass_ = false;
      for (const Index t : current) queued_[t] = false;
    }
    compact();
    report.area_before = free_area / hull_area;
    report.area_after = (free_area - gained_) / hull_area;
    return report;
  }

 private:
  const GridPoint& point(Index id) const { return mesh_.points[id]; }

  bool positive(Index a, Index b, Index c, Index d) const {
    return tetfmt::orientation(point(a), point(b), point(c), point(d)) > 0;
  }

  void make_positive(std::size_t t) {
    auto& v = mesh_.tets[t];
    if (positive(v[0], v[1], v[2], v[3])) return;
    std::swap(v[0], v[1]);
    std::swap(mesh_.neighbors[t][0], mesh_.neighbors[t][1]);
    std::swap(mesh_.face_triangle[t][0], mesh_.face_triangle[t][1]);
  }

  double area(Index a, Index b, Index c) const {
    std::array<double, 3> u{}, v{};
    for (std::size_t i = 0; i < 3; ++i) {
      u[i] = point(b)[i] - point(a)[i];
      v[i] = point(c)[i] - point(a)[i];
    }
    const double x = u[1] * v[2] - u[2] * v[1], y = u[2] * v[0] - u[0] * v[2], z = u[0] * v[1] - u[1] * v[0];
    return std::sqrt(x * x + y * y + z * z) / 2;
  }

  struct Areas {
    double hull = 0;  ///< the box's surface
    double free = 0;  ///< all faces between two tetrahedra that no triangle constrains
  };
  Areas measure() const {
    Areas areas;
    for (std::size_t t = 0; t < mesh_.tets.size(); ++t) {
      for (std::size_t k = 0; k < 4; ++k) {
        if (mesh_.face_triangle[t][k] != kNone) continue;
        const Face f = face_of(mesh_.tets[t], k);
        if (mesh_.neighbors[t][k] == kNone) {
          areas.hull += area(f[0], f[1], f[2]);
        } else if (mesh_.neighbors[t][k] > t) {  // once from its two sides
          areas.free += area(f[0], f[1], f[2]);
        }
      }
    }
    return areas;
  }

  std::size_t slot_of(Index t, Index vertex) const {
    const auto& v = mesh_.tets[t];
    return static_cast<std::size_t>(std::find(v.begin(), v.end(), vertex) - v.begin());
  }

  /// False if no face of the tetrahedron is large enough for a ring around it to be worth a look: of up to
  /// six faces that make up the threshold, one has a sixth of it.
  bool is_large(Index t) const {
    for (std::size_t k = 0; k < 4; ++k) {
      const Face f = face_of(mesh_.tets[t], k);
      if (area(f[0], f[1], f[2]) >= threshold_ / 6) return true;
    }
    return false;
  }

  /// Makes the best move at an edge or face of `t` that gains anything; made_ then names the new tetrahedra.
  bool improve(Index t) {
    if (mesh_.tets[t][0] == kNone) return false;  // gone
    if (first_pass_ ? !large_[t] : !is_large(t)) return false;
    make_positive(t);
    for (std::size_t i = 0; i < 3; ++i)
      for (std::size_t j = i + 1; j < 4; ++j)
        if (remove_edge(t, i, j)) return true;
    for (std::size_t k = 0; k < 4; ++k)
      if (replace_face(t, k)) return true;
    return false;
  }

  // Edge removal. The ring around edge (a, b) is a polygon r_0 .. r_n-1, each tetrahedron (a, b, r_i, r_i+1)
  // positive.

  /// Fills ring_ and ring_tets_; false if the ring is open, constrained or too long.
  bool walk_ring(Index t, Index a, Index b, Index c, Index d) {
    ring_.clear();
    ring_tets_.clear();
    if (!positive_order(t, a, b, c, d)) std::swap(c, d);
    Index tet = t;
    do {
      if (ring_.size() == kMaxRing) return false;
      ring_.push_back(c);
      ring_tets_.push_back(tet);
      const std::size_t k = slot_of(tet, c);
      const Index next = mesh_.neighbors[tet][k];
      if (next == kNone || mesh_.face_triangle[tet][k] != kNone) return false;
      if (first_pass_ && next < t && large_[next]) return false;  // looked at from there
      c = d;
      const auto& v = mesh_.tets[next];
      d = v[0] ^ v[1] ^ v[2] ^ v[3] ^ a ^ b ^ c;
      tet = next;
    } while (tet != t);
    return true;
  }

  /// True if (a, b, c, d), a permutation of positive tetrahedron t's vertices, is an even one.
  bool positive_order(Index t, Index a, Index b, Index c, Index d) const {
    const std::array<std::size_t, 4> slot = {slot_of(t, a), slot_of(t, b), slot_of(t, c), slot_of(t, d)};
    bool even = true;
    for (std::size_t i = 0; i < 3; ++i)
      for (std::size_t j = i + 1; j < 4; ++j) even ^= slot[i] > slot[j];
    return even;
  }

  bool remove_edge(Index t, std::size_t i, std::size_t j) {
    const Tet& v = mesh_.tets[t];
    const Index a = v[i], b = v[j];
    std::array<Index, 2> other{};
    for (std::size_t k = 0, m = 0; k < 4; ++k)
      if (k != i && k != j) other[m++] = v[k];
    if (!walk_ring(t, a, b, other[0], other[1])) return false;
    const std::size_t n = ring_.size();
    if (n < 3) return false;

    double before = 0;
    for (const Index r : ring_) before += area(a, b, r);
    if (before < threshold_) return false;
    if (!fill_ring(a, b, before * (1 - kLeastGain))) return false;
    gained_ += before - cost_[0][n - 1];
    new_tets_.clear();
    collect(a, b, 0, n - 1);
    replace(ring_tets_);
    return true;
  }

  /// The cheapest way to cut the ring into triangles, each the base of one tetrahedron with a and one with b
  /// (Klincsek 1980, with areas of faces for lengths of diagonals). False if none is valid and below `limit`.
  bool fill_ring(Index a, Index b, double limit) {
    const std::size_t n = ring_.size();
    constexpr double kInfinity = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < n; ++i)
      for (std::size_t j = i + 2; j < n; ++j)
        diagonal_[i][j] =
            i == 0 && j == n - 1 ? 0 : area(a, ring_[i], ring_[j]) + area(b, ring_[i], ring_[j]);
    for (std::size_t i = 0; i + 1 < n; ++i) cost_[i][i + 1] = diagonal_[i][i + 1] = 0;
    for (std::size_t length = 2; length < n; ++length) {
      for (std::size_t i = 0; i + length < n; ++i) {
        const std::size_t j = i + length;
        cost_[i][j] = kInfinity;
        for (std::size_t k = i + 1; k < j; ++k) {
          double cost = cost_[i][k] + cost_[k][j] + diagonal_[i][k] + diagonal_[k][j];
          if (cost >= std::min(limit, cost_[i][j])) continue;
          cost += area(ring_[i], ring_[k], ring_[j]);
          if (cost >= std::min(limit, cost_[i][j])) continue;
          if (!positive(ring_[i], ring_[k], ring_[j], b) || !positive(ring_[k], ring_[i], ring_[j], a))
            continue;
          cost_[i][j] = cost;
          split_[i][j] = k;
        }
      }
    }
    return cost_[0][n - 1] < limit;
  }

  void collect(Index a, Index b, std::size_t i, std::size_t j) {
    if (j == i + 1) return;
    const std::size_t k = split_[i][j];
    new_tets_.push_back({ring_[i], ring_[k], ring_[j], b});
    new_tets_.push_back({ring_[k], ring_[i], ring_[j], a});
    collect(a, b, i, k);
    collect(a, b, k, j);
  }

  /// The 2-3 flip: the face opposite vertex k of `t`, between apexes a and b, gives way to the edge (a, b).
  bool replace_face(Index t, std::size_t k) {
    const Index other = mesh_.neighbors[t][k];
    if (other == kNone || mesh_.face_triangle[t][k] != kNone) return false;
    const Index a = mesh_.tets[t][k];
    Face f = face_of(mesh_.tets[t], k);
    const auto& v = mesh_.tets[other];
    const Index b = v[0] ^ v[1] ^ v[2] ^ v[3] ^ f[0] ^ f[1] ^ f[2];
    if (k % 2 == 0) std::swap(f[1], f[2]);  // now (f, a) is positive: a has moved past 3 - k vertices
    const double before = area(f[0], f[1], f[2]);
    double after = 0;
    for (std::size_t i = 0; i < 3; ++i) after += area(a, b, f[i]);
    if (before < threshold_ || after >= before * (1 - kLeastGain)) return false;
    new_tets_.clear();
    for (std::size_t i = 0; i < 3; ++i) {
      const Index p = f[i], q = f[(i + 1) % 3];
      if (!positive(p, q, b, a)) return false;
      new_tets_.push_back({p, q, b, a});
    }
    gained_ += before - after;
    replace({t, other});
    return true;
  }

  // Replacing a few tetrahedra by others that fill the same space.

  /// A face on the boundary of what is being replaced.
  struct Rim {
    Face face;  ///< ascending
    Index outside, triangle;
  };

  void replace(const std::vector<Index>& old_tets) {
    rim_.clear();
    for (const Index t : old_tets) {
      for (std::size_t k = 0; k < 4; ++k) {
        const Index outside = mesh_.neighbors[t][k];
        if (std::find(old_tets.begin(), old_tets.end(), outside) != old_tets.end()) continue;
        rim_.push_back({sorted(face_of(mesh_.tets[t], k)), outside, mesh_.face_triangle[t][k]});
      }
    }
    made_.clear();
    for (std::size_t i = 0; i < new_tets_.size(); ++i) {
      made_.push_back(i < old_tets.size() ? old_tets[i] : fresh());
      mesh_.tets[made_[i]] = new_tets_[i];
    }
    for (std::size_t i = new_tets_.size(); i < old_tets.size(); ++i) {
      mesh_.tets[old_tets[i]].fill(kNone);
      free_.push_back(old_tets[i]);
    }
    for (const Index t : made_)
      for (std::size_t k = 0; k < 4; ++k) link(t, k);
  }

  /// Finds what lies across face k of the new tetrahedron t: the rim's outside, or another new one.
  void link(Index t, std::size_t k) {
    const Face face = sorted(face_of(mesh_.tets[t], k));
    mesh_.face_triangle[t][k] = kNone;
    for (const Rim& rim : rim_) {
      if (rim.face != face) continue;
      mesh_.neighbors[t][k] = rim.outside;
      mesh_.face_triangle[t][k] = rim.triangle;
      if (rim.outside != kNone) {
        const auto& v = mesh_.tets[rim.outside];
        const Index apex = v[0] ^ v[1] ^ v[2] ^ v[3] ^ face[0] ^ face[1] ^ face[2];
        mesh_.neighbors[rim.outside][slot_of(rim.outside, apex)] = t;
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

  Index fresh() {
    if (!free_.empty()) {
      const Index t = free_.back();
      free_.pop_back();
      return t;
    }
    mesh_.tets.emplace_back();
    mesh_.neighbors.emplace_back();
    mesh_.face_triangle.emplace_back();
    queued_.push_back(false);
    return static_cast<Index>(mesh_.tets.size() - 1);
  }

  /// Closes the gaps that removed tetrahedra have left.
  void compact() {
    std::vector<Index> moved(mesh_.tets.size(), kNone);
    Index count = 0;
    for (std::size_t t = 0; t < mesh_.tets.size(); ++t) {
      if (mesh_.tets[t][0] == kNone) continue;
      moved[t] = count;
      mesh_.tets[count] = mesh_.tets[t];
      mesh_.neighbors[count] = mesh_.neighbors[t];
      mesh_.face_triangle[count] = mesh_.face_triangle[t];
      ++count;
    }
    mesh_.tets.resize(count);
    mesh_.neighbors.resize(count);
    mesh_.face_triangle.resize(count);
    for (auto& neighbors : mesh_.neighbors)
      for (Index& neighbor : neighbors)
        if (neighbor != kNone) neighbor = moved[neighbor];
  }

  TetMesh& mesh_;
  Progress& progress_;
  std::vector<bool> queued_;
  bool first_pass_ = true;
  double gained_ = 0;        ///< area that the moves so far have saved
  std::vector<bool> large_;  ///< is_large of every tetrahedron at the start
  double threshold_ = 0;     ///< moves that touch less area are not considered
  std::vector<Index> free_;  ///< places of tetrahedra that are gone
  // What one move needs, kept to save allocations.
  std::vector<Index> ring_, ring_tets_, made_;
  std::vector<Tet> new_tets_;
  std::vector<Rim> rim_;
  std::array<std::array<double, kMaxRing>, kMaxRing> cost_{}, diagonal_{};
  std::array<std::array<std::size_t, kMaxRing>, kMaxRing> split_{};
};

}  // namespace

CrossingReport reduce_crossings(TetMesh& mesh, Optimize effort, Progress& progress) {
  if (effort == Optimize::none) return {};
  return Reducer(mesh, progress).run(effort);
}

}  // namespace tetprep
