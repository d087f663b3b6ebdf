// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "prep/prep.hpp"

namespace tetprep {

/// A surface as its triangles' corners.
using Triangles = std::vector<std::array<Point, 3>>;

/// Calls use(point, u, v) for points spread over a triangle, point = a + u (b - a) + v (c - a): its corners,
/// edge midpoints and centroid, and if its longest edge is longer than `spacing` more of them, in rows: at
/// most half of `spacing` apart, but never more than 32 rows.
template <class Use>
void for_each_sample(const std::array<Point, 3>& triangle, double spacing, Use use) {
  const Point &a = triangle[0], &b = triangle[1], &c = triangle[2];
  const auto length = [](const Point& p, const Point& q) {
    return std::hypot(q[0] - p[0], q[1] - p[1], q[2] - p[2]);
  };
  const double longest = std::max({length(a, b), length(b, c), length(c, a)});
  const int rows = 2 * static_cast<int>(std::clamp(std::ceil(longest / spacing), 1.0, 16.0));
  const auto at = [&](double u, double v) {
    Point p{};
    for (std::size_t k = 0; k < 3; ++k) p[k] = a[k] + u * (b[k] - a[k]) + v * (c[k] - a[k]);
    use(p, u, v);
  };
  for (int i = 0; i <= rows; ++i)
    for (int j = 0; i + j <= rows; ++j) at(static_cast<double>(i) / rows, static_cast<double>(j) / rows);
  at(1.0 / 3, 1.0 / 3);
}

/// How far samples of each triangle of `of` lie from the nearest point of `from`, at most. `from` must not be
/// empty. Deterministic for any number of threads. O(samples log triangles).
std::vector<double> deviations(const Triangles& of, const Triangles& from, double spacing);

}  // namespace tetprep
