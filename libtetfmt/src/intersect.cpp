// SPDX-License-Identifier: MIT
#include "intersect.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace tetfmt::detail {
namespace {

using Vec = std::array<double, 3>;

Vec vec(const Vec3f& p) {
  return {p.x, p.y, p.z};
}
Vec operator-(const Vec& a, const Vec& b) {
  return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
}
double dot(const Vec& a, const Vec& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}
Vec cross(const Vec& a, const Vec& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

/// The part of the ray that projects into the triangle along `axis` (edge functions are linear in t).
std::array<double, 2> clip(const std::array<Vec, 3>& to_corner, const Vec& d, std::size_t axis,
                           double orientation) {
  const std::size_t i = (axis + 1) % 3, j = (axis + 2) % 3;
  double first = 0, last = std::numeric_limits<double>::infinity();
  for (std::size_t k = 0; k < 3; ++k) {
    const Vec& a = to_corner[k];
    const Vec edge = to_corner[(k + 1) % 3] - a;
    const double inside = orientation * (edge[j] * a[i] - edge[i] * a[j]);  // at t = 0
    const double growth = orientation * (edge[i] * d[j] - edge[j] * d[i]);  // per t
    if (growth > 0) first = std::max(first, -inside / growth);
    if (growth < 0) last = std::min(last, -inside / growth);
  }
  return {first, std::max(first, last)};
}

}  // namespace

TrianglePoint intersect(const Vec3f& origin, const Vec3f& direction, const Vec3f& a, const Vec3f& b,
                        const Vec3f& c) {
  const Vec o = vec(origin), d = vec(direction);
  const std::array<Vec, 3> to_corner = {vec(a) - o, vec(b) - o, vec(c) - o};
  const Vec ab = vec(b) - vec(a), ac = vec(c) - vec(a);
  const Vec n = cross(ab, ac);
  std::size_t axis = 0;
  for (std::size_t k = 1; k < 3; ++k)
    if (std::abs(n[k]) > std::abs(n[axis])) axis = k;

  TrianglePoint point;
  const double along = dot(n, d);
  point.t = dot(n, to_corner[0]) / along;
  // Below a few thousandths of a second of arc the quotient loses its digits; the triangle's outline does
  // not.
  // (Squares of float32 products neither overflow nor underflow in double precision.)
  if (along * along <= 1e-16 * (dot(n, n) * dot(d, d))) {
    const auto [first, last] = clip(to_corner, d, axis, n[axis] > 0 ? 1 : -1);
    point.t = point.t >= first ? std::min(point.t, last) : first;  // NaN and too small alike: the entry
  }
  point.t = std::max(point.t, 0.0);

  const std::size_t i = (axis + 1) % 3, j = (axis + 2) % 3;
  const double x = point.t * d[i] - to_corner[0][i], y = point.t * d[j] - to_corner[0][j];
  point.u = std::clamp((x * ac[j] - y * ac[i]) / n[axis], 0.0, 1.0);
  point.v = std::clamp((ab[i] * y - ab[j] * x) / n[axis], 0.0, 1.0 - point.u);
  return point;
}

}  // namespace tetfmt::detail
