// SPDX-License-Identifier: AGPL-3.0-or-later
// Rays and triangles in float32, as the two trees test them: the watertight test of Woop, Benthin and Wald
// (2013), as Pharr, Jakob and Humphreys (2016) have it in section 3.6.2. The ray's part is computed once a
// ray, and where an edge function is zero in float32 it is computed again in double precision.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>

#include "bench/ray_list.hpp"
#include "tetfmt/types.hpp"

namespace tetbench {

using Corners = std::array<tetfmt::Vec3f, 3>;

inline float component(const tetfmt::Vec3f& v, std::size_t axis) {
  return axis == 0 ? v.x : axis == 1 ? v.y : v.z;
}

/// What is the same for all triangles and boxes that a ray is tested with. t_max shrinks to the nearest hit.
struct TreeRay {
  std::array<float, 3> origin, inverse, direction;
  std::array<bool, 3> negative;
  float t_min, t_max;
  std::size_t kx, ky, kz;  ///< the permutation that makes z the direction's largest component
  float shear_x, shear_y, shear_z;

  explicit TreeRay(const PeerRay& ray)
      : origin{ray.origin.x, ray.origin.y, ray.origin.z},
        direction{ray.direction.x, ray.direction.y, ray.direction.z},
        t_min(ray.t_min),
        t_max(ray.t_max) {
    for (std::size_t k = 0; k < 3; ++k) {
      inverse[k] = 1 / direction[k];
      negative[k] = inverse[k] < 0;
    }
    kz = 0;
    for (std::size_t k = 1; k < 3; ++k)
      if (std::abs(direction[k]) > std::abs(direction[kz])) kz = k;
    kx = (kz + 1) % 3, ky = (kz + 2) % 3;
    shear_x = -direction[kx] * inverse[kz];
    shear_y = -direction[ky] * inverse[kz];
    shear_z = inverse[kz];
  }

  /// Whether the triangle is met at t_min <= t < t_max; if so, t_max becomes that t.
  bool meets(const Corners& triangle) {
    std::array<std::array<float, 3>, 3> p;
    for (std::size_t i = 0; i < 3; ++i) {
      const std::array<float, 3> from = {triangle[i].x - origin[0], triangle[i].y - origin[1],
                                         triangle[i].z - origin[2]};
      p[i] = {from[kx] + shear_x * from[kz], from[ky] + shear_y * from[kz], from[kz]};
    }
    float e0 = p[1][0] * p[2][1] - p[1][1] * p[2][0];
    float e1 = p[2][0] * p[0][1] - p[2][1] * p[0][0];
    float e2 = p[0][0] * p[1][1] - p[0][1] * p[1][0];
    if (e0 == 0 || e1 == 0 || e2 == 0) {
      const auto edge = [&](std::size_t a, std::size_t b) {
        return static_cast<float>(double{p[a][0]} * double{p[b][1]} - double{p[a][1]} * double{p[b][0]});
      };
      e0 = edge(1, 2), e1 = edge(2, 0), e2 = edge(0, 1);
    }
    if ((e0 < 0 || e1 < 0 || e2 < 0) && (e0 > 0 || e1 > 0 || e2 > 0)) return false;
    const float determinant = e0 + e1 + e2;
    if (determinant == 0) return false;
    const float scaled = shear_z * (e0 * p[0][2] + e1 * p[1][2] + e2 * p[2][2]);
    const float t = scaled / determinant;
    if (!(t >= t_min && t < t_max)) return false;
    t_max = t;
    return true;
  }

  /// Widens the far end of a slab by the roundings in it: 1 + 2 gamma(3), section 3.9.2.
  static constexpr float kWider = 1 + 2 * (3 * 0x1p-24F / (1 - 3 * 0x1p-24F));

  /// The stretch of t in the box, at most [t_min, t_max]; false if there is none.
  bool clip(const std::array<tetfmt::Vec3f, 2>& box, float& enter, float& leave) const {
    enter = t_min, leave = t_max;
    for (std::size_t k = 0; k < 3; ++k) {
      const float near = (component(box[negative[k] ? 1 : 0], k) - origin[k]) * inverse[k];
      const float far = (component(box[negative[k] ? 0 : 1], k) - origin[k]) * inverse[k] * kWider;
      // Written so that a NaN (0 * infinity: in the plane of a slab) leaves the stretch as it is.
      if (near > enter) enter = near;
      if (far < leave) leave = far;
    }
    return enter <= leave;
  }
};

struct TreeHit {
  tetfmt::Index triangle = tetfmt::kNone;  ///< its number in the file; kNone: nothing is met
  float t = std::numeric_limits<float>::infinity();
};

/// How a traversal counts: the same code with either.
struct NotCounted {
  void node() {}
};
struct NodeCount {
  std::uint64_t nodes = 0;
  void node() { ++nodes; }
};

}  // namespace tetbench
