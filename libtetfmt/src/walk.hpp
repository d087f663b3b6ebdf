// SPDX-License-Identifier: MIT
// One walk for everything: along a line, from tetrahedron to tetrahedron (appendix B, algorithms 1 to 4).
//
// The line is tracked by the face it goes through. Projected along the line onto a coordinate plane, the line
// is the origin and the face a triangle around it, counter-clockwise. Each new vertex splits the plane by two
// signs into the three possible exits, and takes the place of the vertex that is left behind.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <optional>

#include "cells.hpp"
#include "predicates.hpp"
#include "signs.hpp"
#include "tetfmt/types.hpp"
#include "tetfmt/view.hpp"

namespace tetfmt::detail {

/// Where a walk is about to go: through the face `ids`, which the line crosses counter-clockwise, into
/// whatever `ref` names; `previous` is the reference back, by which a tetrahedron there knows its entry face.
struct Passage {
  Ref previous = kHull;
  std::array<Index, 3> ids{};
  Ref ref = kHull;
  std::uint32_t steps = 0;  ///< tetrahedra visited up to there
};

/// The tetrahedron that the walk is leaving: what is known of it at that moment.
struct Leaving {
  Index tet;
  Ref previous;                ///< by what it was entered
  std::array<Index, 3> ids{};  ///< the exit face, crossed counter-clockwise
  Index apex;                  ///< the vertex opposite the entry face (one of ids)
  Index left_behind;           ///< the vertex opposite the exit face
  Ref ref;                     ///< what lies across the exit face
  std::uint32_t steps;         ///< tetrahedra visited by this walk, this one included
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
    const Continue on = on_exit(Leaving{tet, previous, {i0, i1, i2}, apex, out, ref, steps});
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
  return !behind(corner(0), corner(1), corner(2), Place{to_vec3d(corner(3).point), {}});
}

/// The face by which the line leaves `cell`, if it passes through it (after perturbation).
template <class Signs>
std::optional<Passage> exit_of(const FileView& view, const Signs& signs, const Cell& cell, bool positive) {
  const auto& v = cell.vertices;
  const auto points = view.vertices();
  std::array<typename Signs::Point, 4> p;
  for (std::size_t k = 0; k < 4; ++k) p[k] = signs.project(points[v[k]]);
  unsigned bits = 0;
  for (unsigned a = 0; a < 3; ++a)
    for (unsigned b = a + 1; b < 4; ++b)
      bits |= static_cast<unsigned>(signs.left(p[a], v[a], p[b], v[b])) << edge_bit(a, b);

  const std::uint8_t k = kExitRank[positive ? bits : bits ^ 63u];
  if (k == 4) return std::nullopt;
  auto f = kOutwardFaces[k];
  if (!positive) std::swap(f[1], f[2]);
  return Passage{cell.tet, {v[f[0]], v[f[1]], v[f[2]]}, cell.neighbors[k], 1};
}

/// If the hull face has the mesh on one side and the point on the other: whether the normal of its vertices,
/// ascending, points into the mesh. Nothing for every other face, and for one whose indices do not exist.
template <class Cells>
std::optional<bool> seen_from(const FileView& view, const Cells& cells, const HullFace& face,
                              const Place& place) {
  const auto points = view.vertices();
  const auto& v = face.vertices;
  if (face.tet >= view.tet_count()) return std::nullopt;
  const Index apex = cells.vertex_xor(face.tet) ^ v[0] ^ v[1] ^ v[2];
  if (std::max({apex, v[0], v[1], v[2]}) >= points.size()) return std::nullopt;
  const auto is_behind = [&](const Place& p) {
    return behind({points[v[0]], v[0]}, {points[v[1]], v[1]}, {points[v[2]], v[2]}, p);
  };
  const bool inwards = !is_behind({to_vec3d(points[apex]), {}});
  if (is_behind(place) != inwards) return std::nullopt;
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
