// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include "prep/prep.hpp"

namespace tetprep {

enum class Optimize {
  none,
  fast,  ///< once over everything, then where something changed
  best,  ///< until nothing is left to gain
};

struct CrossingReport {
  double area_before = 0, area_after = 0;  ///< of all unconstrained faces inside, in areas of the box
  Index replacements = 0;                  ///< sets of tets replaced by others
};

/// Replaces tetrahedra until the total area of the unconstrained faces is locally least: the crossings of a
/// random line are expected to be proportional to it (the Cauchy-Crofton formula). The move is the one of
/// cone_finder.hpp, at every vertex, taken where it makes the area smaller; spec/crossings.md has what was
/// tried and measured.
///
/// The surface's points, constrained faces, the hull and regions stay as they are, and so do the ends of a
/// mesh of which space was left out; Steiner points move, and some go.
/// Every new tetrahedron is strictly positive by exact arithmetic. Tets keep their order, new ones stand
/// where the old ones did. Deterministic for any number of threads. About O(tets).
CrossingReport reduce_crossings(TetMesh& mesh, Optimize effort, Progress& progress);

}  // namespace tetprep
