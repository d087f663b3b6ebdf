// SPDX-License-Identifier: MIT
// Points and vectors in double, and the little algebra that they need here.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <cstring>

#include "tetfmt/types.hpp"

namespace tetfmt::detail {

using Vec3d = std::array<double, 3>;

inline Vec3d to_vec3d(const Vec3f& p) {
  return {p.x, p.y, p.z};
}
inline Vec3d minus(const Vec3d& a, const Vec3d& b) {
  return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
}
inline double dot(const Vec3d& a, const Vec3d& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}
inline Vec3d cross(const Vec3d& a, const Vec3d& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
inline bool is_finite(const Vec3d& v) {
  return std::isfinite(v[0]) && std::isfinite(v[1]) && std::isfinite(v[2]);
}

/// A coordinate by its axis, from the object's bytes: a branch on the axis would cost more than all the rest
/// of a step, and members are no array.
inline float coordinate(const Vec3f& point, std::size_t axis) {
  static_assert(sizeof(Vec3f) == 3 * sizeof(float));
  float value;
  std::memcpy(&value, reinterpret_cast<const unsigned char*>(&point) + axis * sizeof(float), sizeof value);
  return value;
}

/// Axes by the size of a vector's components; the first of equal ones is the largest.
struct Axes {
  std::size_t smallest, middle, largest;
  explicit Axes(const Vec3d& d) : smallest(0), middle(0), largest(0) {
    for (std::size_t axis = 1; axis < 3; ++axis)
      if (std::abs(d[axis]) > std::abs(d[largest])) largest = axis;
    smallest = (largest + 1) % 3;
    middle = (largest + 2) % 3;
    if (std::abs(d[middle]) < std::abs(d[smallest])) std::swap(smallest, middle);
  }
};

}  // namespace tetfmt::detail
