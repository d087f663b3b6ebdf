// SPDX-License-Identifier: AGPL-3.0-or-later
// The input surface as peers want it: float32 points, triangles, and nothing else of the file.
#pragma once

#include <array>
#include <vector>

#include "tetfmt/view.hpp"

namespace tetbench {

/// The triangles that have all of their corners in the file, with their own vertices only.
struct PeerMesh {
  std::vector<tetfmt::Vec3f> vertices;
  std::vector<std::array<tetfmt::Index, 3>> triangles;
  std::vector<tetfmt::Index> numbers;  ///< of each triangle, in FileView::input_triangles

  PeerMesh() = default;
  explicit PeerMesh(const tetfmt::FileView& view);
  std::array<tetfmt::Vec3f, 3> corners(std::size_t triangle) const {
    const auto& v = triangles[triangle];
    return {vertices[v[0]], vertices[v[1]], vertices[v[2]]};
  }
};

}  // namespace tetbench
