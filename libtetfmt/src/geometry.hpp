// SPDX-License-Identifier: MIT
#pragma once

#include "tetfmt/orientation.hpp"
#include "tetfmt/validate.hpp"
#include "topology.hpp"

namespace tetfmt::detail {

/// Level::geometry: the tetrahedra tile a convex region, each point of it once, and the constrained faces
/// cover the triangles. Exact. Only for a topology that was found sound. O(tets + sides + hull^2).
void check_geometry(const FileView& view, const Topology& topology, Report& report);

}  // namespace tetfmt::detail
