// SPDX-License-Identifier: AGPL-3.0-or-later
// Random numbers by counter: each is a function of pixel, sample and purpose, so that no picture depends on
// who computes what when.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>

#include "trace/vector.hpp"

namespace tetprep {

/// SplitMix64's finaliser (Steele, Lea and Flood 2014).
constexpr std::uint64_t hashed(std::uint64_t x) {
  x += 0x9E3779B97F4A7C15u;
  x = (x ^ x >> 30) * 0xBF58476D1CE4E5B9u;
  x = (x ^ x >> 27) * 0x94D049BB133111EBu;
  return x ^ x >> 31;
}
/// The upper 53 bits as a number from 0 to 1, exclusive.
constexpr double unit_interval(std::uint64_t x) {
  return static_cast<double>(x >> 11) * 0x1p-53;
}

/// The numbers of one sample of one pixel. `purpose` tells apart what is drawn independently; the same
/// purpose gives the same numbers.
class Dice {
 public:
  Dice(std::uint64_t pixel, std::uint64_t sample) : pixel_(hashed(pixel)), sample_(sample) {}

  /// Independent of everything else.
  double number(std::uint64_t purpose) const {
    return unit_interval(hashed(hashed(pixel_ ^ hashed(purpose)) + sample_));
  }

  /// The `index`-th of `count` points of the unit square. Those of all samples of a pixel are one stretch of
  /// the R2 sequence (Roberts 2018), which fills the square evenly, moved by a random amount. So draws that
  /// depend on each other must not both come from here: use number() for one.
  std::array<double, 2> point(std::uint64_t purpose, std::uint64_t index, std::uint64_t count) const {
    const std::uint64_t shift = hashed(pixel_ ^ hashed(~purpose)), i = sample_ * count + index;
    // 1 / p and 1 / p^2 in 64 bits after the point, p^3 = p + 1; the product wraps as the sequence does.
    return {unit_interval(shift + i * 0xC13FA9A902A6328Fu),
            unit_interval(hashed(shift) + i * 0x91E10DA5C79E7B1Du)};
  }

 private:
  std::uint64_t pixel_, sample_;
};

/// A direction about `normal` (of unit length), by the cosine between them.
inline Vec3 cosine_direction(Vec3 normal, std::array<double, 2> point) {
  // An orthonormal basis without a case that cancels (Duff et al. 2017).
  const double sign = std::copysign(1.0, normal.z), a = -1 / (sign + normal.z), b = normal.x * normal.y * a;
  const Vec3 u{1 + sign * normal.x * normal.x * a, sign * b, -sign * normal.x};
  const Vec3 v{b, sign + normal.y * normal.y * a, -normal.y};
  const double angle = 2 * 3.141592653589793 * point[0], radius = std::sqrt(point[1]);
  return (radius * std::cos(angle)) * u + (radius * std::sin(angle)) * v + std::sqrt(1 - point[1]) * normal;
}

/// Barycentric weights of the second and third corner, evenly over the triangle (Osada et al. 2002).
inline std::array<double, 2> triangle_weights(std::array<double, 2> point) {
  const double root = std::sqrt(point[0]);
  return {root * (1 - point[1]), root * point[1]};
}

}  // namespace tetprep
