// SPDX-License-Identifier: MIT
#include "intersect.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace tetfmt::detail {
namespace {

using Vec = Vec3d;

/// A sum and what rounding it left over, exactly (Knuth).
struct Sum {
  double value, rest;
  static Sum of(double a, double b) {
    const double value = a + b, from_b = value - a;
    return {value, (a - (value - from_b)) + (b - from_b)};
  }
};

/// A product and its rest, exactly, in two ways that give the same: by the instruction for it, and by halves
/// (Veltkamp and Dekker; factors below 2^996) for processors without.
struct FusedProduct {
  [[gnu::always_inline]] static Sum of(double a, double b) {
    const double value = a * b;
    return {value, __builtin_fma(a, b, -value)};
  }
};
struct SplitProduct {
  [[gnu::always_inline]] static Sum of(double a, double b) {
    constexpr double kSplit = 0x1p27 + 1;
    const double a_shifted = kSplit * a, b_shifted = kSplit * b;
    const double a_high = a_shifted - (a_shifted - a), b_high = b_shifted - (b_shifted - b);
    const double a_low = a - a_high, b_low = b - b_high;
    const double value = a * b;
    return {value, a_low * b_low - (((value - a_high * b_high) - a_low * b_high) - a_high * b_low)};
  }
};

/// a . b + rest as if in twice the precision, rounded once (Ogita, Rump and Oishi 2005, Dot2): the error is
/// one rounding of the result, and less than 2^-100 of `size`, the sum of the products' sizes.
struct AccurateDot {
  double value, size;
};
template <class Product>
[[gnu::always_inline]] inline AccurateDot accurate_dot(const Vec& a, const Vec& b, double rest) {
  const Sum x = Product::of(a[0], b[0]), y = Product::of(a[1], b[1]), z = Product::of(a[2], b[2]);
  const Sum xy = Sum::of(x.value, y.value), xyz = Sum::of(xy.value, z.value);
  return {xyz.value + ((x.rest + y.rest + z.rest) + (xy.rest + xyz.rest) + rest),
          std::abs(x.value) + std::abs(y.value) + std::abs(z.value)};
}

/// The part of the ray that projects into the triangle along `axis` (edge functions are linear in t).
std::array<double, 2> clip(const std::array<Vec, 3>& to_corner, const Vec& d, std::size_t axis,
                           double orientation) {
  const std::size_t i = (axis + 1) % 3, j = (axis + 2) % 3;
  double first = 0, last = std::numeric_limits<double>::infinity();
  for (std::size_t k = 0; k < 3; ++k) {
    const Vec& a = to_corner[k];
    const Vec edge = minus(to_corner[(k + 1) % 3], a);
    const double inside = orientation * (edge[j] * a[i] - edge[i] * a[j]);  // at t = 0
    const double growth = orientation * (edge[i] * d[j] - edge[j] * d[i]);  // per t
    if (growth > 0) first = std::max(first, -inside / growth);
    if (growth < 0) last = std::min(last, -inside / growth);
  }
  return {first, std::max(first, last)};
}

/// For rays (nearly) in the triangle's plane: the quotient for t has lost its digits, the outline has not.
[[gnu::noinline, gnu::cold]] TrianglePoint graze(const std::array<Vec, 3>& to_corner, const Vec& d,
                                                 const Vec& n) {
  const std::size_t axis = Axes(n).largest;
  const auto [first, last] = clip(to_corner, d, axis, n[axis] > 0 ? 1 : -1);
  TrianglePoint point;
  const double quotient = dot(n, to_corner[0]) / dot(n, d);
  point.t = quotient >= first ? std::min(quotient, last) : first;  // NaN and too small alike: the entry

  const Vec ab = minus(to_corner[1], to_corner[0]), ac = minus(to_corner[2], to_corner[0]);
  const std::size_t i = (axis + 1) % 3, j = (axis + 2) % 3;
  const double x = point.t * d[i] - to_corner[0][i], y = point.t * d[j] - to_corner[0][j];
  point.u = (x * ac[j] - y * ac[i]) / n[axis];
  point.v = (ab[i] * y - ab[j] * x) / n[axis];
  return point;
}

}  // namespace

TrianglePoint from_piece(const TrianglePoint& at, const std::array<Vec3f, 3>& piece,
                         const std::array<Vec3f, 3>& whole) {
  const Vec a = to_vec3d(whole[0]), ab = minus(to_vec3d(whole[1]), a), ac = minus(to_vec3d(whole[2]), a);
  const Vec p = minus(to_vec3d(piece[0]), a), q = minus(to_vec3d(piece[1]), a),
            r = minus(to_vec3d(piece[2]), a);
  const Vec n = cross(ab, ac);
  const std::size_t axis = Axes(n).largest, i = (axis + 1) % 3, j = (axis + 2) % 3;
  const auto blend = [&](std::size_t k) { return (1 - at.u - at.v) * p[k] + at.u * q[k] + at.v * r[k]; };
  const double x = blend(i), y = blend(j);
  TrianglePoint point;
  point.t = at.t;
  if (n[axis] == 0) return point;
  point.u = std::clamp((x * ac[j] - y * ac[i]) / n[axis], 0.0, 1.0);
  point.v = std::clamp((ab[i] * y - ab[j] * x) / n[axis], 0.0, 1.0 - point.u);
  return point;
}

namespace {

template <class Product>
[[gnu::always_inline]] inline TriangleFrom triangle_by(const Vec3d& o, const Vec3f& a, const Vec3f& b,
                                                       const Vec3f& c) {
  Vec to_a, rest;
  for (std::size_t k = 0; k < 3; ++k) {
    const Sum difference = Sum::of(to_vec3d(a)[k], -o[k]);
    to_a[k] = difference.value;
    rest[k] = difference.rest;
  }
  const Vec ab = minus(to_vec3d(b), to_vec3d(a)), ac = minus(to_vec3d(c), to_vec3d(a));
  const Vec n = cross(ab, ac);
  auto [height, size] = accurate_dot<Product>(n, to_a, dot(n, rest));
  // An origin that is close to the plane, measured by its distance to a: what cancels is more than Dot2 can
  // spare.
  if (std::abs(height) <= 0x1p-40 * size) height = plane_height(o, a, b, c);
  return {n, cross(ac, to_a), cross(to_a, ab), height, dot(n, n)};
}

template <class Product>
[[gnu::always_inline]] inline TrianglePoint intersect_by(const Vec3d& o, const Vec3d& d, const Vec3f& a,
                                                         const Vec3f& b, const Vec3f& c) {
  const TriangleFrom triangle = triangle_by<Product>(o, a, b, c);
  const double along = accurate_dot<Product>(triangle.normal, d, 0).value;
  TrianglePoint point;
  // (Squares of products of float32 values neither overflow nor underflow in double precision.)
  if (along * along <= kGrazing2 * (triangle.normal2 * dot(d, d))) {
    point = graze({minus(to_vec3d(a), o), minus(to_vec3d(b), o), minus(to_vec3d(c), o)}, d, triangle.normal);
  } else {
    // Moeller and Trumbore (1997), arranged so that t comes from the normal, which is exact.
    point.t = triangle.height / along;
    point.u = dot(triangle.for_u, d) / along;
    point.v = dot(triangle.for_v, d) / along;
  }
  point.t = std::max(point.t, 0.0) + 0.0;  // a sum that turns -0 into 0
  point.u = std::clamp(point.u, 0.0, 1.0) + 0.0;
  point.v = std::clamp(point.v, 0.0, 1.0 - point.u) + 0.0;
  return point;
}

}  // namespace

TrianglePoint intersect_split(const Vec3d& origin, const Vec3d& direction, const Vec3f& a, const Vec3f& b,
                              const Vec3f& c) {
  return intersect_by<SplitProduct>(origin, direction, a, b, c);
}

#if defined(__x86_64__)
namespace {
[[gnu::target("fma")]] TrianglePoint intersect_fused(const Vec3d& origin, const Vec3d& direction,
                                                     const Vec3f& a, const Vec3f& b, const Vec3f& c) {
  return intersect_by<FusedProduct>(origin, direction, a, b, c);
}
[[gnu::target("fma")]] TriangleFrom triangle_fused(const Vec3d& origin, const Vec3f& a, const Vec3f& b,
                                                   const Vec3f& c) {
  return triangle_by<FusedProduct>(origin, a, b, c);
}
const bool kFused = __builtin_cpu_supports("fma");
}  // namespace

TriangleFrom triangle_from(const Vec3d& origin, const Vec3f& a, const Vec3f& b, const Vec3f& c) {
  return kFused ? triangle_fused(origin, a, b, c) : triangle_by<SplitProduct>(origin, a, b, c);
}
TrianglePoint intersect(const Vec3d& origin, const Vec3d& direction, const Vec3f& a, const Vec3f& b,
                        const Vec3f& c) {
  return kFused ? intersect_fused(origin, direction, a, b, c) : intersect_split(origin, direction, a, b, c);
}
#elif defined(__FP_FAST_FMA)
TriangleFrom triangle_from(const Vec3d& origin, const Vec3f& a, const Vec3f& b, const Vec3f& c) {
  return triangle_by<FusedProduct>(origin, a, b, c);
}
TrianglePoint intersect(const Vec3d& origin, const Vec3d& direction, const Vec3f& a, const Vec3f& b,
                        const Vec3f& c) {
  return intersect_by<FusedProduct>(origin, direction, a, b, c);
}
#else
TriangleFrom triangle_from(const Vec3d& origin, const Vec3f& a, const Vec3f& b, const Vec3f& c) {
  return triangle_by<SplitProduct>(origin, a, b, c);
}
TrianglePoint intersect(const Vec3d& origin, const Vec3d& direction, const Vec3f& a, const Vec3f& b,
                        const Vec3f& c) {
  return intersect_split(origin, direction, a, b, c);
}
#endif

}  // namespace tetfmt::detail
