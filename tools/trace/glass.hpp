// SPDX-License-Identifier: AGPL-3.0-or-later
// What glass does to light that meets it, or has passed it.
#pragma once

#include <algorithm>
#include <cmath>

#include "trace/optics.hpp"
#include "trace/surface.hpp"

namespace tetprep {

/// What glass leaves of light that has passed `length` of it (Beer and Lambert).
inline Rgb unabsorbed(const Material& glass, double length) {
  return {std::exp(-glass.absorption.r * length), std::exp(-glass.absorption.g * length),
          std::exp(-glass.absorption.b * length)};
}

/// Glass at a hit: index of refraction on the ray's side over that beyond, and the share that is reflected.
struct Interface {
  double ratio, reflected;
  Interface(const SceneHit& hit, const SurfacePoint& surface, Vec3 along)
      : ratio(hit.hit.back ? surface.material.ior : 1 / surface.material.ior),
        reflected(reflectance(std::clamp(-dot(along, surface.normal), 0.0, 1.0), ratio)) {}
};

}  // namespace tetprep
