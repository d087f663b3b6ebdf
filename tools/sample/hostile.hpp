// SPDX-License-Identifier: AGPL-3.0-or-later
// Surfaces on which inexact geometry fails: long, flat, and aligned.
#pragma once

#include <cstdint>

#include "sample/surface.hpp"

namespace tetprep {

/// Tetrahedra that are 4000 times as long as wide, each in a column of its own.
Surface make_needles(std::uint64_t triangles, std::uint64_t seed);

/// Piles of lenses, each a fan of 16 triangles above and one below, 10^5 times as wide as thick.
Surface make_slivers(std::uint64_t triangles, std::uint64_t seed);

/// Cubes with corners on the integer lattice, in rows and columns, none touching another: many vertices,
/// edges and faces lie on common lines and planes.
Surface make_lattice(std::uint64_t triangles, std::uint64_t seed);

inline constexpr std::uint64_t kNeedleTriangles = 4, kLensTriangles = 32, kCubeTriangles = 12;

}  // namespace tetprep
