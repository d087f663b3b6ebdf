// SPDX-License-Identifier: AGPL-3.0-or-later
// Light that arrives along camera rays: Whitted (1980), with light sources of any shape. Mirrors and glass
// send rays on; diffuse surfaces are lit by point lights, by mesh lights and, within a distance, by the
// background; they do not light each other.
//
// Rays are asked in waves, because many rays at a time cost less than as many one by one: what a wave of hits
// wants to know of light is collected and asked together (LightQueue), and what it sends on is the next wave.
// So a path carries its weight, the share of what it meets that reaches the camera, and adds to its sample.
#pragma once

#include "trace/light_queue.hpp"

namespace tetprep {

/// For one thread. Everything must outlive it.
class Integrator {
 public:
  Integrator(const Scene& scene, const Camera& camera, Rays& rays)
      : scene_(scene), camera_(camera), rays_(rays), queue_(scene, rays) {}

  /// Adds to each sample the light that the camera receives along it.
  void add_light(std::span<Sample> samples);

 private:
  /// What led to a ray. The numbers drawn for it depend on the choices before, so that branches differ, and
  /// on nothing else: glass that neither bends nor reflects changes none.
  struct Path {
    std::uint32_t sample = 0;
    Rgb weight{1, 1, 1};   ///< of what arrives, the share that reaches the camera
    double share = 1;      ///< of the pixel, that this ray is worth at most
    int bounces = 0;       ///< off mirrors and glass, so far
    std::uint64_t id = 1;  ///< 1, then a bit for each choice between reflection and refraction
    Path next(double fraction) const { return {sample, weight, share * fraction, bounces + 1, id}; }
    Path branch(bool reflected, double fraction) const {
      return {sample, weight, share * fraction, bounces + 1, id << 1 | static_cast<std::uint64_t>(reflected)};
    }
    Path weighted(Rgb factor) const { return {sample, weight * factor, share, bounces, id}; }
  };
  enum class Purpose : std::uint64_t { choice, light, ambient };
  static std::uint64_t purpose(const Path& path, Purpose what) {
    return path.id << 2 | static_cast<std::uint64_t>(what);
  }
  const Dice& dice(const Path& path) const { return samples_[path.sample].dice; }

  void add(const Path& path, Rgb light) {
    samples_[path.sample].light = samples_[path.sample].light + path.weight * light;
  }
  void arrive(const Path& path, tetfmt::Vec3f direction, const SceneHit& hit);
  void mirror(const SceneHit& hit, const SurfacePoint& surface, Vec3 along, const Path& path);
  void pass_glass(const SceneHit& hit, const SurfacePoint& surface, Vec3 along, const Path& path);
  /// Sends a ray on in the next wave.
  void send(RayKind kind, const Place& from, Vec3 direction, const Path& path);

  /// Asks for the light that a diffuse surface scatters; its colour is in the path's weight.
  void scatter(const SceneHit& hit, const SurfacePoint& surface, const Path& path);
  void ask_point_lights(std::uint32_t here, const SurfacePoint& surface, const Path& path);
  void ask_mesh_lights(std::uint32_t here, const SceneHit& hit, const SurfacePoint& surface,
                       const Path& path);
  void ask_background(std::uint32_t here, const SurfacePoint& surface, const Path& path);
  Rgb background(Vec3 direction) const;
  /// The number of a place from where rays will start.
  std::uint32_t add_place(const Place& place);

  struct Wave {
    std::vector<SceneRay> rays;
    std::vector<Path> paths;
  };
  const Scene& scene_;
  const Camera& camera_;
  Rays& rays_;
  LightQueue queue_;
  std::span<Sample> samples_;
  std::vector<Place> places_;  ///< from where the next wave starts, and what is in the queue
  Wave next_;
};

}  // namespace tetprep
