// SPDX-License-Identifier: MIT
// Exact orientation of points on an integer grid: what makes every claim about a file decidable.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

namespace tetfmt {

/// A point in units of the grid. The predicates below are exact for differences of less than 2^30 in each
/// coordinate (a file's own coordinates differ by at most 2^25).
using GridPoint = std::array<std::int32_t, 3>;

/// Sign (-1, 0, 1) of det[b - a, c - a, d - a]: positive when d lies where (b - a) x (c - a) points.
/// Double precision where its error bound certifies the sign, else 128-bit integers.
inline int orientation(const GridPoint& a, const GridPoint& b, const GridPoint& c, const GridPoint& d) {
  const auto difference = [](const GridPoint& p, const GridPoint& q) {
    return GridPoint{p[0] - q[0], p[1] - q[1], p[2] - q[2]};
  };
  const auto determinant = []<class T>(T, const GridPoint& u, const GridPoint& v, const GridPoint& w) {
    const T ux = u[0], uy = u[1], uz = u[2], vx = v[0], vy = v[1], vz = v[2], wx = w[0], wy = w[1], wz = w[2];
    return wx * (uy * vz - uz * vy) + wy * (uz * vx - ux * vz) + wz * (ux * vy - uy * vx);
  };
  const GridPoint u = difference(b, a), v = difference(c, a), w = difference(d, a);
  const auto largest = [&](std::size_t k) {
    return static_cast<double>(std::max({std::abs(u[k]), std::abs(v[k]), std::abs(w[k])}));
  };
  // The differences are exact. Each of the six products is at most `scale` and meets at most five roundings
  // on its way into the sum, so the error is below 6 * 5 * 2^-53 * scale; 2^-48 = 32 * 2^-53 covers it.
  const double estimate = determinant(double{}, u, v, w);
  const double bound = 0x1p-48 * (largest(0) * largest(1) * largest(2));
  if (estimate > bound) return 1;
  if (estimate < -bound) return -1;
  __extension__ using Wide = __int128;
  const Wide exact = determinant(Wide{}, u, v, w);
  return (exact > 0) - (exact < 0);
}

/// Sign of the area of (a, b, c) after dropping coordinate `axis`, counter-clockwise positive when seen
/// from that axis's positive end. Twice the area itself; differences below 2^30 keep it inside 64 bits.
inline std::int64_t doubled_area(const GridPoint& a, const GridPoint& b, const GridPoint& c,
                                 std::size_t axis) {
  const std::size_t i = (axis + 1) % 3, j = (axis + 2) % 3;
  return std::int64_t{b[i] - a[i]} * (c[j] - a[j]) - std::int64_t{b[j] - a[j]} * (c[i] - a[i]);
}

}  // namespace tetfmt
