// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include "prep/prep.hpp"

namespace tetprep {

enum class Optimize {
  none,
  fast,  ///< where faces are large
  best,  ///< everywhere, and with more Steiner points
};

struct CrossingReport {
  double area_before = 0, area_after = 0;    ///< of all unconstrained faces inside, in areas of the box
  Index replacements = 0;                    ///< sets of tets that gave way to others
  Index new_points = 0, dropped_points = 0;  ///< Steiner points
};

/// Replaces tetrahedra until the total area of the unconstrained faces is locally least: the crossings of a
/// random line are expected to be proportional to it (the Cauchy-Crofton formula). The move is that of
/// cone_finder.hpp, at every vertex and for new ones, taken where it makes the area smaller.
/// spec/crossings.md has what was tried and measured.
/// If mesh.region is known, Optimize::fast spends itself on the outside first.
///
/// The surface's points, constrained faces, the hull and regions stay as they are, and so do the ends of a
/// mesh of which space was left out; Steiner points move, come and go. Every new tetrahedron is strictly
/// positive by exact arithmetic. The order of tets is that of before with disturbances: sort_tets() is wanted
/// afterwards. Deterministic for any number of threads. About O(tets), by bounds on the rounds.
CrossingReport reduce_crossings(TetMesh& mesh, Optimize effort, Progress& progress);

}  // namespace tetprep
