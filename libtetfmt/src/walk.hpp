// SPDX-License-Identifier: MIT
// One walk for everything: along a line, from tetrahedron to tetrahedron (appendix B, algorithms 1 to 4).
//
// The line is tracked by the face it goes through. Projected along the line onto a coordinate plane, the line
// is the origin and the face a triangle around it, counter-clockwise. Each new vertex splits the plane by two
// signs into the three possible exits, and takes the place of the vertex that is left behind.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>

#include "cells.hpp"
#include "predicates.hpp"
#include "tetfmt/types.hpp"
#include "tetfmt/view.hpp"

namespace tetfmt::detail {

inline Vec3d to_vec3d(const Vec3f& p) {
  return {p.x, p.y, p.z};
}

template <class Real>
struct Point2 {
  Real x = 0, y = 0;
};

/// Shear along the line onto the plane orthogonal to its largest component k (Woop, Benthin and Wald 2013):
/// x = A_i - A_k d_i/d_k, y = A_j - A_k d_j/d_k with A = point - origin. Then x_a y_b - y_a x_b has the sign
/// of det[d, a - o, b - o]: i and j are swapped where d_k is negative. The two ratios are at most 1.
template <class Real>
class Projection {
 public:
  explicit Projection(const Line& line) {
    const Vec3d& d = line.direction;
    for (std::size_t axis = 1; axis < 3; ++axis)
      if (std::abs(d[axis]) > std::abs(d[k_])) k_ = axis;
    i_ = (k_ + 1) % 3;
    j_ = (k_ + 2) % 3;
    if (d[k_] < 0) std::swap(i_, j_);
    origin_i_ = static_cast<Real>(line.origin[i_]);
    origin_j_ = static_cast<Real>(line.origin[j_]);
    origin_k_ = static_cast<Real>(line.origin[k_]);
    slope_i_ = static_cast<Real>(d[i_] / d[k_]);
    slope_j_ = static_cast<Real>(d[j_] / d[k_]);
  }

  /// The same projection in another precision.
  template <class Other>
  explicit Projection(const Projection<Other>& other)
      : i_(other.i_),
        j_(other.j_),
        k_(other.k_),
        origin_i_(static_cast<Real>(other.origin_i_)),
        origin_j_(static_cast<Real>(other.origin_j_)),
        origin_k_(static_cast<Real>(other.origin_k_)),
        slope_i_(static_cast<Real>(other.slope_i_)),
        slope_j_(static_cast<Real>(other.slope_j_)) {}

  Point2<Real> operator()(const Vec3f& point) const {
    const float* coordinate = &point.x;  // x, y, z are contiguous: Vec3f mirrors the file
    const Real depth = static_cast<Real>(coordinate[k_]) - origin_k_;
    return {static_cast<Real>(coordinate[i_]) - origin_i_ - depth * slope_i_,
            static_cast<Real>(coordinate[j_]) - origin_j_ - depth * slope_j_};
  }

 private:
  template <class>
  friend class Projection;
  std::size_t i_ = 0, j_ = 0, k_ = 0;
  Real origin_i_ = 0, origin_j_ = 0, origin_k_ = 0, slope_i_ = 0, slope_j_ = 0;
};

/// Exact signs: double precision, certified by one constant a line, and predicates.hpp for the rest.
///
/// With u = 2^-53 and all |A| at most L in each coordinate: A and the slopes carry one rounding each (a slope
/// of a line through a point, three), their product and the difference one more, so each projected coordinate
/// is off by at most 10 u L (to first order) and is at most 2 L. A cross product x_a y_b - y_a x_b then is
/// off by at most 4 * (10 u L) * 2 L for its inputs and 2 * u * 8 L^2 for its own roundings: 96 u L^2; 128
/// leaves room for all terms of second order.
class ExactSigns {
 public:
  ExactSigns(const Line& line, const Bounds& bounds, std::span<const Vec3f> vertices)
      : project_(line), line_(line), vertices_(vertices) {
    const Vec3d lower = to_vec3d(bounds.lower), upper = to_vec3d(bounds.upper);
    double reach = 0;
    for (std::size_t i = 0; i < 3; ++i)
      reach = std::max({reach, std::abs(lower[i] - line.origin[i]), std::abs(upper[i] - line.origin[i])});
    threshold_ = 128 * 0x1p-53 * reach * reach;
  }
  Point2<double> project(const Vec3f& point) const { return project_(point); }
  const Projection<double>& projection() const { return project_; }
  static const ExactSigns& of(const ExactSigns& signs) { return signs; }
  bool left(const Point2<double>& a, Index a_id, const Point2<double>& b, Index b_id) const {
    const double cross = a.x * b.y - a.y * b.x;
    if (cross > threshold_) return true;
    if (cross < -threshold_) return false;
    return left_exactly(a_id, b_id);
  }

 private:
  [[gnu::noinline, gnu::cold]] bool left_exactly(Index a, Index b) const {
    return passes_left(line_, {vertices_[a], a}, {vertices_[b], b});
  }

  Projection<double> project_;
  const Line& line_;
  std::span<const Vec3f> vertices_;
  double threshold_ = 0;
};

/// Signs as single precision gives them. A walk by these can go wrong where the line meets edges and
/// vertices.
class FloatSigns {
 public:
  static FloatSigns of(const ExactSigns& signs) { return FloatSigns(signs.projection()); }
  Point2<float> project(const Vec3f& point) const { return project_(point); }
  bool left(const Point2<float>& a, Index, const Point2<float>& b, Index) const {
    return a.x * b.y - a.y * b.x > 0;
  }

 private:
  explicit FloatSigns(const Projection<double>& projection) : project_(projection) {}
  Projection<float> project_;
};

/// Where a walk is about to go: out of `from` (kNone: out of the void) through the face `ids`, which the line
/// crosses counter-clockwise, into whatever `ref` names.
struct Passage {
  Index from = kNone;
  std::array<Index, 3> ids{};
  Ref ref = kHull;
};

/// The tetrahedron that the walk is leaving: what is known of it at that moment.
struct Leaving {
  Index tet;
  Ref previous;                ///< by what it was entered
  std::array<Index, 3> ids{};  ///< the exit face, crossed counter-clockwise
  Index apex;                  ///< the vertex opposite the entry face (one of ids)
  Index left_behind;           ///< the vertex opposite the exit face
  Ref ref;                     ///< what lies across the exit face
};

/// What a walk does next: enters `tet`, having come by `previous`; or stops, with kNone.
struct Continue {
  Index tet = kNone;
  Ref previous = kHull;
};

/// Walks from tetrahedron `tet`, entered by reference `previous` through `ids`. After each tetrahedron,
/// `on_exit(Leaving)` says what to do next. kChecked: every index is looked at before use. Returns the number
/// of tetrahedra visited, or nothing if the bytes do not describe a mesh. Tetrahedra are convex and disjoint,
/// so a straight line enters each at most once: more steps than tetrahedra mean a cycle.
template <bool kChecked, class Cells, class Signs, class OnExit>
std::optional<std::uint32_t> walk(const FileView& view, const Cells& cells, const Signs& signs, Index tet,
                                  Ref previous, const std::array<Index, 3>& ids, OnExit&& on_exit) {
  const Vec3f* const vertices = view.vertices().data();
  const auto vertex_count = static_cast<Index>(view.vertices().size());
  const Index tet_count = view.tet_count();
  Index i0 = ids[0], i1 = ids[1], i2 = ids[2];
  auto p0 = signs.project(vertices[i0]), p1 = signs.project(vertices[i1]), p2 = signs.project(vertices[i2]);

  for (std::uint32_t steps = 1; steps <= tet_count; ++steps) {
    if constexpr (kChecked) {
      if (tet >= tet_count) return std::nullopt;
    }
    const Index apex = cells.vertex_xor(tet) ^ i0 ^ i1 ^ i2;
    if constexpr (kChecked) {
      if (apex >= vertex_count) return std::nullopt;
    }
    const auto p3 = signs.project(vertices[apex]);
    std::size_t entry_rank = 0;
    if constexpr (Cells::kNeedsEntryRank) entry_rank = rank(apex, i0, i1, i2);

    // The exit is the face towards -p3: between p1 and p2, p2 and p0, or p0 and p1.
    Index out;
    Ref ref;
    const auto leave = [&](Index& id, auto& p, Index other0, Index other1) {
      out = id;
      ref = cells.next(tet, previous, entry_rank, rank(out, other0, other1, apex));
      id = apex;
      p = p3;
    };
    if (signs.left(p0, i0, p3, apex)) {
      if (signs.left(p2, i2, p3, apex)) {
        leave(i0, p0, i1, i2);
      } else {
        leave(i1, p1, i0, i2);
      }
    } else {
      if (signs.left(p1, i1, p3, apex)) {
        leave(i2, p2, i0, i1);
      } else {
        leave(i0, p0, i1, i2);
      }
    }
    const Continue on = on_exit(Leaving{tet, previous, {i0, i1, i2}, apex, out, ref});
    if (on.tet == kNone) return steps;
    tet = on.tet;
    previous = on.previous;
  }
  return std::nullopt;
}

/// The faces of a tetrahedron whose vertices, ascending, are positively oriented: face k lies opposite vertex
/// k and has its normal outwards. A negative one has all of them turned around.
inline constexpr std::array<std::array<std::uint8_t, 3>, 4> kOutwardFaces = {
    {{1, 2, 3}, {0, 3, 2}, {0, 1, 3}, {0, 2, 1}}};

/// The six edges (a, b), a < b, in the order of the bits below.
constexpr unsigned edge_bit(unsigned a, unsigned b) {
  return a == 0 ? b - 1 : a + b;
}

/// From which edges of a positive tetrahedron pass a line on the left, the face by which it leaves: the one
/// it crosses counter-clockwise. 4 where there is none.
inline constexpr std::array<std::uint8_t, 64> kExitRank = [] {
  std::array<std::uint8_t, 64> table{};
  for (unsigned bits = 0; bits < 64; ++bits) {
    table[bits] = 4;
    const auto left = [&](unsigned a, unsigned b) {
      return a < b ? (bits >> edge_bit(a, b) & 1u) == 1 : (bits >> edge_bit(b, a) & 1u) == 0;
    };
    for (std::uint8_t k = 0; k < 4; ++k) {
      const auto& f = kOutwardFaces[k];
      if (left(f[0], f[1]) && left(f[1], f[2]) && left(f[2], f[0])) table[bits] = k;
    }
  }
  return table;
}();

/// True if the cell's vertices, ascending, are positively oriented.
inline bool is_positive(const FileView& view, const Cell& cell) {
  const auto corner = [&](std::size_t k) {
    return Corner{view.vertices()[cell.vertices[k]], cell.vertices[k]};
  };
  return !behind(corner(0), corner(1), corner(2), to_vec3d(corner(3).point));
}

/// The face by which the line leaves `cell`, if it passes through it (after perturbation).
inline std::optional<Passage> exit_of(const FileView& view, const ExactSigns& signs, const Cell& cell,
                                      bool positive) {
  const auto& v = cell.vertices;
  const auto points = view.vertices();
  std::array<Point2<double>, 4> p;
  for (std::size_t k = 0; k < 4; ++k) p[k] = signs.project(points[v[k]]);
  unsigned bits = 0;
  for (unsigned a = 0; a < 3; ++a)
    for (unsigned b = a + 1; b < 4; ++b)
      bits |= static_cast<unsigned>(signs.left(p[a], v[a], p[b], v[b])) << edge_bit(a, b);

  const std::uint8_t k = kExitRank[positive ? bits : bits ^ 63u];
  if (k == 4) return std::nullopt;
  auto f = kOutwardFaces[k];
  if (!positive) std::swap(f[1], f[2]);
  return Passage{cell.tet, {v[f[0]], v[f[1]], v[f[2]]}, cell.neighbors[k]};
}

/// If the hull face has the mesh on one side and the point on the other: whether the normal of its vertices,
/// ascending, points into the mesh. Nothing for every other face, and for one whose indices do not exist.
template <class Cells>
std::optional<bool> seen_from(const FileView& view, const Cells& cells, const HullFace& face,
                              const Vec3d& point) {
  const auto points = view.vertices();
  const auto& v = face.vertices;
  if (face.tet >= view.tet_count()) return std::nullopt;
  const Index apex = cells.vertex_xor(face.tet) ^ v[0] ^ v[1] ^ v[2];
  if (std::max({apex, v[0], v[1], v[2]}) >= points.size()) return std::nullopt;
  const auto is_behind = [&](const Vec3d& p) {
    return behind({points[v[0]], v[0]}, {points[v[1]], v[1]}, {points[v[2]], v[2]}, p);
  };
  const bool inwards = !is_behind(to_vec3d(points[apex]));
  if (is_behind(point) != inwards) return std::nullopt;
  return inwards;
}

/// What Location::entrances holds: a position in the hull list, and the answer of seen_from.
struct Entrance {
  std::size_t face;
  bool inwards;
};
static_assert(2 * kMaxHullFaces <= 0xFFFF);
constexpr std::uint16_t pack_entrance(Entrance entrance) {
  return static_cast<std::uint16_t>(2 * entrance.face + (entrance.inwards ? 1 : 0));
}
constexpr Entrance unpack_entrance(std::uint16_t packed) {
  return {packed / std::size_t{2}, packed % 2 == 1};
}

/// True if a cell that came from outside may be used with this view: its indices exist.
inline bool in_range(const FileView& view, const Cell& cell) {
  return cell.tet < view.tet_count() && *std::max_element(cell.vertices.begin(), cell.vertices.end()) <
                                            static_cast<Index>(view.vertices().size());
}

}  // namespace tetfmt::detail
