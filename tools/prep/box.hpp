// SPDX-License-Identifier: AGPL-3.0-or-later
// The box that is filled with tetrahedra: a convex domain lets open surfaces work, and outside rays enter it.
#pragma once

#include <algorithm>
#include <array>
#include <vector>

#include "prep/prep.hpp"

namespace tetprep {

struct Box {
  GridPoint low, high;

  std::array<GridPoint, 8> corners() const {
    std::array<GridPoint, 8> points{};
    for (std::size_t i = 0; i < 8; ++i)
      for (std::size_t k = 0; k < 3; ++k) points[i][k] = (i >> k & 1) != 0 ? high[k] : low[k];
    return points;
  }

  /// Length of the longest edge.
  std::int32_t extent() const { return std::max({high[0] - low[0], high[1] - low[1], high[2] - low[2]}); }

  GridPoint centre() const {
    return {low[0] + (high[0] - low[0]) / 2, low[1] + (high[1] - low[1]) / 2,
            low[2] + (high[2] - low[2]) / 2};
  }

  /// Two triangles a side, as positions in corners(); outward normals.
  static constexpr std::array<std::array<Index, 3>, 12> kTriangles{{{0, 2, 1},
                                                                    {1, 2, 3},
                                                                    {4, 5, 6},
                                                                    {5, 7, 6},
                                                                    {0, 1, 4},
                                                                    {1, 5, 4},
                                                                    {2, 6, 3},
                                                                    {3, 6, 7},
                                                                    {0, 4, 2},
                                                                    {2, 4, 6},
                                                                    {1, 3, 5},
                                                                    {3, 7, 5}}};
};

/// The bounds of `points`, of which there is at least one.
inline Box bounds_of(const std::vector<GridPoint>& points) {
  Box box{points.front(), points.front()};
  for (const GridPoint& point : points) {
    for (std::size_t k = 0; k < 3; ++k) {
      box.low[k] = std::min(box.low[k], point[k]);
      box.high[k] = std::max(box.high[k], point[k]);
    }
  }
  return box;
}

/// The bounds of `points`, wider by a sixteenth of their largest extent on every side (at least one step):
/// no point of the surface lies on the box, and a flat surface gets a box with a volume.
inline Box box_around(const std::vector<GridPoint>& points) {
  Box box = bounds_of(points);
  const std::int32_t margin = box.extent() / 16 + 1;
  for (std::size_t k = 0; k < 3; ++k) {
    box.low[k] -= margin;
    box.high[k] += margin;
  }
  return box;
}

}  // namespace tetprep
