// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <vector>

#include "prep/prep.hpp"

namespace tetprep {

/// Makes tet chosen[i] the i-th and leaves out those that are not in `chosen` (which names none twice): faces
/// towards them have no neighbor afterwards. Points stay. O(tets).
void take_tets(TetMesh& mesh, const std::vector<Index>& chosen);

}  // namespace tetprep
