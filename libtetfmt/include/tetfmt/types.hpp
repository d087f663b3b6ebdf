// SPDX-License-Identifier: MIT
// The vocabulary shared by every header: indices, references between tetrahedra, points.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>

namespace tetfmt {

/// Index of a vertex, tetrahedron, triangle or side. All counts of a file are below 2^31.
using Index = std::uint32_t;

/// "There is none": an absent triangle, tetrahedron or vertex. Same bits as kHull.
inline constexpr Index kNone = 0xFFFFFFFFu;

/// What lies behind one face of a tetrahedron (spec/format.md, "References"):
///   bit 31 clear  the neighbouring tetrahedron's index;
///   bit 31 set    kSideBit | s: the face is constrained, and s is this tetrahedron's side of it;
///   all ones      the hull: there is nothing behind this face.
using Ref = std::uint32_t;
inline constexpr Ref kSideBit = 0x80000000u;
inline constexpr Ref kHull = 0xFFFFFFFFu;

constexpr bool is_tet(Ref ref) {
  return ref < kSideBit;
}
constexpr bool is_side(Ref ref) {
  return ref >= kSideBit && ref != kHull;
}
constexpr Ref side_ref(Index side) {
  return kSideBit | side;
}
constexpr Index side_index(Ref ref) {
  return ref & ~kSideBit;
}

/// The other side of the same constrained face: sides come in twins 2k (front) and 2k + 1 (back).
constexpr Index twin(Index side) {
  return side ^ 1u;
}

/// A point or direction in a file's local coordinates: model coordinates minus the file's origin.
/// float32, no unit of its own (whatever unit the input used).
struct Vec3f {
  float x = 0, y = 0, z = 0;
  friend bool operator==(const Vec3f&, const Vec3f&) = default;
};

/// An axis-aligned box; empty (lower above upper) until a point is added.
struct Bounds {
  Vec3f lower{kInfinity, kInfinity, kInfinity}, upper{-kInfinity, -kInfinity, -kInfinity};
  void add(const Vec3f& point) {
    lower = {std::min(lower.x, point.x), std::min(lower.y, point.y), std::min(lower.z, point.z)};
    upper = {std::max(upper.x, point.x), std::max(upper.y, point.y), std::max(upper.z, point.z)};
  }

 private:
  static constexpr float kInfinity = std::numeric_limits<float>::infinity();
};

/// A tetrahedron with everything that a 20- or 16-byte cell leaves out: what a walk carries along.
/// Invariant: `vertices` ascend strictly, and neighbors[k] lies across the face opposite vertices[k].
struct Cell {
  Index tet = kNone;
  std::array<Index, 4> vertices{};
  std::array<Ref, 4> neighbors{};
  friend bool operator==(const Cell&, const Cell&) = default;
};

}  // namespace tetfmt
