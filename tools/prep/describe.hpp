// SPDX-License-Identifier: AGPL-3.0-or-later
// Parts of a surface in the words of its input: triangle numbers and model coordinates.
#pragma once

#include <string>
#include <vector>

#include "prep/prep.hpp"

namespace tetprep {

/// "17 (0.5 2 -1)": the input's number and a corner in model coordinates, to nine digits.
std::string describe_triangle(const CleanSurface& surface, Index triangle);

/// One line: how many pairs there are, and the first five of them. `pairs` must not be empty.
std::string describe_intersections(const CleanSurface& surface, const std::vector<TrianglePair>& pairs);

}  // namespace tetprep
