// SPDX-License-Identifier: AGPL-3.0-or-later
#include "bench/statistics.hpp"

#include <gtest/gtest.h>

#include "bench/dice.hpp"

namespace tetfmt_test {
namespace {

using tetbench::ratio;
using tetbench::Summary;

TEST(Statistics, RatioOfRepetitionsInTurnIgnoresWhatBothShare) {
  // The machine slows down by a factor of three meanwhile; the ratio does not.
  const std::vector<double> b = {1, 1.5, 2, 2.5, 3}, a = {2, 3, 4, 5, 6};
  const Summary same = ratio(a, b, 1);
  EXPECT_EQ(same.low, 2);
  EXPECT_EQ(same.median, 2);
  EXPECT_EQ(same.high, 2);
}

TEST(Statistics, BootstrapIntervalHoldsTheMedianAndIsTheSameForASeed) {
  tetbench::Dice dice({42});
  std::vector<double> a, b;
  for (int i = 0; i < 101; ++i) {
    b.push_back(dice.between(0.9, 1.1));
    a.push_back(b.back() * dice.between(1, 2));
  }
  const Summary first = ratio(a, b, 7), again = ratio(a, b, 7);
  EXPECT_LT(first.low, first.median);
  EXPECT_LT(first.median, first.high);
  // Evenly between 1 and 2: the median of 101 has a standard deviation of about 1/20.
  EXPECT_GT(first.low, 1.25);
  EXPECT_LT(first.high, 1.75);
  EXPECT_LT(first.high - first.low, 0.3);
  EXPECT_EQ(first.low, again.low);
  EXPECT_EQ(first.high, again.high);
}

TEST(Statistics, BootstrapIntervalCoversTheTrueMedianAsOftenAsItSays) {
  int covered = 0;
  constexpr int kTrials = 200;
  tetbench::Dice dice({3});
  for (int trial = 0; trial < kTrials; ++trial) {
    std::vector<double> values, ones(31, 1);
    for (int i = 0; i < 31; ++i) values.push_back(dice.unit());
    const Summary summary = ratio(values, ones, static_cast<std::uint64_t>(trial));
    covered += summary.low <= 0.5 && 0.5 <= summary.high ? 1 : 0;
  }
  EXPECT_GE(covered, kTrials * 88 / 100);
  EXPECT_LT(covered, kTrials);
}

}  // namespace
}  // namespace tetfmt_test
