// SPDX-License-Identifier: AGPL-3.0-or-later
// Light that arrives along a ray: Whitted (1980), with light sources of any shape. Mirrors and glass send
// rays on; diffuse surfaces are lit by point lights, by mesh lights and, within a distance, by the
// background; they do not light each other.
#pragma once

#include "trace/rays.hpp"
#include "trace/sampling.hpp"
#include "trace/surface.hpp"

namespace tetprep {

class Integrator {
 public:
  /// For one sample of one pixel. Everything must outlive it.
  Integrator(const Scene& scene, const Camera& camera, Rays& rays, const Dice& dice)
      : scene_(scene), camera_(camera), rays_(rays), dice_(dice) {}

  /// Light that the camera receives from `direction`.
  Rgb seen_from(const Place& eye, tetfmt::Vec3f direction) {
    return arriving(RayKind::camera, eye, direction, {});
  }

 private:
  /// What led to a ray. The numbers drawn for it depend on the choices before, so that branches differ, and
  /// on nothing else: glass that neither bends nor reflects changes none.
  struct Path {
    double share = 1;      ///< of the pixel, that this ray is worth at most
    int bounces = 0;       ///< off mirrors and glass, so far
    std::uint64_t id = 1;  ///< 1, then a bit for each choice between reflection and refraction
    Path next(double fraction) const { return {share * fraction, bounces + 1, id}; }
    Path branch(bool reflected, double fraction) const {
      return {share * fraction, bounces + 1, id << 1 | static_cast<std::uint64_t>(reflected)};
    }
  };
  enum class Purpose : std::uint64_t { choice, light, ambient };
  static std::uint64_t purpose(const Path& path, Purpose what) {
    return path.id << 2 | static_cast<std::uint64_t>(what);
  }

  Rgb arriving(RayKind kind, const Place& from, tetfmt::Vec3f direction, const Path& path);
  Rgb mirrored(const SceneHit& hit, const SurfacePoint& surface, Vec3 along, const Path& path);
  Rgb through_glass(const SceneHit& hit, const SurfacePoint& surface, Vec3 along, const Path& path);

  /// Light that a white diffuse surface scatters.
  Rgb scattered(const SceneHit& hit, const SurfacePoint& surface, const Path& path);
  Rgb from_point_lights(const Place& here, const SurfacePoint& surface);
  Rgb from_mesh_lights(const Place& here, const SceneHit& hit, const SurfacePoint& surface, const Path& path);
  Rgb from_background(const Place& here, const SurfacePoint& surface, const Path& path);

  /// The share of light that comes along a straight line from `t_max` away, or from `target`: none if
  /// anything but glass is between. Glass lets light through as it would at this angle, but does not bend it:
  /// shadows of glass are bright, and have no caustics.
  Rgb let_through(RayKind kind, const Place& from, tetfmt::Vec3f direction, double t_max,
                  const LightTriangle* target);
  Rgb background(Vec3 direction) const;

  const Scene& scene_;
  const Camera& camera_;
  Rays& rays_;
  const Dice& dice_;
};

}  // namespace tetprep
