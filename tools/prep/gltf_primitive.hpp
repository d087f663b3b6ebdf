// SPDX-License-Identifier: AGPL-3.0-or-later
// One primitive of a glTF mesh: triangles and the values of the vertices that they use.
#pragma once

#include <array>
#include <vector>

#include "prep/gltf_accessor.hpp"

namespace tetprep {

struct GltfPrimitive {
  std::vector<Point> positions;               ///< finite
  std::vector<std::array<float, 3>> normals;  ///< of each position, or empty
  std::vector<std::array<float, 2>> texcoords;
  std::vector<std::array<float, 4>> colors;
  std::vector<Index> corners;  ///< three a triangle
  int material = -1;
};

/// Primitive `number` of a mesh, from accessors or from Draco's data. Without triangles if it is made of
/// points or lines or has no positions: then `warnings` says so. Failure: invalid (types, lengths and indices
/// that do not fit together, or positions that are not finite).
GltfPrimitive read_primitive(const SourceFile& file, const GltfDocument& document, GltfAccessors& accessors,
                             std::size_t mesh, std::size_t number, Warnings& warnings);

}  // namespace tetprep
