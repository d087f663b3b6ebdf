// SPDX-License-Identifier: AGPL-3.0-or-later
// The spaces that surfaces close off from each other, and leaving out those that no ray enters.
#pragma once

#include <array>
#include <vector>

#include "prep/prep.hpp"

namespace tetprep {

/// Which region each tet is in. 0 is the one around everything; the others are numbered as they are met going
/// through the tets. Two tets are in one region if a path leads from one to the other through no triangle.
struct Regions {
  std::vector<Index> of_tet;
  Index count = 0;
};

/// O(tets). `mesh` must be whole (nothing left out yet).
Regions find_regions(const TetMesh& mesh);

/// Leaves out every tet whose region is not in `kept` (by number; at least one tet must remain). Faces
/// towards left-out space become one-sided; vertices and tets are renumbered in the order that they had, and
/// so are `regions.of_tet`. Region numbers stay. Deterministic. O(tets).
void keep_regions(TetMesh& mesh, Regions& regions, const std::vector<bool>& kept);

/// The region that holds a point given in model coordinates. Points on a face, an edge or a vertex belong to
/// any of the regions that touch there: the lowest number. kNone: outside of the box. O(tets), exact.
Index region_at(const TetMesh& mesh, const Regions& regions, const Point& point);

/// Puts the tets of each region one after the other (region 0 first), otherwise in the order that they had.
void group_by_region(TetMesh& mesh, Regions& regions);

/// The REGN section of a mesh whose tets are grouped by region.
tetfmt::OptionalSection region_section(const TetMesh& mesh, const Regions& regions);

}  // namespace tetprep
