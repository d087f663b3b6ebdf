// SPDX-License-Identifier: AGPL-3.0-or-later
// Rays through all files of a scene. The walks are libtetfmt's; none of the rays here needs an offset,
// because each starts in a tetrahedron that is known.
#pragma once

#include <array>
#include <span>

#include "trace/scene.hpp"

namespace tetprep {

enum class RayKind : std::uint8_t {
  camera,
  shadow,      ///< to a point light
  light,       ///< to a point of a mesh light
  reflection,  ///< from a mirror, or the part that glass sends back
  refraction,  ///< into glass and out of it
  ambient,     ///< ambient occlusion
};
inline constexpr std::array<const char*, 6> kRayKindNames{"camera",     "shadow",     "light",
                                                          "reflection", "refraction", "ambient occlusion"};

struct RayCounts {
  std::array<std::uint64_t, kRayKindNames.size()> rays{};
  std::uint64_t hits = 0;   ///< of camera rays
  std::uint64_t walks = 0;  ///< that told their steps: those which asked for a hit
  std::uint64_t steps = 0;
  std::uint64_t lost = 0;  ///< float signs went in circles (Kernel::float_only)
  std::uint32_t most_steps = 0;

  std::uint64_t total() const;
  void add(const RayCounts& other);
};

/// Where a ray starts: a side of a face of one part, or a place that was located in all of them.
struct Place {
  Vec3 position;                                 ///< world
  std::span<const tetfmt::Location> everywhere;  ///< of each part; empty: see below
  std::size_t part = 0;                          ///< whose coordinates and tetrahedra `own` has
  tetfmt::Location own;
};

struct SceneHit {
  tetfmt::Hit hit;  ///< its steps are those in all parts
  std::size_t part = 0;
  explicit operator bool() const { return hit.outcome == tetfmt::Outcome::hit; }
};

/// Answers rays, and counts them. For one thread; the scene must outlive it. Throws Failure (invalid) where a
/// walk meets bytes that are no mesh.
class Rays {
 public:
  Rays(const Scene& scene, tetfmt::Kernel kernel) : scene_(scene), kernel_(kernel) {}

  /// The nearest of the files' first hits, at most `t_max` away in units of the direction.
  SceneHit first_hit(RayKind kind, const Place& from, tetfmt::Vec3f direction, double t_max = kFar);
  /// Whether anything is nearer than `t_max`.
  bool blocked(RayKind kind, const Place& from, tetfmt::Vec3f direction, double t_max);
  /// Whether anything is between the place and the light, on the exact line.
  bool blocked(const Place& from, const LocatedLight& light);

  /// Where rays from a hit start: on the side that the ray came from, and on the other one. Throws Failure
  /// (usage) if the file leaves out what is there.
  Place near_side(const SceneHit& hit) const;
  Place far_side(const SceneHit& hit) const;

  const RayCounts& counts() const { return counts_; }

 private:
  static constexpr double kFar = std::numeric_limits<double>::infinity();
  Place side(const SceneHit& hit, const tetfmt::Location& location) const;
  /// Calls `walk(part, location)` for each part whose box the ray may meet before `t_max()`, until it returns
  /// false.
  template <class TMax, class Walk>
  void each_part(const Place& from, Vec3 direction, TMax t_max, Walk walk) const;
  /// Whether `outcome` is a hit; counts and throws as it must.
  bool is_hit(tetfmt::Outcome outcome, const Part& part);

  const Scene& scene_;
  tetfmt::Kernel kernel_;
  RayCounts counts_;
};

}  // namespace tetprep
