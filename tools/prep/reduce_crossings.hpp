// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include "prep/prep.hpp"

namespace tetprep {

enum class Optimize {
  none,
  fast,  ///< only where much area is at stake
  best,  ///< everywhere, until no move is left
};

struct CrossingReport {
  double area_before = 0, area_after = 0;  ///< of all unconstrained faces inside, in areas of the box
  Index flips = 0;
};

/// Flips tetrahedra until the total area of the unconstrained faces is locally least: the crossings of a
/// random line are expected to be proportional to it (the Cauchy-Crofton formula). Two moves, each taken
/// where it makes the area smaller: an edge is removed and the ring of its tetrahedra filled again by dynamic
/// programming (Shewchuk 2002, "Two discrete optimization algorithms for the topological improvement of
/// tetrahedral meshes"), and a face is replaced by the edge between the two vertices opposite it.
///
/// Points, constrained faces, the hull and regions stay as they are, and so do the ends of a mesh of which
/// space was left out; every new tetrahedron is strictly positive by exact arithmetic. Tets keep their order,
/// new ones stand where the old ones did. Deterministic for any number of threads. About O(tets).
CrossingReport reduce_crossings(TetMesh& mesh, Optimize effort, Progress& progress);

}  // namespace tetprep
