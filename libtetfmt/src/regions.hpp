// SPDX-License-Identifier: MIT
#pragma once

#include "tetfmt/validate.hpp"
#include "tetfmt/view.hpp"
#include "topology.hpp"

namespace tetfmt::detail {

/// Level::topology: the region table divides the tetrahedra into the spaces that constrained faces close off,
/// and 0 is the one at the hull. Only for a topology that was found sound. O(tets).
void check_regions(const FileView& view, const Topology& topology, Report& report);

/// Level::geometry: each region's volume and bounds. Only for a geometry that was found sound. O(tets).
void check_region_measures(const FileView& view, const Topology& topology, Report& report);

}  // namespace tetfmt::detail
