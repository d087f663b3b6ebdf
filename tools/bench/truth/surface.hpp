// SPDX-License-Identifier: AGPL-3.0-or-later
// The surface of a mesh as its constrained faces: what rays are meant to hit. Nothing of the tetrahedra is
// left in it but the names of their sides.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "tetfmt/mesh.hpp"
#include "tetfmt/types.hpp"

namespace tetbench {

using Vec3d = std::array<double, 3>;
using GridPoint = std::array<std::int64_t, 3>;

/// (b - a) x (c - a) points to the front. Face i has the sides 2i (front) and 2i + 1 (back).
using Face = std::array<tetfmt::Index, 3>;

struct Surface {
  std::vector<tetfmt::Vec3f> vertices;
  std::vector<GridPoint> grid;  ///< the vertices in steps of 2^grid_exponent, at most 2^24 each
  int grid_exponent = 0;
  std::vector<Face> faces;
  bool closed = false;  ///< every edge has an even number of faces: lines cross evenly often

  /// Throws Failure (invalid) for coordinates that are on no grid of 24 bits.
  Surface(std::vector<tetfmt::Vec3f> points, std::vector<Face> triangles);
  /// The faces between the mesh's sides. `mesh` must be valid at Level::geometry, which proves that they
  /// cover the triangles. Throws Failure (invalid) if a triangle that is one face differs from it. O(tets).
  static Surface of(const tetfmt::Mesh& mesh);

  /// (b - a) x (c - a) in grid steps: exact, below 2^52.
  GridPoint normal(const Face& face) const;
};

}  // namespace tetbench
