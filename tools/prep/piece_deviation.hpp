// SPDX-License-Identifier: AGPL-3.0-or-later
// How far a cut surface is from what it was.
#pragma once

#include <array>
#include <vector>

#include "prep/prep.hpp"

namespace tetprep {

/// The largest distance of a point of `surface` from the triangle that it is a piece of, grid steps. `points`
/// and `corners` (by input triangle) are those from before the cutting, on the same grid. O(triangles).
double furthest_from_origin(const CleanSurface& surface, const std::vector<GridPoint>& points,
                            const std::vector<std::array<Index, 3>>& corners);

}  // namespace tetprep
