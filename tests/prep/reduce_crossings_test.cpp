// SPDX-License-Identifier: AGPL-3.0-or-later
#include "prep/reduce_crossings.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <set>

#include "common/threads.hpp"
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
  EXPECT_LT(by_fast.area_after, 0.75 * by_fast.area_before);
  EXPECT_LT(by_best.area_after, 0.75 * by_best.area_before);
  EXPECT_LE(by_best.area_after, by_fast.area_after);
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

TEST(ReduceCrossings, NoneChangesNothing) {
  tetprep::Progress progress;
  const TetMesh before = fill(snap(ball(6)));
  TetMesh after = before;
  const CrossingReport report = reduce_crossings(after, Optimize::none, progress);
  EXPECT_EQ(report.replacements, 0u);
  EXPECT_EQ(after.tets, before.tets);
  EXPECT_EQ(after.neighbors, before.neighbors);
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
