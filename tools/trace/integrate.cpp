// SPDX-License-Identifier: AGPL-3.0-or-later
#include "trace/integrate.hpp"

#include <algorithm>
#include <cmath>

#include "trace/optics.hpp"
#include "trace/shade.hpp"

namespace tetprep {
namespace {

constexpr double kPi = 3.141592653589793;
/// Glass sends two rays on while the fainter is worth at least this share of the pixel; then one of them,
/// drawn by its share. So there are at most 32 paths at a time, and no noise where it would show most.
constexpr double kLeastShare = 1.0 / 32;
constexpr Rgb kAll{1, 1, 1}, kNothing{0, 0, 0};

/// What glass leaves of light that has passed `length` of it (Beer and Lambert).
Rgb unabsorbed(const Material& glass, double length) {
  return {std::exp(-glass.absorption.r * length), std::exp(-glass.absorption.g * length),
          std::exp(-glass.absorption.b * length)};
}

/// Glass at a hit: index of refraction on the ray's side over that beyond, and what is reflected.
struct Interface {
  double ratio, reflected;
  Interface(const SceneHit& hit, const SurfacePoint& surface, Vec3 along)
      : ratio(hit.hit.back ? surface.material.ior : 1 / surface.material.ior),
        reflected(reflectance(std::clamp(-dot(along, surface.normal), 0.0, 1.0), ratio)) {}
};

}  // namespace

Rgb Integrator::background(Vec3 direction) const {
  return mix(scene_.background.bottom, scene_.background.top, 0.5 + 0.5 * dot(unit(direction), scene_.up));
}

Rgb Integrator::arriving(RayKind kind, const Place& from, tetfmt::Vec3f direction, const Path& path) {
  const SceneHit hit = rays_.first_hit(kind, from, direction);
  if (!hit) return background(vec3(direction));
  const double size = length(vec3(direction));
  const Vec3 along = (1 / size) * vec3(direction);
  const SurfacePoint surface = surface_at(scene_, hit, along);
  const Material& material = surface.material;
  if (material.finish == Finish::diffuse) {
    return material.emission + material.color * scattered(hit, surface, path);
  }
  Rgb light;
  if (path.bounces < scene_.max_bounces) {
    light = material.finish == Finish::mirror ? mirrored(hit, surface, along, path)
                                              : through_glass(hit, surface, along, path);
  }
  light = material.emission + light;
  // The ray was inside of the glass that it met from behind.
  if (material.finish == Finish::glass && hit.hit.back)
    light = light * unabsorbed(material, hit.hit.t * size);
  return light;
}

Rgb Integrator::mirrored(const SceneHit& hit, const SurfacePoint& surface, Vec3 along, const Path& path) {
  const Vec3 out = kept_above(reflected(along, surface.normal), surface.true_normal);
  const double share = brightest(surface.material.color);
  if (!(share > 0)) return kNothing;
  return surface.material.color *
         arriving(RayKind::reflection, rays_.near_side(hit), rounded(out), path.next(share));
}

Rgb Integrator::through_glass(const SceneHit& hit, const SurfacePoint& surface, Vec3 along,
                              const Path& path) {
  const Interface glass(hit, surface, along);
  const auto reflection = [&](const Path& next) {
    const Vec3 out = kept_above(reflected(along, surface.normal), surface.true_normal);
    return arriving(RayKind::reflection, rays_.near_side(hit), rounded(out), next);
  };
  const auto refraction = [&](const Path& next) {
    // There is one: the share that is reflected is less than 1.
    const Vec3 bent = refracted(along, surface.normal, glass.ratio).value_or(along);
    const Vec3 out = -kept_above(-bent, surface.true_normal);
    return surface.material.color * arriving(RayKind::refraction, rays_.far_side(hit), rounded(out), next);
  };
  const double back = glass.reflected, on = 1 - glass.reflected;
  if (on == 0) return reflection(path.next(1));
  if (back == 0) return refraction(path.next(1));
  if (path.share * std::min(back, on) >= kLeastShare)
    return back * reflection(path.branch(true, back)) + on * refraction(path.branch(false, on));
  return dice_.number(purpose(path, Purpose::choice)) < back ? reflection(path.branch(true, 1))
                                                             : refraction(path.branch(false, 1));
}

Rgb Integrator::scattered(const SceneHit& hit, const SurfacePoint& surface, const Path& path) {
  if (!scene_.lit()) return camera_light(surface.normal, camera_);
  const Place here = rays_.near_side(hit);
  Rgb sum;
  if (!scene_.point_lights.empty()) sum = sum + from_point_lights(here, surface);
  if (!scene_.light_triangles.empty()) sum = sum + from_mesh_lights(here, hit, surface, path);
  if (scene_.ambient) sum = sum + from_background(here, surface, path);
  return sum;
}

Rgb Integrator::from_point_lights(const Place& here, const SurfacePoint& surface) {
  Rgb sum;
  for (const LocatedLight& light : scene_.point_lights) {
    const Vec3 to = light.position - here.position;
    const double distance = length(to), cosine = dot(surface.normal, to) / distance;
    // An interpolated normal may turn to a light that the true surface turns its back on.
    if (!(cosine > 0) || !(dot(surface.true_normal, to) > 0)) continue;
    Rgb share = kAll;
    if (rays_.blocked(here, light))
      share = scene_.has_glass ? let_through(RayKind::shadow, here, rounded(to), 1, nullptr) : kNothing;
    sum = sum + (cosine / (kPi * distance * distance)) * (share * light.intensity);
  }
  return sum;
}

Rgb Integrator::from_mesh_lights(const Place& here, const SceneHit& hit, const SurfacePoint& surface,
                                 const Path& path) {
  const auto& shares = scene_.light_shares;
  const auto count = static_cast<std::uint64_t>(scene_.light_samples);
  Rgb sum;
  for (std::uint64_t k = 0; k < count; ++k) {
    auto point = dice_.point(purpose(path, Purpose::light), k, count);
    const auto i = static_cast<std::size_t>(
        std::min(std::upper_bound(shares.begin(), shares.end(), point[0]), shares.end() - 1) -
        shares.begin());
    // Within the triangle's stretch of the unit interval, the number is an even draw again.
    const double low = i == 0 ? 0 : shares[i - 1];
    point[0] = (point[0] - low) / (shares[i] - low);
    const LightTriangle& light = scene_.light_triangles[i];
    if (light.part == hit.part && light.triangle == hit.hit.triangle) continue;
    const auto weights = triangle_weights(point);
    const Vec3 to = light.corner + weights[0] * light.edge1 + weights[1] * light.edge2 - here.position;
    const double distance = length(to), cosine = dot(surface.normal, to) / distance;
    if (!(cosine > 0) || !(dot(surface.true_normal, to) > 0)) continue;
    const double tilt = std::abs(dot(unit(cross(light.edge1, light.edge2)), to)) / distance;
    const Rgb share = let_through(RayKind::light, here, rounded((1 / distance) * to),
                                  std::numeric_limits<double>::infinity(), &light);
    sum = sum + (cosine * tilt / (kPi * distance * distance * light.chance)) * (share * light.emission);
  }
  return (1.0 / static_cast<double>(count)) * sum;
}

Rgb Integrator::from_background(const Place& here, const SurfacePoint& surface, const Path& path) {
  const auto count = static_cast<std::uint64_t>(scene_.ambient->samples);
  Rgb sum;
  for (std::uint64_t k = 0; k < count; ++k) {
    const auto point = dice_.point(purpose(path, Purpose::ambient), k, count);
    const Vec3 to = kept_above(cosine_direction(surface.normal, point), surface.true_normal);
    const tetfmt::Vec3f direction = rounded(to);
    Rgb share = kAll;
    if (scene_.has_glass) {
      share = let_through(RayKind::ambient, here, direction, scene_.ambient->distance, nullptr);
    } else if (rays_.blocked(RayKind::ambient, here, direction, scene_.ambient->distance)) {
      continue;
    }
    sum = sum + share * background(to);
  }
  return (1.0 / static_cast<double>(count)) * sum;
}

Rgb Integrator::let_through(RayKind kind, const Place& from, tetfmt::Vec3f direction, double t_max,
                            const LightTriangle* target) {
  const double size = length(vec3(direction));
  const Vec3 along = (1 / size) * vec3(direction);
  Rgb left = kAll;
  Place at = from;
  for (int faces = 0; faces <= scene_.max_bounces; ++faces) {
    const SceneHit hit = rays_.first_hit(kind, at, direction, t_max);
    if (!hit) return left;
    if (target != nullptr && hit.part == target->part && hit.hit.triangle == target->triangle) return left;
    if (!scene_.has_glass) return kNothing;
    const SurfacePoint surface = surface_at(scene_, hit, along);
    if (surface.material.finish != Finish::glass) return kNothing;
    const Interface glass(hit, surface, along);
    if (glass.reflected >= 1) return kNothing;
    left = (1 - glass.reflected) * (left * surface.material.color);
    if (hit.hit.back) left = left * unabsorbed(surface.material, hit.hit.t * size);
    t_max -= hit.hit.t;
    at = rays_.far_side(hit);
  }
  return kNothing;
}

}  // namespace tetprep
