// SPDX-License-Identifier: AGPL-3.0-or-later
// Surfaces to mesh files.
#pragma once

#include <string>

#include "sample/surface.hpp"

namespace tetprep {

/// The formats that write_mesh knows, for messages: ".obj, .off, .ply or .stl".
inline constexpr const char* kMeshEndings = ".obj, .off, .ply or .stl";

/// Writes `surface` in the format that the name's ending tells: OBJ and OFF as text, exact (each coordinate
/// the shortest that reads back as the same number, as float32 and as double); PLY and STL binary,
/// little-endian. So the formats agree bit for bit, whatever the reader computes in. STL repeats corners:
/// readers have to weld them by their (identical) coordinates. Throws Failure: usage for another ending, io;
/// then nothing is left at `path`.
void write_mesh(const Surface& surface, const std::string& path);

/// Throws Failure (usage) unless write_mesh knows the ending of `path`.
void check_mesh_ending(const std::string& path);

}  // namespace tetprep
