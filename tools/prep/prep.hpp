// SPDX-License-Identifier: AGPL-3.0-or-later
// The converter's types, in the order in which data flows (each arrow is one function in one file):
//
//   TriangleSoup -> CleanSurface -> TetMesh -> tetfmt::Mesh -> bytes -> file
//     read_soup      snap            tetrahedralize  order    encode   write (pipeline.cpp)
//
// Every type's maker establishes its invariants; later stages do not re-check them. All functions throw
// tetprep::Failure with one line in terms of the input (triangle numbers, coordinates, file:line).
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "common/failure.hpp"
#include "common/progress.hpp"
#include "tetfmt/mesh.hpp"

namespace tetprep {

using tetfmt::Index;

/// What a mesh file says, polygons triangulated. Invariant: at least one triangle, every index in range,
/// every coordinate that a triangle uses finite. `triangles` are in file order: their positions are the
/// "input triangle" numbers of everything that follows.
struct TriangleSoup {
  std::vector<std::array<double, 3>> points;
  std::vector<std::array<Index, 3>> triangles;
};

/// A point of the grid: model = origin + coordinates * 2^grid_exponent, exactly.
using GridPoint = std::array<std::int32_t, 3>;

/// The surface on a uniform power-of-two grid: no two points equal, no degenerate and no repeated triangle
/// (in any orientation). Triangles may still intersect.
struct CleanSurface {
  std::array<double, 3> origin{};
  int grid_exponent = 0;
  std::vector<GridPoint> points;
  std::vector<std::array<Index, 3>> triangles;  ///< corner order of the input
  std::vector<Index> input_triangle;            ///< of each triangle, ascending
  Index input_triangle_count = 0;
  Index merged_points = 0, degenerate_triangles = 0, duplicate_triangles = 0;
  double max_deviation = 0;  ///< largest distance that snapping moved a point, model units
};

/// A constrained tetrahedralisation of a box around the surface, on the same grid. Positively or negatively
/// oriented tets alike, none flat; no order of anything is promised.
struct TetMesh {
  std::array<double, 3> origin{};
  int grid_exponent = 0;
  std::vector<GridPoint> points;                ///< the surface's points first, then box and Steiner points
  std::vector<std::array<Index, 4>> tets;
  std::vector<std::array<Index, 4>> neighbors;  ///< across the face opposite each vertex; kNone at the hull
  std::vector<std::array<Index, 4>> face_triangle;  ///< CleanSurface triangle on that face, or kNone
};

}  // namespace tetprep
