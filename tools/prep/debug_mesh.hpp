// SPDX-License-Identifier: AGPL-3.0-or-later
// A picture of what is wrong: the surface as PLY, the triangles in question coloured, to open in any viewer.
#pragma once

#include <string>
#include <vector>

#include "prep/prep.hpp"

namespace tetprep {

/// Writes `surface` as a binary PLY (model coordinates, float64) with face colours and the face property
/// `input_triangle`: triangles of `marked` (numbers of the surface) red, all others light grey. The marked
/// ones come first. Replaces `path` atomically.
void write_debug_mesh(const std::string& path, const CleanSurface& surface, std::vector<Index> marked);

}  // namespace tetprep
