// SPDX-License-Identifier: AGPL-3.0-or-later
#include "prep/intersections.hpp"

#include <gtest/gtest.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <atomic>

#include "prep/nasty_surfaces.hpp"
#include "prep/prep_support.hpp"

namespace tetprep_test {
namespace {

using tetprep::GridPoint;
using tetprep::triangles_intersect;
using Corners = std::array<Index, 3>;

/// All orders of the corners, both orders of the triangles: the answer must be the same.
bool intersect(const std::vector<GridPoint>& points, Corners a, Corners b) {
  const bool first = triangles_intersect(points, a, b);
  std::sort(a.begin(), a.end());
  do {
    std::sort(b.begin(), b.end());
    do {
      EXPECT_EQ(triangles_intersect(points, a, b), first);
      EXPECT_EQ(triangles_intersect(points, b, a), first);
    } while (std::next_permutation(b.begin(), b.end()));
  } while (std::next_permutation(a.begin(), a.end()));
  return first;
}

TEST(TrianglesIntersect, WithoutSharedCorners) {
  const std::vector<GridPoint> p{{0, 0, 0},  {8, 0, 0}, {0, 8, 0},   // 0 1 2
                                 {1, 1, -4}, {1, 1, 4}, {9, 9, 4},   // 3 4 5: through it
                                 {0, 0, 1},  {8, 0, 1}, {0, 8, 1},   // 6 7 8: above it
                                 {1, 1, 0},  {2, 1, 0}, {1, 2, 0},   // 9 10 11: within it
                                 {8, 8, 0},  {9, 8, 0}, {8, 9, 0},   // 12 13 14: beside it
                                 {4, 4, 0},  {4, 4, 9}, {9, 9, 9},   // 15: touches its long edge
                                 {0, 0, -1}, {1, 0, 8}, {0, 1, 8}};  // 18: passes near corner 0
  EXPECT_TRUE(intersect(p, {0, 1, 2}, {3, 4, 5}));
  EXPECT_FALSE(intersect(p, {0, 1, 2}, {6, 7, 8}));
  EXPECT_TRUE(intersect(p, {0, 1, 2}, {9, 10, 11}));
  EXPECT_FALSE(intersect(p, {0, 1, 2}, {12, 13, 14}));
  EXPECT_TRUE(intersect(p, {0, 1, 2}, {15, 16, 17}));
  EXPECT_TRUE(intersect(p, {0, 1, 2}, {18, 19, 20}));
}

TEST(TrianglesIntersect, SharedCorner) {
  const std::vector<GridPoint> p{{0, 0, 0},  {8, 0, 0}, {0, 8, 0}, {-8, 0, 0}, {0, -8, 0}, {4, 4, 4},
                                 {4, 4, -4}, {2, 2, 0}, {2, 3, 0}, {2, 2, 5},  {8, 8, 0}};
  EXPECT_FALSE(intersect(p, {0, 1, 2}, {0, 3, 4})) << "opposite in the plane";
  EXPECT_TRUE(intersect(p, {0, 1, 2}, {0, 5, 6})) << "through it from the corner";
  EXPECT_TRUE(intersect(p, {0, 1, 2}, {0, 7, 8})) << "inside it, in the plane";
  EXPECT_TRUE(intersect(p, {0, 1, 2}, {0, 7, 9})) << "an edge lies in it";
  EXPECT_FALSE(intersect(p, {0, 1, 2}, {0, 3, 9})) << "leaves it at once";
  EXPECT_TRUE(intersect(p, {0, 1, 2}, {0, 10, 9})) << "an edge crosses it";
}

TEST(TrianglesIntersect, SharedEdge) {
  const std::vector<GridPoint> p{{0, 0, 0}, {8, 0, 0}, {0, 8, 0}, {0, -8, 0},
                                 {1, 1, 0}, {0, 8, 1}, {9, 9, 0}};
  EXPECT_FALSE(intersect(p, {0, 1, 2}, {0, 1, 3})) << "a flat pair";
  EXPECT_TRUE(intersect(p, {0, 1, 2}, {0, 1, 4})) << "folded onto itself, inside";
  EXPECT_TRUE(intersect(p, {0, 1, 2}, {0, 1, 6})) << "folded onto itself, crossing";
  EXPECT_FALSE(intersect(p, {0, 1, 2}, {0, 1, 5})) << "a sharp edge";
}

TEST(TrianglesIntersect, ExactAtFullSize) {
  constexpr std::int32_t k = 1 << 22;
  // One grid step decides: the plane through the first three points passes exactly through (0, 0, 0).
  const std::vector<GridPoint> p{{k, -k, 1}, {-k, k, -1}, {k, k, k},  {0, 0, 0},
                                 {1, 0, 0},  {0, 0, -k},  {-k, 1, -k}};
  EXPECT_TRUE(intersect(p, {0, 1, 2}, {3, 5, 6}));
  std::vector<GridPoint> q = p;
  q[3] = {0, 0, -1};
  EXPECT_FALSE(intersect(q, {0, 1, 2}, {3, 5, 6}));
}

std::vector<tetprep::TrianglePair> search(const TriangleSoup& soup, unsigned threads) {
  const auto surface = tetprep::snap(soup);
  tetprep::IntersectionSearch search(surface, threads);
  return search.wait();
}

TEST(IntersectionSearch, FindsAllPairs) {
  EXPECT_TRUE(search(cube({0, 0, 0}, 8), 1).empty());
  EXPECT_TRUE(search(ball(20), 2).empty());
  EXPECT_TRUE(search(join(cube({0, 0, 0}, 8), cube({2, 2, 2}, 4)), 1).empty()) << "nested";
  EXPECT_FALSE(search(join(cube({0, 0, 0}, 8), cube({4, 4, 4}, 8)), 1).empty());
  EXPECT_FALSE(search(join(cube({0, 0, 0}, 8), cube({8, 0.5, 0.5}, 4)), 1).empty()) << "touching sides";
  EXPECT_TRUE(search(join(cube({0, 0, 0}, 8), cube({8, 0, 0}, 8)), 1).empty()) << "sharing a whole side";
  const TriangleSoup balls = join(ball(30), moved(ball(30), {0.7, 0.1, 0.2}));
  const auto one = search(balls, 1), two = search(balls, 2);
  EXPECT_GT(one.size(), 50u);
  EXPECT_EQ(one, two);
  // The same pairs by trying all.
  const auto surface = tetprep::snap(join(ball(6), moved(ball(6), {0.7, 0.1, 0.2})));
  std::vector<tetprep::TrianglePair> all;
  for (Index i = 0; i < surface.triangles.size(); ++i)
    for (Index j = i + 1; j < surface.triangles.size(); ++j)
      if (triangles_intersect(surface.points, surface.triangles[i], surface.triangles[j]))
        all.emplace_back(i, j);
  tetprep::IntersectionSearch fast(surface, 2);
  EXPECT_EQ(fast.wait(), all);
  EXPECT_GT(all.size(), 10u);
}

std::vector<tetprep::TrianglePair> find(const tetprep::CleanSurface& surface, const std::vector<bool>& active,
                                        std::size_t most, int threads) {
  const std::atomic<bool> cancelled{false};
  std::atomic<std::size_t> found{0};
  std::vector<tetprep::TrianglePair> pairs;
  tbb::task_arena(threads).execute([&] {
    pairs = tetprep::find_intersections(surface.points, surface.triangles, active, most, cancelled, found);
  });
  return pairs;
}

TEST(FindIntersections, OnlyWithActiveTriangles) {
  const auto surface = tetprep::snap(join(ball(20), moved(ball(20), {0.7, 0.1, 0.2})));
  auto pairs = find(surface, {}, 100000, 2);
  std::vector<bool> active(surface.triangles.size(), false);
  for (std::size_t i = 0; i < pairs.size(); i += 3)
    active[i % 2 == 0 ? pairs[i].first : pairs[i].second] = true;
  const std::size_t all = pairs.size();
  std::erase_if(pairs, [&](const auto& pair) { return !active[pair.first] && !active[pair.second]; });
  EXPECT_LT(pairs.size(), all);
  EXPECT_EQ(find(surface, active, 100000, 2), pairs);
  EXPECT_TRUE(find(surface, std::vector<bool>(surface.triangles.size(), false), 100000, 1).empty());
}

TEST(FindIntersections, TheSameOnesIfThereAreTooMany) {
  const auto surface = tetprep::snap(random_triangles(2000, 0.5));
  const auto all = find(surface, {}, 1000000, 2), some = find(surface, {}, 3000, 1);
  EXPECT_GT(all.size(), 20000u);
  EXPECT_EQ(some.size(), 3000u);
  for (int i = 0; i < 5; ++i) EXPECT_EQ(find(surface, {}, 3000, 2), some);
  EXPECT_TRUE(std::includes(all.begin(), all.end(), some.begin(), some.end()));
}

TEST(IntersectionSearch, CanBeGivenUp) {
  const auto surface = tetprep::snap(ball(80));
  tetprep::IntersectionSearch search(surface, 2);
}

}  // namespace
}  // namespace tetprep_test
