// SPDX-License-Identifier: AGPL-3.0-or-later
// A file's surface, as it was before it became faces of tetrahedra.
#pragma once

#include "prep/appearance.hpp"
#include "tetfmt/validate.hpp"

namespace tetprep {

/// Triangles with all that a mesh file can say of them.
struct SurfaceMesh {
  std::vector<std::array<double, 3>> points;  ///< model coordinates, in order of first use, all used
  std::vector<std::array<Index, 3>> triangles;
  std::vector<Index> input_triangle;  ///< of each triangle; ascending unless they are pieces
  /// By input triangle and surface point, as in the input. A material that is kNone is not known: no face of
  /// the file lies on that triangle.
  Appearance appearance;
  std::size_t input_triangle_count = 0;
  /// Input triangles that the file holds no corners of: they were degenerate, or repeated another one.
  std::size_t left_out = 0;
};

/// What the file's optional sections say (the reverse of to_sections()), and materials by input triangle.
/// Failure: invalid (the DRAC section), unsupported (a DRAC section in a build without Draco). O(sections).
Appearance read_appearance(const tetfmt::FileView& view);

/// The input's triangles in their order; or, if `pieces`, the triangles as they were cut up, without values
/// at surface points. Positions are origin + local coordinates in double. Failures as above. O(triangles).
SurfaceMesh read_surface(const tetfmt::TrustedView& file, bool pieces);

}  // namespace tetprep
