// SPDX-License-Identifier: AGPL-3.0-or-later
// One improvement of a tetrahedral mesh: finding it, without changing anything.
//
// Around a point p, take a set of tetrahedra that p sees in full, and fill the same space with the cone of p:
// one tetrahedron from p to each face of the hull. Flips of all kinds are of this form (2-3, 3-2, 4-4, n-m; a
// vertex inside the set is removed), and so are moving a vertex and inserting one. What is the best set? A
// face inside it goes away; an edge on its hull costs the triangle between it and p. Look at one tetrahedron
// from p. Its faces that are turned to p are inside the set as soon as it belongs to it, for the tetrahedra
// in front of them must belong to it too: else p could not see it. An edge is on the hull or inside the set
// from the moment when the first tetrahedron around it is taken, the one that p sees the edge *behind*; and
// it is off the hull again with the last one, which p sees behind the edge. So each tetrahedron has a worth
// of its own: its faces turned to p, less the triangles to edges of which it is the first, plus the triangles
// to edges of which it is the last. And the best set is the closure of maximum weight in the order of sight,
// which a maximum flow finds exactly (closure.hpp).
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "prep/closure.hpp"
#include "prep/prep.hpp"

namespace tetprep {

/// Tetrahedra that would give way to the cone of a point: one from it to each face of their hull that does
/// not contain it.
struct Cone {
  std::vector<Index> tets;
  Index apex = kNone;  ///< the vertex that the point is; kNone: to be chosen
  GridPoint place{};   ///< where it is then
  double gain = 0;     ///< area of free faces that goes away, in squares of the grid's step
};

/// The three corners of a positive tet's face opposite corner k, so that it with that corner is positive.
inline constexpr std::array<std::array<std::size_t, 3>, 4> kFaceCorners{
    {{1, 3, 2}, {0, 2, 3}, {0, 3, 1}, {0, 1, 2}}};

inline double triangle_area(const GridPoint& a, const GridPoint& b, const GridPoint& c) {
  std::array<double, 3> u{}, v{};
  for (std::size_t i = 0; i < 3; ++i) {
    u[i] = b[i] - a[i];
    v[i] = c[i] - a[i];
  }
  const double x = u[1] * v[2] - u[2] * v[1], y = u[2] * v[0] - u[0] * v[2], z = u[0] * v[1] - u[1] * v[0];
  return std::sqrt(x * x + y * y + z * z) / 2;
}

/// Of tet t, opposite corner k.
inline bool is_free_face(const TetMesh& mesh, Index t, std::size_t k) {
  return mesh.neighbors[t][k] != kNone && mesh.face_triangle[t][k] == kNone;
}
inline double face_area(const TetMesh& mesh, Index t, std::size_t k) {
  const auto& v = mesh.tets[t];
  const auto& face = kFaceCorners[k];
  return triangle_area(mesh.points[v[face[0]]], mesh.points[v[face[1]]], mesh.points[v[face[2]]]);
}
/// The area of the largest of its free faces, 0 if it has none.
inline double largest_free_face(const TetMesh& mesh, Index t) {
  double largest = 0;
  for (std::size_t k = 0; k < 4; ++k)
    if (is_free_face(mesh, t, k)) largest = std::max(largest, face_area(mesh, t, k));
  return largest;
}

/// Looks for cones. Reads the mesh, whose tets must all be positive, and keeps what it needs for a search:
/// one for each thread.
class ConeFinder {
 public:
  explicit ConeFinder(const TetMesh& mesh) : mesh_(mesh) {}

  /// The best cone of the vertex at corner k of tet `t`, among sets that hold all tets around it on its side
  /// of constrained faces: where it is, or, if no constrained face holds it and that is better, at a place
  /// that is good for it. False if none makes the area smaller, or if there are very many tets around it, or
  /// both sides of one face. `is_elsewhere(tet)`: no look is wanted now if it is one of those around the
  /// vertex.
  template <class Elsewhere>
  bool find(Index t, std::size_t k, Elsewhere is_elsewhere, Cone& cone) {
    return collect_around(t, k, is_elsewhere) && find_cone(cone);
  }

  /// The best cone of a new vertex near `place`, which is strictly inside tet `t`. False if none makes the
  /// area smaller.
  bool find_new(Index t, const GridPoint& place, Cone& cone);

 private:
  /// Vertices among more tets are left alone.
  static constexpr std::size_t kMostAround = 256;
  /// Tets that a search looks at beyond those around the vertex, at most; for a new vertex, more.
  static constexpr std::size_t kMostSeen = 64, kMostSeenByNew = 400;

  /// What a search knows of a tet.
  enum : int { kAround = -2, kRefused = -1 };  // or its number in closure_

  /// A small hash table from tets to what is known of them.
  class Known {
   public:
    void clear() { ++search_; }
    /// Null if nothing is known.
    int* find(Index tet) {
      for (std::size_t i = slot(tet);; i = (i + 1) % kSize) {
        if (entries_[i].search != search_) return nullptr;
        if (entries_[i].tet == tet) return &entries_[i].value;
      }
    }
    void put(Index tet, int value) {
      std::size_t i = slot(tet);
      while (entries_[i].search == search_) i = (i + 1) % kSize;
      entries_[i] = {search_, tet, value};
    }

   private:
    static constexpr std::size_t kSize = 2048;
    static std::size_t slot(Index tet) { return (tet * 2654435761u >> 16) % kSize; }
    struct Entry {
      std::uint32_t search = 0;
      Index tet = 0;
      int value = 0;
    };
    std::array<Entry, kSize> entries_{};
    std::uint32_t search_ = 0;
  };

  const GridPoint& point(Index id) const { return mesh_.points[id]; }
  bool is_free(Index t, std::size_t k) const { return is_free_face(mesh_, t, k); }
  std::size_t corner_of(Index t, Index vertex) const {
    std::size_t k = 0;
    while (mesh_.tets[t][k] != vertex) ++k;
    return k;
  }

  /// Fills around_.
  template <class Elsewhere>
  bool collect_around(Index t, std::size_t corner, Elsewhere is_elsewhere) {
    vertex_ = mesh_.tets[t][corner];
    is_inside_ = true;
    known_.clear();
    known_.put(t, kAround);
    around_.assign(1, t);
    for (std::size_t i = 0; i < around_.size(); ++i) {
      const Index tet = around_[i];
      for (std::size_t k = 0; k < 4; ++k) {
        if (mesh_.tets[tet][k] == vertex_) continue;
        const Index next = mesh_.neighbors[tet][k];
        if (!is_free(tet, k)) {
          is_inside_ = false;
          // Around the end of a sheet: its two sides would be one face of the cone.
          if (known_.find(next) != nullptr) return false;
          continue;
        }
        if (known_.find(next) != nullptr) continue;
        if (is_elsewhere(next) || around_.size() == kMostAround) return false;
        known_.put(next, kAround);
        around_.push_back(next);
      }
    }
    return true;
  }

  bool find_cone(Cone& cone);
  bool find_place(double area, Cone& cone);
  bool move_to(Index& t, const GridPoint& place) const;
  bool is_in_cone(Index t);
  void look_around(const GridPoint& p, std::size_t most_seen);
  std::array<double, 3> best_place(const GridPoint& near);
  void look_at(Index t, const GridPoint& p);
  void collect(const GridPoint& place, double gain, Cone& cone) const;
  double area_around() const;

  struct Seen {
    Index tet;
    std::array<bool, 4> turned;  ///< its faces, to the point
    double debt;                 ///< what it and those in front of it cost, about
  };
  using Edge = std::array<Index, 2>;

  const TetMesh& mesh_;
  Known known_;
  Index vertex_ = kNone;
  std::vector<Index> around_;
  bool is_inside_ = false;  ///< the vertex: no constrained face and no hull holds it
  double most_debt_ = 0;
  std::vector<Seen> seen_;
  Closure closure_;
  std::vector<Edge> edges_;  ///< of the hull
  std::vector<std::pair<std::array<double, 3>, std::array<double, 3>>>
      lines_;  ///< an end, and the way to the other
};

}  // namespace tetprep
