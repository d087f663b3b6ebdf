// SPDX-License-Identifier: AGPL-3.0-or-later
#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <span>

#include "common/threads.hpp"
#include "prep/box.hpp"
#include "prep/prep_support.hpp"
#include "prep/regions.hpp"
#include "tetfmt/encode.hpp"
#include "tetfmt/validate.hpp"

namespace tetprep_test {
namespace {

using tetprep::CleanSurface;
using tetprep::kNone;
using tetprep::order;
using tetprep::snap;
using tetprep::TetMesh;
using Corners = std::array<Index, 3>;
constexpr Corners kNoCorners{kNone, kNone, kNone};

template <class T>
std::vector<T> section(const tetfmt::Mesh& mesh, tetfmt::SectionKind kind) {
  for (const tetfmt::OptionalSection& each : mesh.optional) {
    if (each.kind != kind) continue;
    EXPECT_EQ(each.stride, sizeof(T));
    std::vector<T> values(each.bytes.size() / sizeof(T));
    std::memcpy(values.data(), each.bytes.data(), each.bytes.size());
    return values;
  }
  return {};
}

std::vector<tetfmt::SectionKind> kinds(const tetfmt::Mesh& mesh) {
  std::vector<tetfmt::SectionKind> result;
  for (const auto& each : mesh.optional) result.push_back(each.kind);
  return result;
}

void expect_valid(const tetfmt::Mesh& mesh) {
  for (const tetfmt::Layout layout : {tetfmt::Layout::tet20, tetfmt::Layout::tet16}) {
    const tetfmt::Report report = tetfmt::validate(tetfmt::encode(mesh, layout));
    EXPECT_TRUE(report.valid()) << tetfmt::to_string(report.issues.begin()->second.examples.front());
  }
}

/// Model coordinates of a triangle's corners, as the file has them.
std::array<tetprep::Point, 3> places(const tetfmt::Mesh& mesh, const Corners& corners) {
  std::array<tetprep::Point, 3> result{};
  for (std::size_t i = 0; i < 3; ++i) {
    const tetfmt::Vec3f& v = mesh.vertices[corners[i]];
    result[i] = {mesh.origin[0] + v.x, mesh.origin[1] + v.y, mesh.origin[2] + v.z};
  }
  return result;
}
std::array<tetprep::Point, 3> places(const TriangleSoup& soup, std::size_t t) {
  const auto& [a, b, c] = soup.triangles[t];
  return {soup.points[a], soup.points[b], soup.points[c]};
}

/// Grouped by region, of which only those are kept that hold one of `points` (all if empty).
TetMesh prepared(const CleanSurface& surface, const std::vector<tetprep::Point>& points = {}) {
  TetMesh mesh = fill(surface);
  sort_tets(mesh);
  std::vector<bool> kept(find_regions(mesh), points.empty());
  for (const auto& point : points) kept.at(region_at(mesh, point)) = true;
  keep_regions(mesh, kept);
  group_by_region(mesh);
  return mesh;
}

/// `soup` on its grid, with triangle `t` cut into three at its middle.
CleanSurface with_cut(const TriangleSoup& soup, std::size_t t) {
  CleanSurface surface = snap(soup);
  surface.input_corners.assign(surface.input_triangle_count, kNoCorners);
  for (std::size_t i = 0; i < surface.triangles.size(); ++i)
    surface.input_corners[surface.input_triangle[i]] = surface.triangles[i];
  const auto at = std::find(surface.input_triangle.begin(), surface.input_triangle.end(), t) -
                  surface.input_triangle.begin();
  const Corners whole = surface.triangles[static_cast<std::size_t>(at)];
  tetprep::GridPoint middle{};  // on the edge of no triangle, and (of a cube's) in its plane
  for (std::size_t k = 0; k < 3; ++k)
    middle[k] =
        (surface.points[whole[0]][k] * 2 + surface.points[whole[1]][k] + surface.points[whole[2]][k]) / 4;
  const auto centre = static_cast<Index>(surface.points.size());
  surface.points.push_back(middle);
  surface.triangles.erase(surface.triangles.begin() + at);
  surface.input_triangle.erase(surface.input_triangle.begin() + at);
  for (std::size_t i = 0; i < 3; ++i) {
    surface.triangles.insert(surface.triangles.begin() + at, {whole[i], whole[(i + 1) % 3], centre});
    surface.input_triangle.insert(surface.input_triangle.begin() + at, static_cast<Index>(t));
  }
  return surface;
}

TEST(Order, OfAnUncutSurfaceKeepsTheInputsNumbers) {
  TriangleSoup soup = cube({1, 2, 3}, 2);
  soup.triangles.insert(soup.triangles.begin() + 4, {5, 5, 6});  // degenerate, so dropped
  const tetfmt::Mesh mesh = order(prepared(snap(soup)), snap(soup));
  expect_valid(mesh);
  EXPECT_EQ(kinds(mesh), (std::vector{tetfmt::kRegions, tetfmt::kSurfaceBounds}));
  ASSERT_EQ(mesh.triangles.size(), 13u);
  EXPECT_EQ(mesh.sides.size(), 24u);
  for (std::size_t t = 0; t < 13; ++t) {
    EXPECT_EQ(mesh.triangles[t].dropped(), t == 4);
    if (t == 4) continue;
    EXPECT_EQ(places(mesh, mesh.triangles[t].vertices), places(soup, t));
  }
}

TEST(Order, WithoutRegionsWritesNone) {
  const CleanSurface surface = snap(ball(4));
  const tetfmt::Mesh mesh = order(fill(surface), surface);
  expect_valid(mesh);
  EXPECT_EQ(kinds(mesh), (std::vector{tetfmt::kSurfaceBounds}));
}

TEST(Order, OfACutSurfaceSaysWhatThePiecesAreOf) {
  TriangleSoup soup = cube({1, 2, 3}, 2);
  soup.triangles.insert(soup.triangles.begin() + 4, {5, 5, 6});
  const CleanSurface surface = with_cut(soup, 6);
  const tetfmt::Mesh mesh = order(prepared(surface), surface);
  expect_valid(mesh);
  EXPECT_EQ(kinds(mesh), (std::vector{tetfmt::kRegions, tetfmt::kSurfaceBounds, tetfmt::kOrigins,
                                      tetfmt::kInputTriangles}));
  EXPECT_EQ(section<Index>(mesh, tetfmt::kOrigins),
            (std::vector<Index>{0, 1, 2, 3, 5, 6, 6, 6, 7, 8, 9, 10, 11, 12}));
  const auto input = section<Corners>(mesh, tetfmt::kInputTriangles);
  ASSERT_EQ(input.size(), 13u);
  for (std::size_t t = 0; t < 13; ++t) {
    if (t == 4) {
      EXPECT_EQ(input[t], kNoCorners);
    } else {
      EXPECT_EQ(places(mesh, input[t]), places(soup, t));
    }
  }
  ASSERT_EQ(mesh.triangles.size(), 14u);
  for (std::size_t t = 0; t < 14; ++t) EXPECT_FALSE(mesh.triangles[t].dropped());
  EXPECT_EQ(mesh.sides.size(), 28u);
}

TEST(Order, OfLeftOutSpaceDropsWhatHasNoFaceAnyMore) {
  const TriangleSoup soup = join(cube({0, 0, 0}, 8), cube({2, 2, 2}, 4));  // the second one is kept
  const CleanSurface surface = with_cut(soup, 3);                          // of the first
  const tetfmt::Mesh mesh = order(prepared(surface, {{4, 4, 4}}), surface);
  expect_valid(mesh);
  ASSERT_EQ(mesh.triangles.size(), 26u);
  for (std::size_t t = 0; t < 26; ++t) EXPECT_EQ(mesh.triangles[t].dropped(), t < 14);
  const auto input = section<Corners>(mesh, tetfmt::kInputTriangles);
  ASSERT_EQ(input.size(), 24u);
  for (std::size_t t = 0; t < 24; ++t) {
    if (t < 12) {
      EXPECT_EQ(input[t], kNoCorners);
    } else {
      EXPECT_EQ(places(mesh, input[t]), places(soup, t));
    }
  }
  ASSERT_EQ(mesh.sides.size(), 24u);
  for (std::size_t side = 0; side < 24; side += 2) {
    EXPECT_EQ(mesh.sides[side].tet, kNone) << "the triangles point outward, where nothing is left";
    EXPECT_NE(mesh.sides[side + 1].tet, kNone);
    EXPECT_EQ(mesh.sides[side].triangle, mesh.sides[side + 1].triangle);
  }
  for (const auto& tet : mesh.tets)
    for (const tetfmt::Ref ref : tet.neighbors) EXPECT_NE(ref, tetfmt::kHull);
  EXPECT_EQ(section<tetfmt::Region>(mesh, tetfmt::kRegions).size(), 1u);
}

TEST(Order, GivesSidesTheirMaterial) {
  const TriangleSoup soup = cube({0, 0, 0}, 1);
  std::vector<Index> material(12);
  for (Index t = 0; t < 12; ++t) material[t] = t % 5;
  const CleanSurface whole = snap(soup), cut = with_cut(soup, 7);
  for (const CleanSurface* surface : {&whole, &cut}) {
    const tetfmt::Mesh mesh = order(prepared(*surface), *surface, material);
    const auto origins = section<Index>(mesh, tetfmt::kOrigins);
    for (const tetfmt::Side& side : mesh.sides)
      EXPECT_EQ(side.material, (origins.empty() ? side.triangle : origins[side.triangle]) % 5);
  }
  for (const tetfmt::Side& side : order(prepared(whole), whole).sides) EXPECT_EQ(side.material, 0u);
}

TEST(Order, HasASourceForEveryPart) {
  // The box's middle is between the cubes, at x = 4: the second one is nearest to it.
  const TriangleSoup soup =
      join(join(cube({0, 0, 0}, 1), cube({5, 0, 0}, 1)), join(cube({7, 0, 0}, 1), cube({6, 0, 0}, 1)));
  const CleanSurface surface = snap(soup);
  const auto region_of = [](const tetfmt::Mesh& mesh, Index tet) {
    for (const auto& region : section<tetfmt::Region>(mesh, tetfmt::kRegions))
      if (tet >= region.first_tet && tet - region.first_tet < region.tet_count) return region;
    return tetfmt::Region{};
  };

  const tetfmt::Mesh whole = order(prepared(surface), surface);
  EXPECT_EQ(whole.sources.size(), 1u) << "walks cross surfaces";
  EXPECT_EQ(region_of(whole, whole.sources[0]).id, 0u);

  // Three of the cubes touch each other, the first one is alone.
  const tetfmt::Mesh inner =
      order(prepared(surface, {{0.5, 0.5, 0.5}, {5.5, 0.5, 0.5}, {6.5, 0.5, 0.5}, {7.5, 0.5, 0.5}}), surface);
  expect_valid(inner);
  ASSERT_EQ(inner.sources.size(), 2u);
  EXPECT_EQ(inner.origin[0] + region_of(inner, inner.sources[0]).lower.x, 5);
  const tetfmt::Region alone = region_of(inner, inner.sources[1]);
  EXPECT_EQ(inner.origin[0] + alone.lower.x, 0);
  EXPECT_EQ(inner.sources[1], alone.first_tet);

  // Without the cube between them, the two at the ends are parts of their own.
  const tetfmt::Mesh ends =
      order(prepared(surface, {{0.5, 0.5, 0.5}, {5.5, 0.5, 0.5}, {7.5, 0.5, 0.5}}), surface);
  expect_valid(ends);
  ASSERT_EQ(ends.sources.size(), 3u);
  EXPECT_EQ(ends.origin[0] + region_of(ends, ends.sources[0]).lower.x, 5);
  EXPECT_LT(ends.sources[1], ends.sources[2]);
}

TEST(Order, IsTheSameForAnyNumberOfThreads) {
  const CleanSurface surface = snap(join(ball(12), moved(ball(11), {2.5, 0.25, 0})));
  const TetMesh filled = fill(surface);
  const auto bytes = [&](int threads) {
    std::vector<std::byte> result;
    tetprep::with_threads(threads, [&] {
      TetMesh mesh = filled;
      sort_tets(mesh);
      find_regions(mesh);
      group_by_region(mesh);
      result = tetfmt::encode(order(mesh, surface), tetfmt::Layout::tet20);
    });
    return result;
  };
  EXPECT_EQ(bytes(1), bytes(3));
}

}  // namespace
}  // namespace tetprep_test
