// SPDX-License-Identifier: AGPL-3.0-or-later
// Points and directions in double, for everything around the traversal (which is float32, as the file).
#pragma once

#include <array>
#include <cmath>

#include "tetfmt/types.hpp"

namespace tetprep {

struct Vec3 {
  double x = 0, y = 0, z = 0;
};

constexpr Vec3 operator+(Vec3 a, Vec3 b) {
  return {a.x + b.x, a.y + b.y, a.z + b.z};
}
constexpr Vec3 operator-(Vec3 a, Vec3 b) {
  return {a.x - b.x, a.y - b.y, a.z - b.z};
}
constexpr Vec3 operator-(Vec3 a) {
  return {-a.x, -a.y, -a.z};
}
constexpr Vec3 operator*(double s, Vec3 a) {
  return {s * a.x, s * a.y, s * a.z};
}
constexpr double dot(Vec3 a, Vec3 b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}
constexpr Vec3 cross(Vec3 a, Vec3 b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
inline double length(Vec3 a) {
  return std::sqrt(dot(a, a));
}
/// `a` must not be zero.
inline Vec3 unit(Vec3 a) {
  return (1 / length(a)) * a;
}

constexpr Vec3 vec3(const std::array<double, 3>& a) {
  return {a[0], a[1], a[2]};
}
constexpr Vec3 vec3(tetfmt::Vec3f a) {
  return {a.x, a.y, a.z};
}
inline tetfmt::Vec3f rounded(Vec3 a) {
  return {static_cast<float>(a.x), static_cast<float>(a.y), static_cast<float>(a.z)};
}

}  // namespace tetprep
