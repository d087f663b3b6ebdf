// SPDX-License-Identifier: AGPL-3.0-or-later
#include "tetfmt/mesh.hpp"

#include <gtest/gtest.h>

#include <limits>

namespace {

using tetfmt::grid_exponent;

TEST(GridExponent, IsTheLargestThatHoldsEveryCoordinate) {
  EXPECT_EQ(grid_exponent({{1, 2, 4}}), 0);
  EXPECT_EQ(grid_exponent({{4, -8, 12}}), 2);
  EXPECT_EQ(grid_exponent({{0.75f, 3, -5}}), -2);
  EXPECT_EQ(grid_exponent({{0x1p-30f, 0, 0}, {0x1p-10f, 0, 0}}), -30);
}

TEST(GridExponent, IgnoresZeros) {
  EXPECT_EQ(grid_exponent({{0, -0.0f, 8}}), 3);
  EXPECT_EQ(grid_exponent({{0, 0, 0}}), 0);
  EXPECT_EQ(grid_exponent({}), 0);
}

TEST(GridExponent, ReachesTheEndsOfTheRange) {
  EXPECT_EQ(grid_exponent({{std::numeric_limits<float>::denorm_min(), 1, 1}}), -149);
  EXPECT_EQ(grid_exponent({{0x1p127f, 0, 0}}), 127);
  EXPECT_EQ(grid_exponent({{std::numeric_limits<float>::max(), 0, 0}}), 104);
}

}  // namespace
