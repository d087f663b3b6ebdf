// SPDX-License-Identifier: AGPL-3.0-or-later
// One improvement of a tetrahedral mesh: finding it, without changing anything.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <vector>

#include "prep/prep.hpp"

namespace tetprep {

/// Tetrahedra that would give way to others filling the same space.
struct Flip {
  std::vector<Index> old_tets;
  std::vector<std::array<Index, 4>> new_tets;  ///< positive, strictly
  double gain = 0;  ///< area of free faces that goes away, in squares of the grid's step
};

inline double triangle_area(const GridPoint& a, const GridPoint& b, const GridPoint& c) {
  std::array<double, 3> u{}, v{};
  for (std::size_t i = 0; i < 3; ++i) {
    u[i] = b[i] - a[i];
    v[i] = c[i] - a[i];
  }
  const double x = u[1] * v[2] - u[2] * v[1], y = u[2] * v[0] - u[0] * v[2], z = u[0] * v[1] - u[1] * v[0];
  return std::sqrt(x * x + y * y + z * z) / 2;
}

/// Looks for flips. Reads the mesh, whose tets must all be positive, and keeps what it needs for a search:
/// one for each thread.
class FlipFinder {
 public:
  /// Flips that would replace faces of less than `threshold` area in all are not considered.
  FlipFinder(const TetMesh& mesh, double threshold) : mesh_(mesh), threshold_(threshold) {}

  /// Of flips at the edges and faces of tet `t`, in a fixed order, the first that makes the area smaller.
  /// `is_elsewhere(tet)`: flips that take this one away need no look now.
  template <class Elsewhere>
  bool find(Index t, Elsewhere is_elsewhere, Flip& flip) {
    for (std::size_t i = 0; i < 3; ++i)
      for (std::size_t j = i + 1; j < 4; ++j)
        if (walk_ring(t, i, j, is_elsewhere) && remove_edge(mesh_.tets[t][i], mesh_.tets[t][j], flip))
          return true;
    for (std::size_t k = 0; k < 4; ++k)
      if (replace_face(t, k, flip)) return true;
    return false;
  }

 private:
  /// Rings of more tetrahedra are left alone: they are rare, and filling one costs the cube of its size.
  static constexpr std::size_t kMaxRing = 12;

  const GridPoint& point(Index id) const { return mesh_.points[id]; }
  double area(Index a, Index b, Index c) const { return triangle_area(point(a), point(b), point(c)); }
  bool positive(Index a, Index b, Index c, Index d) const {
    return tetfmt::orientation(point(a), point(b), point(c), point(d)) > 0;
  }
  /// The vertex of `t` that is none of three others.
  Index fourth(Index t, Index a, Index b, Index c) const {
    const auto& v = mesh_.tets[t];
    return v[0] ^ v[1] ^ v[2] ^ v[3] ^ a ^ b ^ c;
  }

  /// Fills ring_ and ring_tets_ with what is around the edge between vertices i and j of `t`: with these as a
  /// and b, the tets are (a, b, r_0, r_1), (a, b, r_1, r_2) and so on, all positive. False if the ring is
  /// open, constrained, too long or elsewhere.
  template <class Elsewhere>
  bool walk_ring(Index t, std::size_t i, std::size_t j, Elsewhere is_elsewhere) {
    // The other two slots, such that (i, j, then these) is an even permutation.
    static constexpr std::array<std::array<std::size_t, 2>, 6> kOthers{
        {{2, 3}, {3, 1}, {1, 2}, {0, 3}, {2, 0}, {0, 1}}};  // of edges 01, 02, 03, 12, 13, 23
    const auto& others = kOthers[i == 0 ? j - 1 : i + j];
    const Index a = mesh_.tets[t][i], b = mesh_.tets[t][j];
    Index c = mesh_.tets[t][others[0]], d = mesh_.tets[t][others[1]];
    ring_size_ = 0;
    Index tet = t;
    do {
      if (ring_size_ == kMaxRing) return false;
      ring_[ring_size_] = c;
      ring_tets_[ring_size_++] = tet;
      std::size_t k = 0;
      while (mesh_.tets[tet][k] != c) ++k;
      const Index next = mesh_.neighbors[tet][k];
      if (next == kNone || mesh_.face_triangle[tet][k] != kNone || is_elsewhere(next)) return false;
      c = d;
      d = fourth(next, a, b, c);
      tet = next;
    } while (tet != t);
    return ring_size_ >= 3;
  }

  bool remove_edge(Index a, Index b, Flip& flip);
  bool fill_ring(Index a, Index b, double limit);
  void collect(Index a, Index b, std::size_t i, std::size_t j, Flip& flip) const;
  bool replace_face(Index t, std::size_t k, Flip& flip) const;

  const TetMesh& mesh_;
  double threshold_;
  std::size_t ring_size_ = 0;
  std::array<Index, kMaxRing> ring_{}, ring_tets_{};
  std::array<std::array<double, kMaxRing>, kMaxRing> cost_{}, diagonal_{};
  std::array<std::array<std::size_t, kMaxRing>, kMaxRing> split_{};
};

}  // namespace tetprep
