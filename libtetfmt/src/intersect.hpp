// SPDX-License-Identifier: MIT
// Where along a ray, and where in the triangle: computed once, from the input triangle, in double precision.
#pragma once

#include <array>

#include "tetfmt/types.hpp"

namespace tetfmt::detail {

struct TrianglePoint {
  double t = 0;         ///< in units of the direction, at least 0
  double u = 0, v = 0;  ///< weights of b and c, in [0, 1], u + v at most 1
};

/// For a ray that is known to meet the closed triangle (a, b, c), or to pass it by an infinitesimal distance.
/// The normal is exact for corners on a common grid of 24 bits, so t carries a few roundings of |a - origin|
/// over the sine of the angle of incidence; for a ray in the triangle's plane it is where the ray enters it.
TrianglePoint intersect(const Vec3f& origin, const Vec3f& direction, const Vec3f& a, const Vec3f& b,
                        const Vec3f& c);

/// The same point with the weights of the triangle that `piece` was cut from. The piece's corners may be off
/// that triangle by a rounding to the grid; the point goes straight onto it, along its main axis.
TrianglePoint from_piece(const TrianglePoint& at, const std::array<Vec3f, 3>& piece,
                         const std::array<Vec3f, 3>& whole);

}  // namespace tetfmt::detail
