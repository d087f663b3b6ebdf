// SPDX-License-Identifier: AGPL-3.0-or-later
// TetGen's own points are doubles; the file's points are on the grid.
#pragma once

#include <optional>
#include <span>

#include "prep/prep.hpp"

namespace tetprep {

/// Puts points[first_free] and all after it on grid points near `wanted` (one entry each) such that every tet
/// is strictly of orientation `sign`. The first `bound` of them may not leave their wanted place by more than
/// `reach` steps and a half; the others go wherever they fit. Returns how many could not take the nearest
/// grid point, or nothing if some tet could not be saved (`points` is then of no use). Exact. O(tets), plus
/// work for tets that rounding breaks.
std::optional<Index> place_steiner_points(std::vector<GridPoint>& points, std::size_t first_free,
                                          std::span<const Point> wanted,
                                          std::span<const std::array<Index, 4>> tets, int sign,
                                          std::size_t bound = 0, int reach = 1);

}  // namespace tetprep
