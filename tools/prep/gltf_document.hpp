// SPDX-License-Identifier: AGPL-3.0-or-later
// A glTF file with everything that it refers to, checked as far as that goes without looking at its data.
#pragma once

#include <cstddef>
#include <deque>
#include <span>
#include <string>
#include <vector>

#include "prep/read_soup.hpp"
#include "prep/tinygltf.hpp"
#include "tetfmt/mapped_file.hpp"

namespace tetprep {

struct GltfDocument {
  /// asset, buffer views, accessors, meshes, nodes, scenes, materials and textures; nothing else. Every
  /// number is of the type and every index in the range that it must be; views lie inside of their buffers.
  tinygltf::Model model;
  std::vector<std::span<const std::byte>> buffers;
  std::vector<std::string> images;  ///< URIs; "#/images/3" for those that are inside of the file

  // What `buffers` refers to, besides the file itself.
  std::vector<tetfmt::MappedFile> files;
  std::deque<std::string> decoded;  ///< a deque: short strings must not move
};

/// Index accessor of a primitive, or -1.
int index_accessor(const tinygltf::Primitive& primitive);

/// Reads .gltf and .glb. Failure: invalid, with the place in terms of the JSON ("nodes[3].mesh ..."); io (a
/// buffer's file is missing); unsupported (version, a required extension that we do not know: by name).
GltfDocument open_gltf(const SourceFile& file, Warnings& warnings);

}  // namespace tetprep
