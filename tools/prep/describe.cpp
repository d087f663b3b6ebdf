// SPDX-License-Identifier: AGPL-3.0-or-later
#include "prep/describe.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "prep/intersections.hpp"

namespace tetprep {

std::string describe_triangle(const CleanSurface& surface, Index triangle) {
  const GridPoint& p = surface.points[surface.triangles[triangle][0]];
  const double step = std::ldexp(1.0, surface.grid_exponent);
  char text[120];
  std::snprintf(text, sizeof text, "%u (%.9g %.9g %.9g)", surface.input_triangle[triangle],
                surface.origin[0] + p[0] * step, surface.origin[1] + p[1] * step,
                surface.origin[2] + p[2] * step);
  return text;
}

std::string describe_intersections(const CleanSurface& surface, const std::vector<TrianglePair>& pairs) {
  constexpr std::size_t kNamed = 5;
  std::string text = "the surface intersects itself: ";
  if (pairs.size() >= IntersectionSearch::kMostPairs) text += "at least ";
  text += std::to_string(pairs.size()) + (pairs.size() == 1 ? " pair" : " pairs") +
          " of triangles (numbers from 0, each with a corner): ";
  for (std::size_t i = 0; i < std::min(kNamed, pairs.size()); ++i)
    text += (i == 0 ? "" : "; ") + describe_triangle(surface, pairs[i].first) + " and " +
            describe_triangle(surface, pairs[i].second);
  if (pairs.size() > kNamed) text += "; ... (--report lists them)";
  return text;
}

}  // namespace tetprep
