// SPDX-License-Identifier: AGPL-3.0-or-later
#include "prep/piece_deviation.hpp"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/squared_distance_3.h>
#include <tbb/blocked_range.h>
#include <tbb/parallel_reduce.h>

#include <algorithm>
#include <cmath>

namespace tetprep {
namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;

Kernel::Point_3 place(const GridPoint& p) {
  return {p[0], p[1], p[2]};
}

}  // namespace

double furthest_from_origin(const CleanSurface& surface, const std::vector<GridPoint>& points,
                            const std::vector<std::array<Index, 3>>& corners) {
  const auto of_piece = [&](std::size_t i) {
    const auto& [a, b, c] = corners[surface.input_triangle[i]];
    const Kernel::Triangle_3 triangle(place(points[a]), place(points[b]), place(points[c]));
    double most = 0;  // the triangle is convex: the furthest point of a piece is a corner
    for (const Index corner : surface.triangles[i]) {
      const GridPoint& p = surface.points[corner];
      if (p == points[a] || p == points[b] || p == points[c]) continue;
      most = std::max(most, CGAL::squared_distance(place(p), triangle));
    }
    return most;
  };
  using Range = tbb::blocked_range<std::size_t>;
  return std::sqrt(tbb::parallel_reduce(
      Range(0, surface.triangles.size()), 0.0,
      [&](const Range& range, double most) {
        for (std::size_t i = range.begin(); i < range.end(); ++i) most = std::max(most, of_piece(i));
        return most;
      },
      [](double a, double b) { return std::max(a, b); }));
}

}  // namespace tetprep
