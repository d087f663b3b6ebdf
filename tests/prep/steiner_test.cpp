// SPDX-License-Identifier: AGPL-3.0-or-later
#include "prep/steiner.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "prep/box.hpp"

namespace tetprep_test {
namespace {

using tetprep::GridPoint;
using tetprep::Index;

/// A point inside of a box, joined with each of its triangles.
struct Star {
  std::vector<GridPoint> points;
  std::vector<std::array<Index, 4>> tets;
};

Star star(const GridPoint& low, const GridPoint& high) {
  Star out;
  const auto corners = tetprep::Box{low, high}.corners();
  out.points.assign(corners.begin(), corners.end());
  // The box's triangles point outward, so the middle is behind each.
  for (const auto& [a, b, c] : tetprep::Box::kTriangles) out.tets.push_back({a, c, b, 8});
  return out;
}

void expect_positive(const Star& s) {
  for (const auto& [a, b, c, d] : s.tets)
    EXPECT_EQ(tetfmt::orientation(s.points[a], s.points[b], s.points[c], s.points[d]), 1);
}

TEST(PlaceSteinerPoints, NearestWhereItFits) {
  Star s = star({0, 0, 0}, {100, 100, 100});
  const std::vector<tetprep::Point> wanted{{50.4, 49.6, 50}};
  EXPECT_EQ(tetprep::place_steiner_points(s.points, 8, wanted, s.tets, 1), Index{0});
  EXPECT_EQ(s.points[8], (GridPoint{50, 50, 50}));
  expect_positive(s);
}

TEST(PlaceSteinerPoints, MovedWhereRoundingFlattens) {
  Star s = star({0, 0, 0}, {100, 100, 100});
  const std::vector<tetprep::Point> wanted{
      {0.3, 50, 50}};  // inside, but the nearest grid point is on the side
  EXPECT_EQ(tetprep::place_steiner_points(s.points, 8, wanted, s.tets, 1), Index{1});
  EXPECT_EQ(s.points[8], (GridPoint{1, 50, 50}));
  expect_positive(s);
}

TEST(PlaceSteinerPoints, MovedFarWhereItMust) {
  // Far outside: only places near the middle are left.
  Star s = star({0, 0, 0}, {100, 100, 100});
  const std::vector<tetprep::Point> wanted{{-3000, 40, 60}};
  EXPECT_EQ(tetprep::place_steiner_points(s.points, 8, wanted, s.tets, 1), Index{1});
  expect_positive(s);
}

TEST(PlaceSteinerPoints, HopelessIsSaid) {
  Star s = star({0, 0, 0}, {1, 1, 1});  // no grid point inside
  const std::vector<tetprep::Point> wanted{{0.5, 0.5, 0.5}};
  EXPECT_EQ(tetprep::place_steiner_points(s.points, 8, wanted, s.tets, 1), std::nullopt);
}

TEST(PlaceSteinerPoints, BoundOnesStayNear) {
  const std::vector<tetprep::Point> wanted{{-3, 50, 50}};
  Star s = star({0, 0, 0}, {100, 100, 100});
  EXPECT_EQ(tetprep::place_steiner_points(s.points, 8, wanted, s.tets, 1, 1, 2), std::nullopt);
  s = star({0, 0, 0}, {100, 100, 100});
  EXPECT_EQ(tetprep::place_steiner_points(s.points, 8, wanted, s.tets, 1, 1, 4), Index{1});
  EXPECT_EQ(s.points[8], (GridPoint{1, 50, 50}));
  expect_positive(s);
}

TEST(PlaceSteinerPoints, NoneAtAll) {
  Star s = star({0, 0, 0}, {10, 10, 10});
  s.points.push_back({5, 5, 5});
  EXPECT_EQ(tetprep::place_steiner_points(s.points, 9, {}, s.tets, 1), Index{0});
  EXPECT_EQ(tetprep::place_steiner_points(s.points, 9, {}, s.tets, -1), std::nullopt)
      << "the other orientation";
}

}  // namespace
}  // namespace tetprep_test
