// SPDX-License-Identifier: AGPL-3.0-or-later
// Procedural triangle surfaces, for tests, demonstrations and scale.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace tetprep {

/// Shared vertices, float32 coordinates. Same arguments, same surface, on every machine.
struct Surface {
  std::vector<std::array<float, 3>> points;
  std::vector<std::array<std::uint32_t, 3>> triangles;
};

/// A procedural surface. make() gives about as many triangles as asked for (the count of a grid has to
/// factor), free of self-intersections from `minimum` triangles on. A closed surface is watertight and its
/// triangles point outward.
struct SurfaceKind {
  const char* name;
  const char* description;
  bool closed;
  std::uint64_t minimum;
  Surface (*make)(std::uint64_t triangles, std::uint64_t seed);
};

/// sphere, torus-knot, bumpy-plane, knots; and for tests that are meant to hurt: needles, slivers, lattice.
std::span<const SurfaceKind> surface_kinds();

/// Above this, vertex and triangle numbers would not fit where they must.
inline constexpr std::uint64_t kMaxSampleTriangles = 500'000'000;

}  // namespace tetprep
