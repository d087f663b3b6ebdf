// SPDX-License-Identifier: AGPL-3.0-or-later
#include "intersect.hpp"

#include <gtest/gtest.h>

#include <boost/multiprecision/cpp_int.hpp>
#include <cmath>
#include <numbers>
#include <random>

namespace {

using tetfmt::Vec3f;
using tetfmt::detail::intersect;
using tetfmt::detail::intersect_split;
using tetfmt::detail::TrianglePoint;

const Vec3f kA = {0, 0, 0}, kB = {4, 0, 0}, kC = {0, 4, 0};

TEST(Intersect, CrossesAtAnyAngle) {
  // From height h at x = -1 down to the triangle's plane at x = 1, y = 1: t = 2, u = v = 1/4, at an angle of
  // h / 2.
  for (int exponent = 0; exponent <= 60; ++exponent) {
    const float h = std::ldexp(1.0f, -exponent);
    const TrianglePoint point = intersect({-1, 1, double{h}}, {1, 0, -double{h} / 2}, kA, kB, kC);
    EXPECT_NEAR(point.t, 2, 1e-12) << exponent;
    EXPECT_NEAR(point.u, 0.25, 1e-12) << exponent;
    EXPECT_NEAR(point.v, 0.25, 1e-12) << exponent;
  }
}

TEST(Intersect, InThePlaneIsWhereTheRayEnters) {
  for (const bool turned : {false, true}) {
    const TrianglePoint point = intersect({-1, 1, 0}, {0.5, 0, 0}, kA, turned ? kC : kB, turned ? kB : kC);
    EXPECT_DOUBLE_EQ(point.t, 2);
    EXPECT_DOUBLE_EQ(point.u, turned ? 0.25 : 0);
    EXPECT_DOUBLE_EQ(point.v, turned ? 0 : 0.25);
  }
  EXPECT_EQ(intersect({1, 1, 0}, {0.5, 0, 0}, kA, kB, kC).t, 0);  // starts inside
}

TEST(Intersect, AHairOutsideThePlaneStaysWithinTheOutline) {
  // The exact quotient lies far beyond the triangle: the rays were found to touch it, so they do at its edge.
  const TrianglePoint point = intersect({-1, 1, 0x1p-100}, {1, 0, -0x1p-149}, kA, kB, kC);
  EXPECT_GE(point.t, 1);
  EXPECT_LE(point.t, 4);
  EXPECT_LE(point.u + point.v, 1);
}

TEST(Intersect, WeightsAreOfTheSecondAndThirdCorner) {
  const TrianglePoint point = intersect({1, 2, 5}, {0, 0, -2}, kA, kB, kC);
  EXPECT_DOUBLE_EQ(point.t, 2.5);
  EXPECT_DOUBLE_EQ(point.u, 0.25);
  EXPECT_DOUBLE_EQ(point.v, 0.5);
}

/// At 1 degree and more, t is within 4 units in the last place, whatever cancels: near the plane and far from
/// it, with the corner that t is computed from near and far.
TEST(Intersect, TIsAccurateToTheLastBits) {
  using Rational = boost::multiprecision::cpp_rational;
  std::mt19937_64 random(5);
  const auto below = [&](std::int64_t n) {
    return static_cast<std::int64_t>(random() % static_cast<std::uint64_t>(n));
  };
  double worst = 0;
  int steep = 0;
  for (int i = 0; i < 60000; ++i) {
    const std::int64_t extent = std::int64_t{1} << (2 + i % 21);
    const auto grid = [&] {
      const auto one = [&] { return static_cast<float>(below(2 * extent) - extent); };
      return Vec3f{one(), one(), one()};
    };
    // Every other plane passes through zero, where float32 origins can be closer to it than to anything else.
    const bool through_zero = i % 2 == 1;
    const Vec3f a = grid(), b = through_zero ? Vec3f{-a.x, -a.y, -a.z} : grid(), c = grid();
    // A point of the triangle, a direction, and an origin on the way: rounded, so the ray misses by a little.
    const auto unit = [&] { return static_cast<double>(below(1 << 24)) * 0x1p-24; };
    double u = unit(), v = unit();
    if (u + v > 1) {
      u = 1 - u;
      v = 1 - v;
    }
    if (through_zero) {
      u = 0.5;
      v = 0;
    }
    const double distance = std::ldexp(
        unit() + 0.5, static_cast<int>(below(through_zero ? 140 : 60)) - (through_zero ? 120 : 40));
    std::array<double, 3> o, d;
    for (std::size_t k = 0; k < 3; ++k) {
      const double p = double{(&a.x)[k]} * (1 - u - v) + double{(&b.x)[k]} * u + double{(&c.x)[k]} * v;
      d[k] = static_cast<double>(static_cast<float>(2 * unit() - 1));
      o[k] = static_cast<double>(static_cast<float>(p - distance * d[k]));
    }
    std::array<Rational, 3> ab, ac, ao, n;
    Rational height = 0, along = 0, nn = 0, dd = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      ab[k] = Rational((&b.x)[k]) - Rational((&a.x)[k]);
      ac[k] = Rational((&c.x)[k]) - Rational((&a.x)[k]);
      ao[k] = Rational((&a.x)[k]) - Rational(o[k]);
    }
    for (std::size_t k = 0; k < 3; ++k) {
      n[k] = ab[(k + 1) % 3] * ac[(k + 2) % 3] - ab[(k + 2) % 3] * ac[(k + 1) % 3];
      height += n[k] * ao[k];
      along += n[k] * Rational(d[k]);
      nn += n[k] * n[k];
      dd += Rational(d[k]) * Rational(d[k]);
    }
    const double sine =
        static_cast<double>(along) / std::sqrt(static_cast<double>(nn) * static_cast<double>(dd));
    if (!(std::abs(sine) > std::sin(std::numbers::pi / 180))) continue;
    const Rational exact = height / along;
    if (exact <= 0) continue;
    ++steep;
    const double nearest = static_cast<double>(exact);
    const double ulp = std::nextafter(nearest, 1e300) - nearest;
    const TrianglePoint point = intersect(o, d, a, b, c), split = intersect_split(o, d, a, b, c);
    ASSERT_TRUE(point.t == split.t && point.u == split.u && point.v == split.v);
    const Rational error = Rational(point.t) - exact;
    worst = std::max(worst, std::abs(static_cast<double>(error)) / ulp);
  }
  EXPECT_GT(steep, 30000);
  EXPECT_LE(worst, 4);
}

}  // namespace
