// SPDX-License-Identifier: AGPL-3.0-or-later
// Light that arrives if nothing is in its way: what is to be asked is collected, then asked together.
#pragma once

#include "trace/rays.hpp"
#include "trace/sampling.hpp"
#include "trace/surface.hpp"

namespace tetprep {

/// A camera ray with its hit, and the light that it brings.
struct Sample {
  tetfmt::Vec3f direction;
  SceneHit hit;
  Dice dice;
  Rgb light;
};

/// What arrives along a ray from a surface, if nothing but glass is between. Glass lets light through as it
/// would at this angle, but does not bend it: shadows of glass are bright, and have no caustics.
struct Light {
  Rgb light;
  std::uint32_t sample = 0;               ///< to which it is added
  const LightTriangle* source = nullptr;  ///< is not in its own way
};

/// Everything must outlive it.
class LightQueue {
 public:
  LightQueue(const Scene& scene, Rays& rays)
      : scene_(scene), rays_(rays), to_point_lights_(scene.point_lights.size()) {}

  /// The ray leads to the point light of that number, with t_max = 1.
  void add_point_light(std::size_t number, const SceneRay& ray, const Light& light) {
    to_point_lights_[number].add(ray, light);
    ++size_;
  }
  void add(const SceneRay& ray, const Light& light) {
    // Where nothing lets light through, and the ray does not end on its source, any hit will do.
    (scene_.has_glass || light.source != nullptr ? traced_ : probed_).add(ray, light);
    ++size_;
  }
  std::size_t size() const { return size_; }

  /// Adds what arrives to its samples, in an order that depends on the queue alone, and empties the queue.
  /// `places` are those of the rays.
  void answer(std::span<const Place> places, std::span<Sample> samples);

 private:
  struct Questions {
    std::vector<SceneRay> rays;
    std::vector<Light> lights;
    void add(const SceneRay& ray, const Light& light) {
      rays.push_back(ray);
      lights.push_back(light);
    }
    void clear() {
      rays.clear();
      lights.clear();
    }
  };
  void answer_point_light(std::size_t number, std::span<const Place> places, std::span<Sample> samples);
  void answer_probed(std::span<const Place> places, std::span<Sample> samples);
  void answer_traced(std::span<const Place> places, std::span<Sample> samples);
  /// The share of light that a surface in its way lets through.
  Rgb let_through(const SceneHit& hit, tetfmt::Vec3f direction) const;

  const Scene& scene_;
  Rays& rays_;
  std::vector<Questions> to_point_lights_;
  Questions probed_;  ///< is anything in the way?
  Questions traced_;  ///< what is in the way?
  std::size_t size_ = 0;
  std::vector<tetfmt::Outcome> outcomes_;
  std::vector<SceneHit> hits_;
};

}  // namespace tetprep
