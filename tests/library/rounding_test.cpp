// SPDX-License-Identifier: AGPL-3.0-or-later
// What the flags of every target are to make sure of (CMakeLists.txt): a double that was rounded to float
// stays so.
#include <gtest/gtest.h>

namespace {

struct Wide {
  double x, y, z;
};
struct Narrow {
  float x, y, z;
};

/// g++ 12 at -O2 and above, vectorising straight-line code, rounds z only.
[[gnu::noinline]] Wide through_float(Wide a) {
  const Narrow rounded = {static_cast<float>(a.x), static_cast<float>(a.y), static_cast<float>(a.z)};
  return {rounded.x, rounded.y, rounded.z};
}

TEST(Rounding, ToFloatIsNotForgotten) {
  volatile double x = 0.1, y = 0.7, z = 1.3;  // not known when compiling
  const Wide a = through_float({x, y, z});
  EXPECT_EQ(a.x, double{0.1f});
  EXPECT_EQ(a.y, double{0.7f});
  EXPECT_EQ(a.z, double{1.3f});
}

}  // namespace
