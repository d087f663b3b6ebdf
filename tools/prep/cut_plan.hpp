// SPDX-License-Identifier: AGPL-3.0-or-later
// Which triangles have to be cut, which of them together, and along what.
#pragma once

#include <array>
#include <vector>

#include "prep/cut_triangles.hpp"
#include "prep/near_contacts.hpp"
#include "prep/prep.hpp"

namespace tetprep {

struct CutPlan {
  std::vector<Index> members;  ///< task by task
  std::vector<CutTask> tasks;  ///< no triangle is in two of them
};

/// Cuts along all intersections of `pairs`. Triangles that meet in one plane are cut together.
CutPlan plan_cuts(const std::vector<GridPoint>& points, const std::vector<std::array<Index, 3>>& triangles,
                  const std::vector<TrianglePair>& pairs);

/// Leads triangles through points near them, one by one. O(triangles).
CutPlan plan_bends(const std::vector<std::array<Index, 3>>& triangles, const NearContacts& near);

}  // namespace tetprep
