// SPDX-License-Identifier: AGPL-3.0-or-later
#include "trace/light_queue.hpp"

#include "trace/glass.hpp"

namespace tetprep {
namespace {

constexpr Rgb kNothing{0, 0, 0};

void arrive(const Light& light, std::span<Sample> samples) {
  samples[light.sample].light = samples[light.sample].light + light.light;
}

}  // namespace

void LightQueue::answer(std::span<const Place> places, std::span<Sample> samples) {
  for (std::size_t i = 0; i < to_point_lights_.size(); ++i) answer_point_light(i, places, samples);
  answer_probed(places, samples);
  answer_traced(places, samples);
  size_ = 0;
}

void LightQueue::answer_point_light(std::size_t number, std::span<const Place> places,
                                    std::span<Sample> samples) {
  Questions& asked = to_point_lights_[number];
  outcomes_.resize(asked.rays.size());
  rays_.obstacles(places, asked.rays, scene_.point_lights[number], outcomes_);
  for (std::size_t i = 0; i < asked.rays.size(); ++i) {
    if (outcomes_[i] != tetfmt::Outcome::hit) {
      arrive(asked.lights[i], samples);
    } else if (scene_.has_glass) {
      traced_.add(asked.rays[i], asked.lights[i]);
    }
  }
  asked.clear();
}

void LightQueue::answer_probed(std::span<const Place> places, std::span<Sample> samples) {
  outcomes_.resize(probed_.rays.size());
  rays_.obstacles(places, probed_.rays, outcomes_);
  for (std::size_t i = 0; i < probed_.rays.size(); ++i) {
    if (outcomes_[i] != tetfmt::Outcome::hit) arrive(probed_.lights[i], samples);
  }
  probed_.clear();
}

void LightQueue::answer_traced(std::span<const Place> places, std::span<Sample> samples) {
  std::vector<Place> here, beyond;  // of rays that have passed glass
  for (int faces = 0; faces <= scene_.max_bounces && !traced_.rays.empty(); ++faces) {
    hits_.resize(traced_.rays.size());
    rays_.first_hits(places, traced_.rays, hits_);
    beyond.clear();
    for (std::size_t i = 0; i < hits_.size(); ++i) {
      SceneRay ray = traced_.rays[i];
      Light light = traced_.lights[i];
      const SceneHit& hit = hits_[i];
      const bool source = light.source != nullptr && hit && hit.part == light.source->part &&
                          hit.hit.triangle == light.source->triangle;
      if (!hit || source) {
        arrive(light, samples);
        continue;
      }
      const Rgb share = let_through(hit, ray.direction);
      if (!(brightest(share) > 0)) continue;
      // Those that go on take the places of those before, in order.
      const std::size_t next = beyond.size();
      light.light = light.light * share;
      ray.t_max -= hit.hit.t;
      ray.from = static_cast<std::uint32_t>(next);
      traced_.rays[next] = ray;
      traced_.lights[next] = light;
      beyond.push_back(rays_.far_side(hit));
    }
    traced_.rays.resize(beyond.size());
    traced_.lights.resize(beyond.size());
    here.swap(beyond);
    places = here;
  }
  traced_.clear();
}

Rgb LightQueue::let_through(const SceneHit& hit, tetfmt::Vec3f direction) const {
  if (!scene_.has_glass) return kNothing;
  const double size = length(vec3(direction));
  const Vec3 along = (1 / size) * vec3(direction);
  const SurfacePoint surface = surface_at(scene_, hit, along);
  if (surface.material.finish != Finish::glass) return kNothing;
  const Interface glass(hit, surface, along);
  Rgb share = (1 - glass.reflected) * surface.material.color;
  if (hit.hit.back) share = share * unabsorbed(surface.material, hit.hit.t * size);
  return share;
}

}  // namespace tetprep
