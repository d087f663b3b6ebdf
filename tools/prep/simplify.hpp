// SPDX-License-Identifier: AGPL-3.0-or-later
// Fewer triangles for a bounded error, by OpenMesh's decimater.
#pragma once

#include "prep/prep.hpp"

namespace tetprep {

struct SimplifyReport {
  std::size_t triangles_before = 0, triangles_after = 0;
  std::size_t skipped_triangles = 0;  ///< left as they were: their part of the surface is not manifold
  /// Measured, in model units: how far points of the given surface lie from the simplified one at most
  /// (sampled at corners, edge midpoints and centroids).
  double max_deviation = 0;
};

/// Collapses edges while the surface stays within `error` (model units, above 0) of the given one. Only on
/// manifold parts; boundaries, and edges where material or object change, stay. Remaining points keep their
/// places, and triangles their material, object and (corner by corner) attributes. Deterministic.
TriangleSoup simplify(TriangleSoup soup, double error, Progress& progress, SimplifyReport& report);

}  // namespace tetprep
