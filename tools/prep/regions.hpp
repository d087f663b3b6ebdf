// SPDX-License-Identifier: AGPL-3.0-or-later
// The spaces that surfaces close off from each other, and leaving out those that no ray enters.
#pragma once

#include <vector>

#include "prep/prep.hpp"

namespace tetprep {

/// Fills mesh.region: two tets are in one region if a path leads from one to the other through no triangle.
/// 0 is the region around everything; the others are numbered as they are met going through the tets. `mesh`
/// must be whole (nothing left out yet). Returns the number of regions. Deterministic for any number of
/// threads. O(tets).
Index find_regions(TetMesh& mesh);

/// The lowest region that touches a point given in model coordinates: the one that holds it, unless it lies
/// on a face, an edge or a vertex. kNone: in no tet. Exact. O(tets).
Index region_at(const TetMesh& mesh, const Point& point);

/// Leaves out every tet whose region is not in `kept` (by number; at least one tet must remain). Faces
/// towards left-out space become one-sided; tets are renumbered in the order that they had. Points stay, so
/// that the surface's numbers hold: some may belong to no tet afterwards. Region numbers stay too.
/// Deterministic for any number of threads. O(tets).
void keep_regions(TetMesh& mesh, const std::vector<bool>& kept);

/// Puts the tets of each region one after the other (region 0 first), otherwise in the order that they had.
/// Deterministic for any number of threads. O(tets).
void group_by_region(TetMesh& mesh);

/// The REGN section of a mesh whose tets are grouped by region. O(tets).
tetfmt::OptionalSection region_section(const TetMesh& mesh);

}  // namespace tetprep
