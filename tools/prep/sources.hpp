// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <vector>

#include "prep/prep.hpp"

namespace tetprep {

/// Tets to start from, as few as reach every tet by walking, across surfaces too. First the one that holds
/// the middle of the box around all points, or (that space was left out) is nearest to it; then, ascending,
/// the first tet of every part that cannot be reached from there. Deterministic for any number of threads.
/// O(tets).
std::vector<Index> choose_sources(const TetMesh& mesh);

}  // namespace tetprep
