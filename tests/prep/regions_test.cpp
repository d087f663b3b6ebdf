// SPDX-License-Identifier: AGPL-3.0-or-later
#include "prep/regions.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <span>

#include "common/threads.hpp"
#include "prep/box.hpp"
#include "prep/prep_support.hpp"
#include "prep/reduce_crossings.hpp"
#include "tetfmt/encode.hpp"
#include "tetfmt/validate.hpp"

namespace tetprep_test {
namespace {

using tetprep::CleanSurface;
using tetprep::find_regions;
using tetprep::kNone;
using tetprep::region_at;
using tetprep::snap;
using tetprep::TetMesh;

std::vector<tetfmt::Region> regions_of(TetMesh mesh) {
  tetprep::group_by_region(mesh);
  const tetfmt::OptionalSection section = tetprep::region_section(mesh);
  EXPECT_EQ(section.kind, tetfmt::kRegions);
  EXPECT_EQ(section.bytes.size() % sizeof(tetfmt::Region), 0u);
  std::vector<tetfmt::Region> regions(section.bytes.size() / sizeof(tetfmt::Region));
  std::memcpy(regions.data(), section.bytes.data(), section.bytes.size());
  return regions;
}

/// Volumes of all regions but the outer one, ascending.
std::vector<double> inner_volumes(const TetMesh& mesh) {
  std::vector<double> volumes;
  for (const tetfmt::Region& region : regions_of(mesh))
    if (region.id != 0) volumes.push_back(region.volume);
  std::sort(volumes.begin(), volumes.end());
  return volumes;
}

double box_volume(const TetMesh& mesh) {
  const auto box = tetprep::bounds_of(mesh.points);
  double volume = std::ldexp(1.0, 3 * mesh.grid_exponent);
  for (std::size_t k = 0; k < 3; ++k) volume *= box.high[k] - box.low[k];
  return volume;
}

/// Two rooms of 1 x 1 x 1 with one wall between them: the second cube's copy of it is dropped by snap().
TriangleSoup two_rooms() {
  return join(cube({0, 0, 0}, 1), cube({1, 0, 0}, 1));
}

TriangleSoup nested() {
  return join(join(cube({0, 0, 0}, 8), cube({1, 1, 1}, 4)), cube({2, 2, 2}, 2));
}

/// The first problem that Level::geometry finds, or an empty string.
std::string problem(const TetMesh& mesh, const CleanSurface& surface) {
  const auto bytes = tetfmt::encode(tetprep::order(mesh, surface), tetfmt::Layout::tet20);
  const tetfmt::Report report = tetfmt::validate(bytes);
  return report.valid() ? "" : tetfmt::to_string(report.issues.begin()->second.examples.front());
}

TEST(Regions, AreAsManyAndAsLargeAsTheSurfaceSays) {
  struct Case {
    const char* name;
    TriangleSoup soup;
    std::vector<double> inner;
  };
  TriangleSoup open = cube({0, 0, 0}, 1);
  open.triangles.pop_back();
  TriangleSoup sheet = {{{0, 0, 0}, {4, 0, 1}, {4, 3, 0}, {0, 3, 1}}, {{0, 1, 2}, {0, 2, 3}}};
  for (const Case& each :
       {Case{"cube", cube({-3, 5, 1}, 4), {64}}, Case{"nested cubes", nested(), {8, 64 - 8, 512 - 64}},
        Case{"two rooms", two_rooms(), {1, 1}},
        Case{"apart", join(cube({0, 0, 0}, 1), cube({4, 0, 0}, 2)), {1, 8}}, Case{"open cube", open, {}},
        Case{"sheet", sheet, {}}}) {
    SCOPED_TRACE(each.name);
    TetMesh mesh = fill(snap(each.soup));
    EXPECT_EQ(find_regions(mesh), each.inner.size() + 1);
    EXPECT_EQ(inner_volumes(mesh), each.inner);
    double inner = 0;
    for (const double volume : each.inner) inner += volume;
    EXPECT_DOUBLE_EQ(regions_of(mesh).front().volume, box_volume(mesh) - inner);
  }
}

TEST(Regions, EndAtTrianglesAndNowhereElse) {
  const CleanSurface surface = snap(join(join(ball(10), moved(ball(6), {3, 0.5, 0})), cube({-4, -4, -4}, 9)));
  TetMesh mesh = fill(surface);
  ASSERT_EQ(find_regions(mesh), 4u);
  std::size_t walls = 0;
  for (std::size_t t = 0; t < mesh.tets.size(); ++t) {
    for (std::size_t k = 0; k < 4; ++k) {
      const Index beyond = mesh.neighbors[t][k];
      if (beyond == kNone) {
        EXPECT_EQ(mesh.region[t], 0u);
      } else if (mesh.face_triangle[t][k] == kNone) {
        EXPECT_EQ(mesh.region[beyond], mesh.region[t]);
      } else {
        EXPECT_NE(mesh.region[beyond], mesh.region[t]);
        ++walls;
      }
    }
  }
  EXPECT_EQ(walls, 2 * surface.triangles.size());
  // Numbered as they are met.
  std::vector<Index> met;
  for (const Index region : mesh.region)
    if (region != 0 && std::find(met.begin(), met.end(), region) == met.end()) met.push_back(region);
  EXPECT_EQ(met, (std::vector<Index>{1, 2, 3}));
}

TEST(Regions, HaveTheBoundsOfTheirVertices) {
  TetMesh mesh = fill(snap(nested()));
  find_regions(mesh);
  for (const tetfmt::Region& region : regions_of(mesh)) {
    if (region.volume != 8) continue;  // the innermost cube, from 2 to 4
    EXPECT_EQ(mesh.origin[0] + region.lower.x, 2);
    EXPECT_EQ(mesh.origin[1] + region.lower.y, 2);
    EXPECT_EQ(mesh.origin[2] + region.upper.z, 4);
    return;
  }
  FAIL() << "no region of volume 8";
}

TEST(Regions, AreFoundFromPointsExactly) {
  TetMesh mesh = fill(snap(two_rooms()));
  ASSERT_EQ(find_regions(mesh), 3u);
  const Index left = region_at(mesh, {0.5, 0.5, 0.5}), right = region_at(mesh, {1.5, 0.5, 0.5});
  EXPECT_EQ(std::minmax(left, right), std::minmax(Index{1}, Index{2}));
  EXPECT_EQ(region_at(mesh, {-0.05, 0.5, 0.5}), 0u);
  // As near to the wall as doubles get, which is much nearer than the grid.
  EXPECT_EQ(region_at(mesh, {std::nextafter(1.0, 0.0), 0.3, 0.6}), left);
  EXPECT_EQ(region_at(mesh, {std::nextafter(1.0, 2.0), 0.3, 0.6}), right);
  EXPECT_EQ(region_at(mesh, {1, 0.3, 0.6}), 1u) << "on the wall: the lower number";
  EXPECT_EQ(region_at(mesh, {0, 0, 0}), 0u) << "a corner touches the outside";
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  for (const double far : {50.0, -1e9, 1e300, kInfinity, std::nan("")})
    EXPECT_EQ(region_at(mesh, {0.5, far, 0.5}), kNone) << far;
}

TEST(Regions, CanBeLeftOutInAnyCombination) {
  tetprep::Progress progress;
  for (const TriangleSoup& soup : {two_rooms(), nested(), join(ball(5), moved(ball(4), {2.5, 0.25, 0}))}) {
    const CleanSurface surface = snap(soup);
    TetMesh whole = fill(surface);
    sort_tets(whole);
    const Index count = find_regions(whole);
    for (unsigned chosen = 1; chosen < 1u << count; ++chosen) {
      SCOPED_TRACE(chosen);
      std::vector<bool> kept(count);
      for (Index i = 0; i < count; ++i) kept[i] = (chosen >> i & 1) != 0;
      TetMesh mesh = whole;
      tetprep::keep_regions(mesh, kept);
      const auto left =
          std::count_if(whole.region.begin(), whole.region.end(), [&](Index r) { return kept[r]; });
      ASSERT_EQ(mesh.tets.size(), static_cast<std::size_t>(left));
      EXPECT_TRUE(std::all_of(mesh.region.begin(), mesh.region.end(), [&](Index r) { return kept[r]; }));
      const double volume_before = regions_of(mesh).front().volume;
      reduce_crossings(mesh, tetprep::Optimize::best, progress);
      group_by_region(mesh);
      EXPECT_TRUE(std::is_sorted(mesh.region.begin(), mesh.region.end()));
      EXPECT_EQ(regions_of(mesh).front().volume, volume_before);
      EXPECT_EQ(regions_of(mesh).size(), static_cast<std::size_t>(std::popcount(chosen)));
      EXPECT_EQ(problem(mesh, surface), "");
    }
  }
}

TEST(Regions, GroupingKeepsTheOrderWithinEach) {
  TetMesh mesh = fill(snap(nested()));
  sort_tets(mesh);
  find_regions(mesh);
  // A tet's vertices tell it from the others.
  std::vector<std::array<Index, 4>> expected;
  for (Index region = 0; region < 4; ++region)
    for (std::size_t t = 0; t < mesh.tets.size(); ++t)
      if (mesh.region[t] == region) expected.push_back(mesh.tets[t]);
  ASSERT_NE(mesh.tets, expected) << "already grouped: this shows nothing";
  group_by_region(mesh);
  EXPECT_EQ(mesh.tets, expected);
}

TEST(Regions, AreTheSameForAnyNumberOfThreads) {
  const TetMesh mesh = fill(snap(join(ball(12), moved(ball(11), {2.5, 0.25, 0}))));
  TetMesh one = mesh, four = mesh;
  tetprep::with_threads(1, [&] { find_regions(one); });
  tetprep::with_threads(4, [&] { find_regions(four); });
  EXPECT_EQ(one.region, four.region);
}

TEST(Regions, OfManySmallPartsAreFoundQuickly) {
  TriangleSoup soup;
  for (int i = 0; i < 1000; ++i)
    soup = join(std::move(soup), cube({2.0 * (i % 10), 2.0 * (i / 10 % 10), 2.0 * (i / 100)}, 1));
  TetMesh mesh = fill(snap(soup));
  EXPECT_EQ(find_regions(mesh), 1001u);
  EXPECT_EQ(inner_volumes(mesh), std::vector<double>(1000, 1.0));
}

}  // namespace
}  // namespace tetprep_test
