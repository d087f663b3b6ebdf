// SPDX-License-Identifier: AGPL-3.0-or-later
// Reflection, refraction and draws, by their own laws.
#include "trace/optics.hpp"

#include <gtest/gtest.h>

#include "trace/sampling.hpp"

namespace tetfmt_test {
namespace {

using namespace tetprep;

constexpr double kPi = 3.141592653589793;
constexpr Vec3 kUp{0, 0, 1};

Vec3 coming_in(double degrees) {
  return {std::sin(degrees * kPi / 180), 0, -std::cos(degrees * kPi / 180)};
}

TEST(Optics, RefractionFollowsSnell) {
  for (const double ratio : {1 / 1.5, 1 / 2.4, 1.2}) {
    for (const double degrees : {0.0, 10.0, 40.0, 55.0}) {
      const auto out = refracted(coming_in(degrees), kUp, ratio);
      ASSERT_TRUE(out) << ratio << ' ' << degrees;
      EXPECT_NEAR(out->x, ratio * std::sin(degrees * kPi / 180), 1e-15);
      EXPECT_NEAR(length(*out), 1, 1e-15);
      EXPECT_LT(out->z, 0);
    }
  }
}

TEST(Optics, BeyondTheCriticalAngleAllIsReflected) {
  const double critical = std::asin(1 / 1.5) * 180 / kPi;
  EXPECT_TRUE(refracted(coming_in(critical - 0.001), kUp, 1.5));
  EXPECT_FALSE(refracted(coming_in(critical + 0.001), kUp, 1.5));
  EXPECT_LT(reflectance(std::cos((critical - 0.001) * kPi / 180), 1.5), 1);
  EXPECT_EQ(reflectance(std::cos((critical + 0.001) * kPi / 180), 1.5), 1);
}

TEST(Optics, FresnelAtAnglesThatAreKnown) {
  EXPECT_NEAR(reflectance(1, 1 / 1.5), 0.04, 1e-16);
  EXPECT_NEAR(reflectance(1, 1.5), 0.04, 1e-16);
  EXPECT_EQ(reflectance(0, 1 / 1.5), 1);
  // At Brewster's angle the part along the plane of incidence vanishes, and the rays are at right angles.
  const double brewster = std::atan(1.5), n = 1.5;
  const double across =
      (std::cos(brewster) - n * std::sin(brewster)) / (std::cos(brewster) + n * std::sin(brewster));
  EXPECT_NEAR(reflectance(std::cos(brewster), 1 / n), across * across / 2, 1e-15);
  // A ray and its way back lose the same.
  for (const double degrees : {5.0, 30.0, 70.0, 89.0}) {
    const auto out = refracted(coming_in(degrees), kUp, 1 / 1.5);
    EXPECT_NEAR(reflectance(std::cos(degrees * kPi / 180), 1 / 1.5), reflectance(-out->z, 1.5), 1e-12);
  }
}

TEST(Optics, AnIndexOfOneChangesNothing) {
  const Vec3 in = unit({0.3, -0.7, -0.1});
  const auto out = refracted(in, kUp, 1);
  EXPECT_TRUE(out->x == in.x && out->y == in.y && out->z == in.z);
  EXPECT_EQ(reflectance(0.3, 1), 0);
}

TEST(Optics, RaysStayAboveTheTrueSurface) {
  const Vec3 above = unit({1, 0, 0.2}), below = unit({1, 0, -0.2});
  EXPECT_EQ(kept_above(above, kUp).z, above.z);
  EXPECT_NEAR(kept_above(below, kUp).z, above.z, 1e-15);
  EXPECT_NEAR(kept_above(below, kUp).x, above.x, 1e-15);
}

TEST(Sampling, CosineDirectionsFollowTheCosine) {
  const Dice dice(3, 0);
  for (const Vec3 normal : {kUp, -kUp, unit({1, 2, 3}), unit({-1, 1e-9, -1e-3})}) {
    Vec3 sum;
    const int count = 20000;
    for (int i = 0; i < count; ++i) {
      const Vec3 d = cosine_direction(normal, dice.point(1, static_cast<std::uint64_t>(i), count));
      EXPECT_NEAR(length(d), 1, 1e-12);
      EXPECT_GE(dot(d, normal), 0);
      sum = sum + (1.0 / count) * d;
    }
    // The mean of cos^2 / pi over the hemisphere is 2 / 3, along the normal.
    EXPECT_NEAR(length(sum - (2.0 / 3) * normal), 0, 2e-3);
  }
}

TEST(Sampling, PointsFillTheSquareAndTrianglesEvenly) {
  const int count = 4096;
  std::array<int, 16> cells{};
  double u = 0, v = 0;
  for (int i = 0; i < count; ++i) {
    const auto p = Dice(5, static_cast<std::uint64_t>(i)).point(2, 0, 1);
    ASSERT_TRUE(p[0] >= 0 && p[0] < 1 && p[1] >= 0 && p[1] < 1);
    ++cells[static_cast<std::size_t>(4 * p[0]) * 4 + static_cast<std::size_t>(4 * p[1])];
    const auto w = triangle_weights(p);
    ASSERT_TRUE(w[0] >= 0 && w[1] >= 0 && w[0] + w[1] <= 1);
    u += w[0] / count;
    v += w[1] / count;
  }
  for (const int cell : cells) EXPECT_NEAR(cell, count / 16, 8);
  EXPECT_NEAR(u, 1.0 / 3, 1e-3);
  EXPECT_NEAR(v, 1.0 / 3, 1e-3);
}

TEST(Sampling, NumbersDependOnPixelSampleAndPurpose) {
  const double base = Dice(1, 2).number(3);
  EXPECT_EQ(Dice(1, 2).number(3), base);
  EXPECT_NE(Dice(2, 2).number(3), base);
  EXPECT_NE(Dice(1, 3).number(3), base);
  EXPECT_NE(Dice(1, 2).number(4), base);
  double sum = 0;
  for (std::uint64_t i = 0; i < 10000; ++i) sum += Dice(9, i).number(1);
  EXPECT_NEAR(sum / 10000, 0.5, 0.01);
}

}  // namespace
}  // namespace tetfmt_test
