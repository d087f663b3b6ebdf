// SPDX-License-Identifier: AGPL-3.0-or-later
#include "intersect.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace {

using tetfmt::Vec3f;
using tetfmt::detail::intersect;
using tetfmt::detail::TrianglePoint;

const Vec3f kA = {0, 0, 0}, kB = {4, 0, 0}, kC = {0, 4, 0};

TEST(Intersect, CrossesAtAnyAngle) {
  // From height h at x = -1 down to the triangle's plane at x = 1, y = 1: t = 2, u = v = 1/4, at an angle of
  // h / 2.
  for (int exponent = 0; exponent <= 60; ++exponent) {
    const float h = std::ldexp(1.0f, -exponent);
    const TrianglePoint point = intersect({-1, 1, h}, {1, 0, -h / 2}, kA, kB, kC);
    EXPECT_NEAR(point.t, 2, 1e-12) << exponent;
    EXPECT_NEAR(point.u, 0.25, 1e-12) << exponent;
    EXPECT_NEAR(point.v, 0.25, 1e-12) << exponent;
  }
}

TEST(Intersect, InThePlaneIsWhereTheRayEnters) {
  for (const bool turned : {false, true}) {
    const TrianglePoint point = intersect({-1, 1, 0}, {0.5f, 0, 0}, kA, turned ? kC : kB, turned ? kB : kC);
    EXPECT_DOUBLE_EQ(point.t, 2);
    EXPECT_DOUBLE_EQ(point.u, turned ? 0.25 : 0);
    EXPECT_DOUBLE_EQ(point.v, turned ? 0 : 0.25);
  }
  EXPECT_EQ(intersect({1, 1, 0}, {0.5f, 0, 0}, kA, kB, kC).t, 0);  // starts inside
}

TEST(Intersect, AHairOutsideThePlaneStaysWithinTheOutline) {
  // The exact quotient lies far beyond the triangle: the rays were found to touch it, so they do at its edge.
  const TrianglePoint point = intersect({-1, 1, 0x1p-100f}, {1, 0, -0x1p-149f}, kA, kB, kC);
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

}  // namespace
