// SPDX-License-Identifier: AGPL-3.0-or-later
// Fewer triangles for a bounded error, by OpenMesh's decimater.
#pragma once

#include "prep/prep.hpp"

namespace tetprep {

struct SimplifyReport {
  std::size_t triangles_before = 0, triangles_after = 0;
  std::size_t skipped_triangles = 0;  ///< left as they were: their part of the surface is not manifold
  /// Measured, in model units: how far points of the given surface lie from the simplified one at most, or
  /// points of the simplified one from the given one (sampled at corners, edge midpoints and centroids; more
  /// densely in large triangles). Never above the error that was asked for.
  double max_deviation = 0;
};

/// Collapses edges while the surface stays within `error` (model units, above 0) of the given one. Points at
/// the same place count as one. Only manifold parts change: triangles at an edge with more than two of them,
/// or with two that are oriented against each other, stay, and so do boundaries, and edges where material,
/// object or attributes change. Remaining points keep their places, and triangles their material, object and
/// (corner by corner) attributes; points that no triangle uses any more are left out. Where the measured
/// deviation is too large, it is done again, more strictly; at worst nothing changes. Deterministic for any
/// number of threads. Failure (usage): `error` is not above 0 and finite.
TriangleSoup simplify(TriangleSoup soup, double error, Progress& progress, SimplifyReport& report);

}  // namespace tetprep
