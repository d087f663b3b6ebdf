// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <vector>

#include "tetfmt/orientation.hpp"
#include "tetfmt/validate.hpp"
#include "topology.hpp"

namespace tetfmt::detail {

/// Whether the closed tetrahedron, its corners multiplied by `scale`, contains the point. Exact for products
/// below 2^28. The corners must not lie in a plane.
bool contains(const std::array<GridPoint, 4>& corners, const GridPoint& point, std::int32_t scale);

/// For partial files: no tetrahedron reaches into the space that was left out (spec/format.md, section 9):
/// one-sided faces meet in common corners and edges only, and each connected sheet of them has nothing but
/// its own tetrahedra at it. `points`: the vertices on the grid. About O(n log n) for n faces that overlap as
/// those of a surface do.
void check_left_out(const FileView& view, const Topology& topology, const std::vector<GridPoint>& points,
                    Report& report);

}  // namespace tetfmt::detail
