// SPDX-License-Identifier: AGPL-3.0-or-later
#include "trace/integrate.hpp"

#include <algorithm>
#include <cmath>

#include "trace/glass.hpp"
#include "trace/shade.hpp"

namespace tetprep {
namespace {

constexpr double kPi = 3.141592653589793;
/// Glass sends two rays on while the fainter is worth at least this share of the pixel; then one of them,
/// drawn by its share. So there are at most 32 paths at a time, and no noise where it would show most.
constexpr double kLeastShare = 1.0 / 32;
/// The queue is answered when it holds this many questions, which bounds memory; waves are smaller as a rule.
constexpr std::size_t kMostQuestions = 1u << 15;

Rgb grey(double level) {
  return {level, level, level};
}

}  // namespace

void Integrator::add_light(std::span<Sample> samples) {
  samples_ = samples;
  for (std::uint32_t i = 0; i < samples.size(); ++i) arrive({i}, samples[i].direction, samples[i].hit);
  Wave wave;
  std::vector<SceneHit> hits;
  for (;;) {
    queue_.answer(places_, samples_);
    if (next_.rays.empty()) break;
    std::swap(wave, next_);
    hits.resize(wave.rays.size());
    rays_.first_hits(places_, wave.rays, hits);
    places_.clear(), next_.rays.clear(), next_.paths.clear();
    for (std::size_t i = 0; i < hits.size(); ++i) arrive(wave.paths[i], wave.rays[i].direction, hits[i]);
  }
  places_.clear();
}

std::uint32_t Integrator::add_place(const Place& place) {
  places_.push_back(place);
  return static_cast<std::uint32_t>(places_.size() - 1);
}

void Integrator::send(RayKind kind, const Place& from, Vec3 direction, const Path& path) {
  next_.rays.push_back({kind, add_place(from), rounded(direction)});
  next_.paths.push_back(path);
}

Rgb Integrator::background(Vec3 direction) const {
  return mix(scene_.background.bottom, scene_.background.top, 0.5 + 0.5 * dot(unit(direction), scene_.up));
}

void Integrator::arrive(const Path& path, tetfmt::Vec3f direction, const SceneHit& hit) {
  if (!hit) return add(path, background(vec3(direction)));
  const double size = length(vec3(direction));
  const Vec3 along = (1 / size) * vec3(direction);
  const SurfacePoint surface = surface_at(scene_, hit, along);
  const Material& material = surface.material;
  Path here = path;
  // The ray was inside of the glass that it met from behind.
  if (material.finish == Finish::glass && hit.hit.back)
    here = path.weighted(unabsorbed(material, hit.hit.t * size));
  add(here, material.emission);
  if (material.finish == Finish::diffuse) return scatter(hit, surface, here.weighted(material.color));
  if (path.bounces >= scene_.max_bounces) return;
  if (material.finish == Finish::mirror) {
    mirror(hit, surface, along, here);
  } else {
    pass_glass(hit, surface, along, here);
  }
}

void Integrator::mirror(const SceneHit& hit, const SurfacePoint& surface, Vec3 along, const Path& path) {
  const double share = brightest(surface.material.color);
  if (!(share > 0)) return;
  const Vec3 out = kept_above(reflected(along, surface.normal), surface.true_normal);
  send(RayKind::reflection, rays_.near_side(hit), out, path.weighted(surface.material.color).next(share));
}

void Integrator::pass_glass(const SceneHit& hit, const SurfacePoint& surface, Vec3 along, const Path& path) {
  const Interface glass(hit, surface, along);
  const auto reflection = [&](const Path& next) {
    const Vec3 out = kept_above(reflected(along, surface.normal), surface.true_normal);
    send(RayKind::reflection, rays_.near_side(hit), out, next);
  };
  const auto refraction = [&](const Path& next) {
    // There is one: the share that is reflected is less than 1.
    const Vec3 bent = refracted(along, surface.normal, glass.ratio).value_or(along);
    const Vec3 out = -kept_above(-bent, surface.true_normal);
    send(RayKind::refraction, rays_.far_side(hit), out, next.weighted(surface.material.color));
  };
  const double back = glass.reflected, on = 1 - glass.reflected;
  if (on == 0) return reflection(path.next(1));
  if (back == 0) return refraction(path.next(1));
  if (path.share * std::min(back, on) >= kLeastShare) {
    reflection(path.branch(true, back).weighted(grey(back)));
    refraction(path.branch(false, on).weighted(grey(on)));
  } else if (dice(path).number(purpose(path, Purpose::choice)) < back) {
    reflection(path.branch(true, 1));
  } else {
    refraction(path.branch(false, 1));
  }
}

void Integrator::scatter(const SceneHit& hit, const SurfacePoint& surface, const Path& path) {
  if (!(brightest(path.weight) > 0)) return;
  if (!scene_.lit()) return add(path, camera_light(surface.normal, camera_));
  if (queue_.size() >= kMostQuestions) queue_.answer(places_, samples_);
  const std::uint32_t here = add_place(rays_.near_side(hit));
  ask_point_lights(here, surface, path);
  if (!scene_.light_triangles.empty()) ask_mesh_lights(here, hit, surface, path);
  if (scene_.ambient) ask_background(here, surface, path);
}

void Integrator::ask_point_lights(std::uint32_t here, const SurfacePoint& surface, const Path& path) {
  for (std::size_t i = 0; i < scene_.point_lights.size(); ++i) {
    const LocatedLight& light = scene_.point_lights[i];
    const Vec3 to = light.position - places_[here].position;
    const double distance = length(to), cosine = dot(surface.normal, to) / distance;
    // An interpolated normal may turn to a light that the true surface turns its back on.
    if (!(cosine > 0) || !(dot(surface.true_normal, to) > 0)) continue;
    const Rgb scattered = path.weight * light.intensity;
    queue_.add_point_light(i, {RayKind::shadow, here, rounded(to), 1},
                           {(cosine / (kPi * distance * distance)) * scattered, path.sample});
  }
}

void Integrator::ask_mesh_lights(std::uint32_t here, const SceneHit& hit, const SurfacePoint& surface,
                                 const Path& path) {
  const auto& shares = scene_.light_shares;
  const auto count = static_cast<std::uint64_t>(scene_.light_samples);
  const Vec3 position = places_[here].position;
  for (std::uint64_t k = 0; k < count; ++k) {
    auto point = dice(path).point(purpose(path, Purpose::light), k, count);
    const auto i = static_cast<std::size_t>(
        std::min(std::upper_bound(shares.begin(), shares.end(), point[0]), shares.end() - 1) -
        shares.begin());
    // Within the triangle's stretch of the unit interval, the number is an even draw again.
    const double low = i == 0 ? 0 : shares[i - 1];
    point[0] = (point[0] - low) / (shares[i] - low);
    const LightTriangle& light = scene_.light_triangles[i];
    if (light.part == hit.part && light.triangle == hit.hit.triangle) continue;
    const auto weights = triangle_weights(point);
    const Vec3 to = light.corner + weights[0] * light.edge1 + weights[1] * light.edge2 - position;
    const double distance = length(to), cosine = dot(surface.normal, to) / distance;
    if (!(cosine > 0) || !(dot(surface.true_normal, to) > 0)) continue;
    const double tilt = std::abs(dot(unit(cross(light.edge1, light.edge2)), to)) / distance;
    const double share =
        cosine * tilt / (kPi * distance * distance * light.chance * static_cast<double>(count));
    queue_.add({RayKind::light, here, rounded((1 / distance) * to)},
               {share * (path.weight * light.emission), path.sample, &light});
  }
}

void Integrator::ask_background(std::uint32_t here, const SurfacePoint& surface, const Path& path) {
  const auto count = static_cast<std::uint64_t>(scene_.ambient->samples);
  for (std::uint64_t k = 0; k < count; ++k) {
    const auto point = dice(path).point(purpose(path, Purpose::ambient), k, count);
    const Vec3 to = kept_above(cosine_direction(surface.normal, point), surface.true_normal);
    const Rgb light = (1.0 / static_cast<double>(count)) * (path.weight * background(to));
    queue_.add({RayKind::ambient, here, rounded(to), scene_.ambient->distance}, {light, path.sample});
  }
}

}  // namespace tetprep
