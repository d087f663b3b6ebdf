// SPDX-License-Identifier: AGPL-3.0-or-later
// Surfaces that tetrahedralisers crash on, made rather than found. All are the same on every machine up to
// the last bits of sines and cosines.
#pragma once

#include <cstdint>

#include "prep/prep_support.hpp"

namespace tetprep_test {

/// `count` triangles in the unit cube, corners within `reach` of a common place (1: anywhere).
TriangleSoup random_triangles(int count, double reach, std::uint64_t seed = 1);

/// The same in one plane that is parallel to no axis. Coordinates are whole numbers, so that they really do
/// lie in one after snapping.
TriangleSoup coplanar_triangles(int count, double reach, std::uint64_t seed = 1);

/// Triangles around a common apex, each half as wide as the one before, from 1 radian down to `least_angle`;
/// not in one plane; and the same fan again, tilted the other way, so that each cuts its like.
TriangleSoup needle_fans(double least_angle);

/// `count` spheres around one centre, radii 1/count to 1, each of 12 n^2 triangles.
TriangleSoup nested_spheres(int count, int n);

/// Spheres of 12 n^2 triangles in a row, each touching the next: in a corner of both if n is even, in
/// overlapping triangles of one plane if it is odd.
TriangleSoup touching_spheres(int count, int n);

/// The surface twice, the second time moved by `steps` of the grid that it is snapped to.
TriangleSoup doubled(const TriangleSoup& soup, const std::array<double, 3>& steps);

/// `count` triangles around one edge; with `crossed`, two more that cut through all of them.
TriangleSoup sheets(int count, bool crossed);

/// `count` tetrahedra in a cubic lattice, a tenth of a cell wide, no two alike; with `overlapping`, three
/// cells wide.
TriangleSoup tiny_components(int count, bool overlapping = false, std::uint64_t seed = 1);

}  // namespace tetprep_test
