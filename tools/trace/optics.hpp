// SPDX-License-Identifier: AGPL-3.0-or-later
// What a smooth surface does to a ray: reflection, refraction, and how much light takes which way.
// Directions are of unit length; `normal` is on the side that the ray comes from: dot(in, normal) <= 0.
#pragma once

#include <algorithm>
#include <optional>

#include "trace/vector.hpp"

namespace tetprep {

constexpr Vec3 reflected(Vec3 in, Vec3 normal) {
  return in - (2 * dot(in, normal)) * normal;
}

/// By Snell's law; `ratio` is the index of refraction on this side over that beyond. None if all light is
/// reflected. A ratio of 1 changes no bit of the direction.
inline std::optional<Vec3> refracted(Vec3 in, Vec3 normal, double ratio) {
  if (ratio == 1) return in;
  const double cosine = -dot(in, normal);
  const double sine2_beyond = ratio * ratio * (1 - cosine * cosine);
  if (sine2_beyond >= 1) return std::nullopt;
  return ratio * in + (ratio * cosine - std::sqrt(1 - sine2_beyond)) * normal;
}

/// The share of unpolarised light that is reflected (Fresnel's equations): 0 to 1. `cosine` is that between
/// the ray, reversed, and the normal.
inline double reflectance(double cosine, double ratio) {
  if (ratio == 1) return 0;
  const double sine2_beyond = ratio * ratio * (1 - cosine * cosine);
  if (sine2_beyond >= 1) return 1;
  const double beyond = std::sqrt(1 - sine2_beyond);
  const double across = (ratio * cosine - beyond) / (ratio * cosine + beyond);
  const double along = (cosine - ratio * beyond) / (cosine + ratio * beyond);
  return (across * across + along * along) / 2;
}

/// An interpolated normal can send a ray to the wrong side of the true surface. Such a ray meets that surface
/// at once, and goes on as its mirror image: so does this one. Continuous where the ray grazes the surface,
/// which cutting it off or falling back to the true normal would not be.
constexpr Vec3 kept_above(Vec3 direction, Vec3 true_normal) {
  return dot(direction, true_normal) < 0 ? reflected(direction, true_normal) : direction;
}

}  // namespace tetprep
