// SPDX-License-Identifier: AGPL-3.0-or-later
// The header of a PLY file: what elements follow, and what each is made of.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "prep/read_soup.hpp"

namespace tetprep {

enum class PlyFormat { ascii, little_endian, big_endian };

struct PlyProperty {
  std::string name;
  tetfmt::PropertyType type{};
  std::optional<tetfmt::PropertyType> list_count;  ///< of a list: the type of its length
};

struct PlyElement {
  std::string name;
  std::uint64_t count = 0;
  std::vector<PlyProperty> properties;

  static constexpr std::size_t kNone = ~std::size_t{0};
  /// Position of a property, or kNone.
  std::size_t find(std::string_view property) const;
  bool has_lists() const;
};

struct PlyHeader {
  PlyFormat format{};
  std::vector<PlyElement> elements;
  std::vector<std::string> textures;  ///< named by "comment TextureFile", as MeshLab writes it
  std::size_t lines = 0;              ///< of the header
  std::string_view body;
};

/// Bytes of a value.
std::size_t size_of(tetfmt::PropertyType type);

/// Failure: no PLY header, or one that promises more than the file can hold; so that every count of it can be
/// believed as far as memory goes.
PlyHeader read_ply_header(const SourceFile& file);

}  // namespace tetprep
