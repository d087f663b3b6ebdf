// SPDX-License-Identifier: AGPL-3.0-or-later
#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <limits>
#include <random>

#include "prep/box.hpp"
#include "prep/prep_support.hpp"

namespace tetprep_test {
namespace {

using tetprep::CleanSurface;
using tetprep::ExitCode;
using tetprep::snap;

std::array<double, 3> model(const CleanSurface& surface, std::size_t point) {
  std::array<double, 3> p{};
  for (std::size_t k = 0; k < 3; ++k)
    p[k] = surface.origin[k] + std::ldexp(surface.points[point][k], surface.grid_exponent);
  return p;
}

/// Every corner of every kept triangle is the input's, to the bit.
void expect_verbatim(const TriangleSoup& soup, const CleanSurface& surface) {
  EXPECT_EQ(surface.max_deviation, 0);
  for (std::size_t t = 0; t < surface.triangles.size(); ++t)
    for (std::size_t i = 0; i < 3; ++i) {
      const auto got = model(surface, surface.triangles[t][i]);
      const auto& expected = soup.points[soup.triangles[surface.input_triangle[t]][i]];
      for (std::size_t k = 0; k < 3; ++k)
        EXPECT_EQ(std::bit_cast<std::uint64_t>(got[k]), std::bit_cast<std::uint64_t>(expected[k] + 0.0));
    }
}

void expect_bounded(const CleanSurface& surface) {
  const auto box = tetprep::box_around(surface.points);
  for (std::size_t k = 0; k < 3; ++k) {
    EXPECT_GE(box.low[k], -tetprep::kMaxCoordinate);
    EXPECT_LE(box.high[k], tetprep::kMaxCoordinate);
    EXPECT_LT(box.low[k], box.high[k]);
  }
}

TEST(Snap, KeepsGridCoordinatesBitForBit) {
  std::mt19937_64 random(1);
  for (const int bits : {4, 12, 20, 21, 22}) {
    for (const int exponent : {-80, -21, -3, 0, 7, 60}) {
      TriangleSoup soup;
      const auto most = (std::int64_t{1} << bits);
      for (int i = 0; i < 300; ++i) {
        std::array<double, 3> p{};
        for (double& x : p)
          x = std::ldexp(static_cast<double>(random() % static_cast<std::uint64_t>(most + 1)), exponent);
        soup.points.push_back(p);
      }
      soup.points[0] = {0, 0, 0};
      soup.points[1] = {std::ldexp(static_cast<double>(most), exponent), -0.0, std::ldexp(1.0, exponent)};
      for (Index i = 0; i + 2 < 300; ++i) soup.triangles.push_back({i, i + 1, i + 2});
      for (const double shift :
           {0.0, -std::ldexp(static_cast<double>(most / 2), exponent), std::ldexp(1.0, exponent + 40)}) {
        const TriangleSoup shifted = moved(soup, {shift, 0, -shift});
        const CleanSurface surface = snap(shifted);
        expect_verbatim(shifted, surface);
        expect_bounded(surface);
        if (bits < 20) {
          EXPECT_LT(surface.grid_exponent, exponent) << "no room between the grid's points";
        }
      }
    }
  }
}

TEST(Snap, OriginIsZeroWhereItCanBe) {
  EXPECT_EQ(snap(cube({-3, 5.75, 1}, 2)).origin, (std::array<double, 3>{0, 0, 0}));
  EXPECT_NE(snap(cube({-3, 6, 1}, 2)).origin, (std::array<double, 3>{0, 0, 0}));
}

TEST(Snap, RoundsToTheNearest) {
  std::mt19937_64 random(2);
  std::uniform_real_distribution<double> uniform(-1, 1);
  for (const double far : {0.0, 1e3, -1e9}) {
    TriangleSoup soup;
    for (int i = 0; i < 1000; ++i)
      soup.points.push_back({far + uniform(random), uniform(random), uniform(random)});
    for (Index i = 0; i + 2 < 1000; ++i) soup.triangles.push_back({i, i + 1, i + 2});
    const CleanSurface surface = snap(soup);
    const double step = std::ldexp(1.0, surface.grid_exponent);
    EXPECT_LE(step, 2.0 / (1 << 20));
    EXPECT_GE(step, 2.0 / (1 << 22));
    EXPECT_GT(surface.max_deviation, 0);
    EXPECT_LE(surface.max_deviation, step / 2 * std::sqrt(3.0) * (1 + 1e-9));
    expect_bounded(surface);
    double worst = 0;
    for (std::size_t t = 0; t < surface.triangles.size(); ++t)
      for (std::size_t i = 0; i < 3; ++i) {
        const auto p = model(surface, surface.triangles[t][i]);
        const auto& q = soup.points[soup.triangles[surface.input_triangle[t]][i]];
        worst = std::max(worst, std::hypot(p[0] - q[0], p[1] - q[1], p[2] - q[2]));
      }
    EXPECT_NEAR(worst, surface.max_deviation, step * 1e-3);
  }
}

TEST(Snap, MergesAndDrops) {
  TriangleSoup soup;
  soup.points = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1e-9, 0, 0}, {0.5, 0.5, 0}, {7, 7, 7}, {0, 0, -0.0}};
  soup.triangles = {{0, 1, 2},   // stays
                    {3, 2, 1},   // the same, by a point that snapping merges, reversed
                    {1, 4, 2},   // collinear, three different points
                    {0, 0, 1},   // a corner twice
                    {0, 3, 1},   // two corners merge
                    {6, 1, 4}};  // stays
  const CleanSurface surface = snap(soup);
  EXPECT_EQ(surface.input_triangle_count, 6u);
  EXPECT_EQ(surface.input_triangle, (std::vector<Index>{0, 5}));
  EXPECT_EQ(surface.triangles, (std::vector<std::array<Index, 3>>{{0, 1, 2}, {0, 1, 3}}));
  EXPECT_EQ(surface.degenerate_triangles, 3u);
  EXPECT_EQ(surface.duplicate_triangles, 1u);
  EXPECT_EQ(surface.merged_points, 2u);
  EXPECT_EQ(surface.points.size(), 4u) << "point 5 belongs to nothing";
}

TEST(Snap, NothingLeft) {
  TriangleSoup line;
  line.points = {{0, 0, 0}, {1, 1, 1}, {2, 2, 2}};
  line.triangles = {{0, 1, 2}, {0, 1, 1}};
  EXPECT_EQ(failure_of([&] { snap(line); }).code(), ExitCode::invalid);
  TriangleSoup dot;
  dot.points = {{3, 4, 5}};
  dot.triangles = {{0, 0, 0}};
  EXPECT_EQ(failure_of([&] { snap(dot); }).code(), ExitCode::invalid);
}

TEST(Snap, BeyondSinglePrecision) {
  for (const double edge :
       {1e-45, 1e300, std::numeric_limits<double>::max(), std::numeric_limits<double>::denorm_min()})
    EXPECT_EQ(failure_of([&] { snap(cube({0, 0, 0}, edge)); }).code(), ExitCode::unsupported) << edge;
  const double most = std::numeric_limits<double>::max();
  EXPECT_EQ(failure_of([&] { snap(cube({-most, 0, 0}, most)); }).code(), ExitCode::unsupported);
  for (const double edge : {1e-30, 1e30}) expect_bounded(snap(cube({0, 0, 0}, edge)));
}

TEST(Snap, FarAway) {
  for (const double far : {1e5, 1e10, 1e15}) {
    const TriangleSoup soup = moved(ball(6), {far, -far, 3});
    const CleanSurface surface = snap(soup);
    expect_bounded(surface);
    EXPECT_LT(surface.max_deviation, 2e-6);
  }
}

}  // namespace
}  // namespace tetprep_test
