// SPDX-License-Identifier: AGPL-3.0-or-later
#include "tetfmt/orientation.hpp"

#include <gtest/gtest.h>

#include <boost/multiprecision/cpp_int.hpp>
#include <random>

namespace {

using tetfmt::GridPoint;
using tetfmt::orientation;
using Integer = boost::multiprecision::cpp_int;

int exact_orientation(const GridPoint& a, const GridPoint& b, const GridPoint& c, const GridPoint& d) {
  Integer m[3][3];  // the differences fit 64 bits, their products do not
  for (std::size_t i = 0; i < 3; ++i) {
    m[0][i] = std::int64_t{b[i]} - a[i];
    m[1][i] = std::int64_t{c[i]} - a[i];
    m[2][i] = std::int64_t{d[i]} - a[i];
  }
  const Integer value = m[0][0] * (m[1][1] * m[2][2] - m[1][2] * m[2][1]) -
                        m[0][1] * (m[1][0] * m[2][2] - m[1][2] * m[2][0]) +
                        m[0][2] * (m[1][0] * m[2][1] - m[1][1] * m[2][0]);
  return value.sign();
}

TEST(Orientation, IsPositiveWhereTheNormalPoints) {
  EXPECT_EQ(orientation({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}), 1);
  EXPECT_EQ(orientation({0, 0, 0}, {0, 1, 0}, {1, 0, 0}, {0, 0, 1}), -1);
  EXPECT_EQ(orientation({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {7, 9, 0}), 0);
}

/// Points of a plane, moved off it by at most one step: the determinant is zero or nearly, and 64 bits do not
/// hold it.
TEST(Orientation, IsExactNextToZero) {
  std::mt19937 random(1);
  for (const std::int32_t size : {1 << 5, 1 << 20, 1 << 24, (1 << 28) - 2}) {
    std::uniform_int_distribution<std::int32_t> coordinate(-size, size), nudge(-1, 1);
    int zeros = 0;
    for (int i = 0; i < 20000; ++i) {
      GridPoint p[4];
      for (GridPoint& point : p) {
        point = {coordinate(random) / 2, coordinate(random) / 2, 0};
        point[2] = (point[0] + point[1]) / 2 + nudge(random);
      }
      const int exact = exact_orientation(p[0], p[1], p[2], p[3]);
      zeros += exact == 0;
      ASSERT_EQ(orientation(p[0], p[1], p[2], p[3]), exact);
    }
    if (size < 100) {
      EXPECT_GT(zeros, 100);
    }
  }
}

TEST(DoubledArea, CountsCounterClockwiseFromTheAxis) {
  EXPECT_EQ(tetfmt::doubled_area({0, 0, 5}, {2, 0, 7}, {0, 3, 9}, 2), 6);
  EXPECT_EQ(tetfmt::doubled_area({5, 0, 0}, {7, 2, 0}, {9, 0, 3}, 0), 6);
  EXPECT_EQ(tetfmt::doubled_area({0, 5, 0}, {0, 7, 2}, {3, 9, 0}, 1), 6);
  const std::int32_t far = 1 << 29;
  EXPECT_EQ(tetfmt::doubled_area({0, 0, 0}, {far, 0, 0}, {0, far, 0}, 2), std::int64_t{1} << 58);
}

}  // namespace
