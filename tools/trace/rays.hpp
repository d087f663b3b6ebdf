// SPDX-License-Identifier: AGPL-3.0-or-later
// Rays through all files of a scene, many at a time: the library walks rays together, those of one place and
// those of many. None of them needs an offset, because each starts in a tetrahedron that is known.
#pragma once

#include <array>
#include <limits>
#include <span>
#include <vector>

#include "trace/scene.hpp"
#include "trace/walks.hpp"

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
  std::uint64_t hits = 0;        ///< of camera rays
  std::uint64_t visits = 0;      ///< of tetrahedra, by camera rays; once for all that were in one together
  std::uint64_t lost = 0;        ///< float signs went in circles
  std::uint32_t most_steps = 0;  ///< of a camera ray; 0 if they were walked together

  std::uint64_t total() const;
  void add(const RayCounts& other);
};

/// Where rays go on: on a side of a face of one part.
struct Place {
  Vec3 position;  ///< world
  std::size_t part = 0;
  tetfmt::Location location;  ///< in that part
};

/// A ray from one of many places.
struct SceneRay {
  static constexpr double kFar = std::numeric_limits<double>::infinity();
  RayKind kind;
  std::uint32_t from;  ///< the number of its place
  tetfmt::Vec3f direction;
  double t_max = kFar;  ///< in units of the direction
};

struct SceneHit {
  tetfmt::Hit hit;  ///< of a camera ray walked one by one, its steps are those in all parts
  std::size_t part = 0;
  explicit operator bool() const { return hit.outcome == tetfmt::Outcome::hit; }
};

/// Answers rays, and counts them. For one thread; the scene must outlive it. Throws Failure (invalid) where a
/// walk meets bytes that are no mesh. Where answers are outcomes, `hit` means that something is in the way.
class Rays {
 public:
  Rays(const Scene& scene, Walks walks) : scene_(scene), walks_(walks) {}

  /// The nearest of the parts' first hits, for camera rays of one place (locate_everywhere); best if
  /// neighbours are close, in the order that tetfmt::first_hits says.
  void first_hits(std::span<const tetfmt::Location> eye, std::span<const tetfmt::Vec3f> directions,
                  std::span<SceneHit> hits);
  /// The same for rays from many places.
  void first_hits(std::span<const Place> places, std::span<const SceneRay> rays, std::span<SceneHit> hits);
  /// Whether anything is in their way.
  void obstacles(std::span<const Place> places, std::span<const SceneRay> rays,
                 std::span<tetfmt::Outcome> outcomes);
  /// Whether anything is between the places and a light, on the exact lines; best if neighbours are seen from
  /// the light in close directions. Each ray is one to the light, from a place of its own, with t_max = 1.
  void obstacles(std::span<const Place> places, std::span<const SceneRay> rays, const LocatedLight& light,
                 std::span<tetfmt::Outcome> outcomes);

  /// Where rays from a hit start: on the side that the ray came from, and on the other one. Throws Failure
  /// (invalid) if the file leaves out what is there.
  Place near_side(const SceneHit& hit) const;
  Place far_side(const SceneHit& hit) const;

  const RayCounts& counts() const { return counts_; }

 private:
  /// The rays that may meet the box of one part, as that part takes them.
  struct Batch {
    std::vector<tetfmt::Location> places;
    std::vector<tetfmt::BatchRay> rays;
    std::vector<std::size_t> numbers;  ///< of these rays among all
    std::vector<tetfmt::Hit> hits;     ///< the answers, of one sort or the other
    std::vector<tetfmt::Outcome> outcomes;
  };
  /// Counts the rays, and sets out to follow each as far as it goes.
  void begin(std::span<const SceneRay> rays);
  /// `share`: rays of one place that follow each other share it in the batch; else it has a place for each
  /// ray.
  void gather(std::size_t part, std::span<const Place> places, std::span<const SceneRay> rays, bool share);
  /// `ask(part)` fills in the batch's outcomes. What is in the way in one part is not asked of the next.
  template <class Ask>
  void each_part_obstacles(std::span<const Place> places, std::span<const SceneRay> rays,
                           std::span<tetfmt::Outcome> outcomes, bool share, Ask ask);
  /// Whether `outcome` is a hit; counts and throws as it must.
  bool is_hit(tetfmt::Outcome outcome, const Part& part);
  Place side(const SceneHit& hit, const tetfmt::Location& location) const;

  const Scene& scene_;
  Walks walks_;
  RayCounts counts_;
  Batch batch_;
  std::vector<double> reach_;  ///< of each ray: how far it is still to be followed; below 0: not at all
};

}  // namespace tetprep
