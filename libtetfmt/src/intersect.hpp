// SPDX-License-Identifier: MIT
// Where along a ray, and where in the triangle: computed once, from the input triangle, in double precision.
#pragma once

#include <array>

#include "predicates.hpp"
#include "tetfmt/types.hpp"

namespace tetfmt::detail {

struct TrianglePoint {
  double t = 0;         ///< in units of the direction, at least 0
  double u = 0, v = 0;  ///< weights of b and c, in [0, 1], u + v at most 1
};

/// For a ray that is known to meet the closed triangle (a, b, c), or to pass it by an infinitesimal distance.
/// t is the quotient of two exact sums, each rounded once: within 3 units in the last place for rays that
/// meet the triangle at 1 degree or more (corners on a common grid of 24 bits). u and v carry some ten
/// roundings of the distance from the origin to a, over the triangle's height and the sine of the angle. For
/// a ray in the triangle's plane, the point where it enters the triangle.
TrianglePoint intersect(const Vec3d& origin, const Vec3d& direction, const Vec3f& a, const Vec3f& b,
                        const Vec3f& c);

/// The same to the last bit without the instruction for a fused product and sum, for processors that lack it.
TrianglePoint intersect_split(const Vec3d& origin, const Vec3d& direction, const Vec3f& a, const Vec3f& b,
                              const Vec3f& c);

/// What of intersect() does not depend on the direction.
struct TriangleFrom {
  Vec3d normal;        ///< (b - a) x (c - a), exact for corners on a common grid of 24 bits
  Vec3d for_u, for_v;  ///< their products with a direction, over normal . direction, are u and v
  double height;       ///< normal . (a - origin), rounded once: t is this over normal . direction
  double normal2;      ///< normal . normal
};
TriangleFrom triangle_from(const Vec3d& origin, const Vec3f& a, const Vec3f& b, const Vec3f& c);

/// Where (normal . direction)^2 is at most this times normal^2 direction^2, t is found another way: an angle
/// of less than a fifth of a second of arc.
inline constexpr double kGrazing2 = 1e-12;

/// The same point with the weights of the triangle that `piece` was cut from. The piece's corners may be off
/// that triangle by a rounding to the grid; the point goes straight onto it, along its main axis.
TrianglePoint from_piece(const TrianglePoint& at, const std::array<Vec3f, 3>& piece,
                         const std::array<Vec3f, 3>& whole);

}  // namespace tetfmt::detail
