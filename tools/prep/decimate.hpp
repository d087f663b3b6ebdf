// SPDX-License-Identifier: AGPL-3.0-or-later
// Edge collapse on a manifold surface, by OpenMesh's decimater.
#pragma once

#include <array>
#include <vector>

#include "prep/prep.hpp"

namespace tetprep {

/// A surface in which every edge has one or two triangles, the two of them oriented alike, and every vertex
/// one fan of them. "Marks" tell corners apart that are not alike although they are at one vertex.
struct ManifoldSurface {
  std::vector<Point> vertices;
  std::vector<bool> locked;       ///< vertices that must stay
  std::vector<double> tolerance;  ///< how far the surface may move around each vertex
  std::vector<std::array<Index, 3>> triangles;
  std::vector<std::array<Index, 3>> marks;  ///< of each triangle's corners
};

/// Collapses edges (one end moves to the other) as long as samples of the surface that was there
/// (deviation.hpp) stay within the tolerance of the triangles around their place, the middles of new
/// triangles and edges within the tolerance of the surface that was there, no triangle turns over, and a
/// corner's mark after the collapse is the only one that the collapsed edge has at that end. Vertices at a
/// boundary stay, and so do those with several marks. Triangles keep their places and their order of corners;
/// those that have gone have corners of kNone. Cheapest collapses (by quadrics) first. Returns where each
/// vertex is now: itself, or the one that it moved to. Deterministic.
std::vector<Index> decimate(ManifoldSurface& surface, double spacing, Progress& progress);

}  // namespace tetprep
