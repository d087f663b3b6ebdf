// SPDX-License-Identifier: AGPL-3.0-or-later
// Where triangles pass corners of others so closely that they had better go through them.
#pragma once

#include <array>
#include <map>
#include <vector>

#include "prep/prep.hpp"

namespace tetprep {

struct NearContacts {
  /// Points near the inside of an edge (its ends ascending). All triangles with that edge must be led through
  /// them, or they come apart.
  std::map<std::array<Index, 2>, std::vector<Index>> of_edges;
  /// Points near the inside of a triangle, but near none of its edges.
  std::map<Index, std::vector<Index>> of_triangles;
};

/// Looks at the triangles `which` (at least one) and all their corners. `reach` in grid steps; no two of
/// those corners may be closer to each other. O(n log n + nearby pairs).
NearContacts find_near_contacts(const std::vector<GridPoint>& points,
                                const std::vector<std::array<Index, 3>>& triangles,
                                const std::vector<Index>& which, std::int32_t reach);

}  // namespace tetprep
