// SPDX-License-Identifier: AGPL-3.0-or-later
// Rays that are usual, and rays that are meant to hurt, around one mesh.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "bench/dice.hpp"
#include "bench/truth/surface.hpp"
#include "tetfmt/mesh.hpp"
#include "tetfmt/traverse.hpp"

namespace tetbench {

/// What is done with the rays of a set.
enum class Flow : std::uint8_t {
  rays,       ///< first hits, and all hits of a share
  crossings,  ///< all hits of every ray
  shared,     ///< first hits of many rays from one place, and occlusion from it to many others, one by
              ///< one and together
  bounces,    ///< first hits, then three times a ray from a side of the face that was met
  segments,   ///< occlusion between two places
};

struct RaySet {
  const char* name;
  const char* description;
  Flow flow = Flow::rays;
  int weight = 1;  ///< its share of the rays
};

/// In the order in which they are run.
std::span<const RaySet> ray_sets();

struct Shot {
  tetfmt::Vec3f origin, direction;
  tetfmt::Interval interval;
};

/// Shots around a mesh. Sets that aim at a vertex, an edge or a plane do so exactly: the float32 ray, taken
/// as it is, passes through it; where float32 does not hold such a ray, another is drawn.
class RayMaker {
 public:
  /// Both must outlive the maker. The mesh must have a surface.
  RayMaker(const tetfmt::Mesh& mesh, const Surface& surface);

  Shot make(const RaySet& set, Dice& dice) const;
  /// A place for segments to begin or end: anywhere in the box, on a vertex, an edge, a face, outside.
  tetfmt::Vec3f end_point(Dice& dice) const;

 private:
  /// A point in quarters of grid steps: sums and differences of these are exact, unlike those of floats.
  using Lattice = std::array<std::int64_t, 3>;

  std::optional<Shot> try_make(std::string_view set, Dice& dice) const;
  Shot outside(Dice& dice) const;
  Shot inside(Dice& dice) const;
  std::optional<Shot> far(Dice& dice, double sizes) const;
  std::optional<Shot> axis(Dice& dice) const;
  std::optional<Shot> along_edge(Dice& dice) const;
  std::optional<Shot> in_plane(Dice& dice) const;
  std::optional<Shot> with_interval(Dice& dice) const;
  Shot zero_components(Dice& dice) const;
  Shot denormal_components(Dice& dice) const;
  /// From a point in any direction, or exactly at a vertex or an edge, or along an axis.
  std::optional<Shot> from(const Lattice& point, Dice& dice) const;
  std::optional<Shot> aimed(const Lattice& start, Lattice (RayMaker::*target)(Dice&) const, Dice& dice) const;
  std::optional<Shot> through(const Lattice& from, const Lattice& target) const;

  Lattice vertex(Dice& dice) const;
  Lattice surface_vertex(Dice& dice) const;
  Lattice edge_point(Dice& dice) const;
  Lattice face_point(Dice& dice) const;
  Lattice tet_edge_midpoint(Dice& dice) const;
  Lattice hull_point(Dice& dice) const;
  Lattice near_point(Dice& dice) const;
  Lattice outside_point(Dice& dice) const;
  Lattice lattice(tetfmt::Index vertex) const;
  const Face& face(Dice& dice) const;
  std::optional<tetfmt::Vec3f> point(const Lattice& p) const;

  const tetfmt::Mesh& mesh_;
  const Surface& surface_;
  std::vector<std::array<tetfmt::Index, 2>> edges_;  ///< of the surface, sorted
  std::vector<std::array<tetfmt::Index, 3>> hull_;
  Vec3d low_{}, high_{};
  double size_ = 0;     ///< of the box's diagonal
  double quarter_ = 0;  ///< of a grid step
};

}  // namespace tetbench
