// SPDX-License-Identifier: AGPL-3.0-or-later
#include "prep/reduce_crossings.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <random>
#include <set>

#include "common/threads.hpp"
#include "prep/closure.hpp"
#include "prep/prep_support.hpp"
#include "prep/regions.hpp"

namespace tetprep_test {
namespace {

using tetprep::CrossingReport;
using tetprep::Optimize;
using tetprep::reduce_crossings;
using tetprep::snap;
using tetprep::TetMesh;

struct Case {
  const char* name;
  TriangleSoup soup;
};

std::vector<Case> cases() {
  TriangleSoup sheet = {{{0, 0, 0}, {4, 0, 1}, {4, 3, 0}, {0, 3, 1}}, {{0, 1, 2}, {0, 2, 3}}};
  TriangleSoup fan = {{{0, 0, 0}, {0, 0, 1}, {1, 0, 0}, {0, 1, 0}, {-1, -1, 0}},
                      {{0, 1, 2}, {0, 1, 3}, {0, 1, 4}}};
  return {{"cube", cube({0, 0, 0}, 1)}, {"nested cubes", join(cube({0, 0, 0}, 4), cube({1, 1, 1}, 2))},
          {"ball", ball(12)},           {"open sheet", sheet},
          {"non-manifold fan", fan},    {"two balls", join(ball(8), moved(ball(7), {2.5, 0.25, 0}))}};
}

TEST(ReduceCrossings, KeepsTheMeshSoundAndTheSurfaceWhole) {
  tetprep::Progress progress;
  for (const Case& each : cases()) {
    SCOPED_TRACE(each.name);
    const auto surface = snap(each.soup);
    const TetMesh before = fill(surface);
    for (const Optimize effort : {Optimize::fast, Optimize::best}) {
      TetMesh after = before;
      const CrossingReport report = reduce_crossings(after, effort, progress);
      expect_sound(surface, after);
      // Steiner points may move, come and go, the others not.
      const auto fixed = static_cast<std::ptrdiff_t>(surface.points.size() + 8);
      EXPECT_TRUE(std::equal(before.points.begin(), before.points.begin() + fixed, after.points.begin()));
      EXPECT_EQ(after.points.size() + report.dropped_points, before.points.size() + report.new_points);
      EXPECT_LE(report.area_after, report.area_before);
      EXPECT_EQ(report.replacements == 0, report.area_after == report.area_before);
      // A second look starts from what the first one reached, and agrees with it about the area.
      const CrossingReport again = reduce_crossings(after, effort, progress);
      EXPECT_NEAR(again.area_before, report.area_after, 1e-9 * report.area_after);
      EXPECT_LE(again.area_after, again.area_before);
    }
  }
}

TEST(ReduceCrossings, TakesAwayMuchOfTheAreaAroundABall) {
  tetprep::Progress progress;
  const auto surface = snap(ball(24));
  tetprep::TetrahedralizeReport report;
  const tetprep::TetMesh mesh = fill(surface, &report);
  TetMesh fast = mesh, best = mesh;
  const CrossingReport by_fast = reduce_crossings(fast, Optimize::fast, progress);
  const CrossingReport by_best = reduce_crossings(best, Optimize::best, progress);
  EXPECT_LT(by_fast.area_after, 0.85 * by_fast.area_before);
  EXPECT_LT(by_best.area_after, 0.75 * by_best.area_before);
  EXPECT_LE(by_best.area_after, by_fast.area_after);
}

/// The threshold of `fast` is the area of some face: those that have it are among the largest.
TEST(ReduceCrossings, FastTakesEqualFacesForEqual) {
  tetprep::TriangleSoup soup;
  soup.points = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  soup.triangles = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}};
  tetprep::Progress progress;
  TetMesh mesh = fill(snap(soup));
  EXPECT_GT(reduce_crossings(mesh, Optimize::fast, progress).replacements, 0u);
}

TEST(ReduceCrossings, IsTheSameForAnyNumberOfThreads) {
  TetMesh mesh = fill(snap(join(ball(20), moved(ball(18), {2.5, 0.25, 0}))));
  sort_tets(mesh);
  tetprep::Progress progress;
  for (const Optimize effort : {Optimize::fast, Optimize::best}) {
    TetMesh one = mesh, four = mesh;
    tetprep::with_threads(1, [&] { reduce_crossings(one, effort, progress); });
    tetprep::with_threads(4, [&] { reduce_crossings(four, effort, progress); });
    EXPECT_NE(one.tets, mesh.tets);
    EXPECT_EQ(one.tets, four.tets);
    EXPECT_EQ(one.neighbors, four.neighbors);
    EXPECT_EQ(one.face_triangle, four.face_triangle);
  }
}

TEST(ReduceCrossings, KeepsEveryTetInItsRegion) {
  const auto surface = snap(join(ball(12), moved(ball(11), {2.5, 0.25, 0})));
  TetMesh mesh = fill(surface);
  sort_tets(mesh);
  find_regions(mesh);
  tetprep::Progress progress;
  EXPECT_GT(reduce_crossings(mesh, Optimize::best, progress).replacements, 100u);
  expect_sound(surface, mesh);
  // Each region is still one space, and none has become two: found anew, they differ in their numbers alone.
  const std::vector<Index> kept = mesh.region;
  EXPECT_EQ(find_regions(mesh), 3u);
  std::map<Index, std::set<Index>> now;
  for (std::size_t t = 0; t < kept.size(); ++t) now[kept[t]].insert(mesh.region[t]);
  EXPECT_EQ(now.size(), 3u);
  for (const auto& [before, after] : now) EXPECT_EQ(after.size(), 1u);
  EXPECT_EQ(now[0], std::set<Index>{0});
}

/// The volume of all tets, times 6, and the triangles at which they end. Every tet must be positive.
std::pair<double, std::multiset<Index>> extent(const TetMesh& mesh) {
  std::pair<double, std::multiset<Index>> sum;
  for (std::size_t t = 0; t < mesh.tets.size(); ++t) {
    const auto& v = mesh.tets[t];
    const auto& a = mesh.points[v[0]];
    EXPECT_GT(tetfmt::orientation(a, mesh.points[v[1]], mesh.points[v[2]], mesh.points[v[3]]), 0);
    std::array<std::array<double, 3>, 3> d{};
    for (std::size_t i = 0; i < 3; ++i)
      for (std::size_t k = 0; k < 3; ++k) d[i][k] = mesh.points[v[i + 1]][k] - a[k];
    sum.first += d[0][0] * (d[1][1] * d[2][2] - d[1][2] * d[2][1]) +
                 d[0][1] * (d[1][2] * d[2][0] - d[1][0] * d[2][2]) +
                 d[0][2] * (d[1][0] * d[2][1] - d[1][1] * d[2][0]);
    for (std::size_t k = 0; k < 4; ++k)
      if (mesh.neighbors[t][k] == tetprep::kNone) sum.second.insert(mesh.face_triangle[t][k]);
  }
  return sum;
}

TEST(ReduceCrossings, KeepsTheEndsOfAMeshOfWhichSpaceWasLeftOut) {
  TetMesh mesh = fill(snap(join(ball(12), moved(ball(11), {2.5, 0.25, 0}))));
  sort_tets(mesh);
  ASSERT_EQ(find_regions(mesh), 3u);
  keep_regions(mesh, {true, false, true});
  tetprep::Progress progress;
  reduce_crossings(mesh, Optimize::fast, progress);
  const auto before = extent(mesh);
  EXPECT_GT(reduce_crossings(mesh, Optimize::best, progress).replacements, 100u);
  const auto after = extent(mesh);
  EXPECT_NEAR(after.first, before.first, 1e-9 * before.first);
  EXPECT_EQ(after.second, before.second);
  EXPECT_GT(before.second.size(), 12u);
}

TEST(ReduceCrossings, NoneChangesNothing) {
  tetprep::Progress progress;
  const TetMesh before = fill(snap(ball(6)));
  TetMesh after = before;
  const CrossingReport report = reduce_crossings(after, Optimize::none, progress);
  EXPECT_EQ(report.replacements, 0u);
  EXPECT_EQ(after.tets, before.tets);
  EXPECT_EQ(after.neighbors, before.neighbors);
}

/// Small cubes with corners on an integer lattice, some of which share edges or corners: many points in a
/// plane, many tets that see a point from the side.
TriangleSoup lattice(unsigned seed) {
  std::mt19937 random(seed);
  TriangleSoup soup = cube({0, 0, 0}, 1);
  for (int i = 1; i < 12; ++i) {
    const auto place = [&] { return static_cast<double>(2 * (random() % 4)); };
    const double x = place(), y = place(), z = place();
    soup = join(std::move(soup), cube({x, y, z}, 1));
  }
  return soup;
}

TEST(ReduceCrossings, KeepsLatticesSound) {
  tetprep::Progress progress;
  for (unsigned seed = 0; seed < 10; ++seed) {
    SCOPED_TRACE(seed);
    const auto surface = snap(lattice(seed));
    TetMesh mesh = fill(surface);
    const CrossingReport report = reduce_crossings(mesh, Optimize::best, progress);
    EXPECT_LT(report.area_after, report.area_before);
    expect_sound(surface, mesh);
  }
}

TEST(Closure, IsTheBestOfAllSets) {
  std::mt19937 random(5);
  tetprep::Closure closure;
  for (int trial = 0; trial < 2000; ++trial) {
    const std::size_t size = 1 + random() % 10;
    std::vector<double> worth(size);
    std::vector<unsigned> required(size, 0);  // as bits
    closure.clear();
    for (std::size_t i = 0; i < size; ++i) {
      worth[i] = static_cast<double>(random() % 21) - 12;
      std::array<int, 3> list{};
      std::size_t count = 0;
      for (std::size_t j = 0; j < i && count < 3; ++j) {
        if (random() % 3 != 0) continue;
        list[count++] = static_cast<int>(j);
        required[i] |= 1u << j;
      }
      closure.add(worth[i], list, count);
    }
    double best = 0;
    for (unsigned set = 0; set < 1u << size; ++set) {
      double sum = 0;
      bool closed = true;
      for (std::size_t i = 0; i < size; ++i) {
        if ((set >> i & 1) == 0) continue;
        sum += worth[i];
        closed &= (required[i] & ~set) == 0;
      }
      if (closed) best = std::max(best, sum);
    }
    EXPECT_NEAR(closure.solve(), best, 1e-6);
    double taken = 0;
    for (std::size_t i = 0; i < size; ++i) {
      if (!closure.taken(i)) continue;
      taken += worth[i];
      for (std::size_t j = 0; j < i; ++j) EXPECT_TRUE((required[i] >> j & 1) == 0 || closure.taken(j));
    }
    EXPECT_EQ(taken, best);
  }
}

TEST(SortTets, OnlyRenumbers) {
  const auto surface = snap(ball(9));
  TetMesh mesh = fill(surface);
  auto tets = mesh.tets;
  tetprep::sort_tets(mesh);
  expect_sound(surface, mesh);
  auto sorted = mesh.tets;
  EXPECT_NE(sorted, tets);
  std::sort(tets.begin(), tets.end());
  std::sort(sorted.begin(), sorted.end());
  EXPECT_EQ(sorted, tets);
}

}  // namespace
}  // namespace tetprep_test
