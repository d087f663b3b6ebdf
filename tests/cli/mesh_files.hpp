// SPDX-License-Identifier: AGPL-3.0-or-later
// Readers for the mesh files that `tet extract` writes, apart from the converter's own. They believe their
// file; anything odd shows up as wrong numbers.
#pragma once

#include <array>
#include <map>
#include <string>
#include <utility>
#include <vector>

namespace tetfmt_test {

struct PlyElement {
  std::vector<std::pair<std::string, std::string>> properties;  ///< type and name, in order
  std::map<std::string, std::vector<double>> columns;           ///< of the properties that are no lists
  std::vector<std::vector<double>> lists;                       ///< of the one that is
  std::size_t count = 0;
};

struct Ply {
  std::vector<std::string> comments;
  std::map<std::string, PlyElement> elements;
  std::array<double, 3> position(std::size_t face, std::size_t corner) const {
    const auto& vertices = elements.at("vertex").columns;
    const auto i = static_cast<std::size_t>(elements.at("face").lists[face][corner]);
    return {vertices.at("x")[i], vertices.at("y")[i], vertices.at("z")[i]};
  }
  /// A vertex property at a face's corner.
  double at(const std::string& name, std::size_t face, std::size_t corner) const {
    const auto i = static_cast<std::size_t>(elements.at("face").lists[face][corner]);
    return elements.at("vertex").columns.at(name)[i];
  }
};

/// Ascii or binary little-endian.
Ply read_ply(const std::string& path);

struct Obj {
  std::vector<std::vector<double>> v, vt, vn;
  struct Corner {
    int v = 0, vt = 0, vn = 0;
  };
  struct Face {
    std::vector<Corner> corners;
    std::string material, object;
  };
  std::vector<Face> faces;
  std::string library;
  std::string grouping;  ///< "o" and "g" as they came
};

Obj read_obj(const std::string& path);

}  // namespace tetfmt_test
