// SPDX-License-Identifier: AGPL-3.0-or-later
// Rays walked together against the same rays walked alone, for every kind of processor that this one can
// stand for.
#include "tile.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

#include "support/lattice_mesh.hpp"
#include "support/region_mesh.hpp"
#include "support/same.hpp"
#include "tetfmt/encode.hpp"
#include "tetfmt/traverse.hpp"

namespace {

using namespace tetfmt;
using tetfmt::detail::kTileRays;
using tetfmt::detail::tile_targets;

struct Scene {
  explicit Scene(const Mesh& mesh, Layout layout)
      : bytes(encode(mesh, layout)), view(*FileView::open(bytes)), trusted(*TrustedView::validated(bytes)) {}
  std::vector<std::byte> bytes;
  FileView view;
  TrustedView trusted;
};

/// All fields but steps.
void expect_same(const Hit& tile, Hit alone) {
  ASSERT_EQ(tile.steps, 0u);
  alone.steps = 0;
  ASSERT_TRUE(tetfmt_test::same(tile, alone)) << "sides " << tile.side << " and " << alone.side;
}

void expect_all_same(const Scene& scene, const Location& from, const std::vector<Vec3f>& directions) {
  Hit used;  // what an earlier tile may have left behind
  used.outcome = Outcome::hit;
  used.side = 7;
  used.steps = 9;
  for (const auto& target : tile_targets()) {
    for (const auto& tracers : {target.checked, target.unchecked}) {
      std::vector<Hit> hits(directions.size(), used);
      tracers.first_hits(scene.view, from, directions, hits);
      for (std::size_t i = 0; i < directions.size(); ++i) {
        SCOPED_TRACE(target.name);
        expect_same(hits[i], first_hit(scene.trusted, from, directions[i]));
        if (testing::Test::HasFatalFailure()) return;
      }
    }
  }
}

/// Rays of integer directions from integer, half and odd places: they meet edges and vertices everywhere.
TEST(Tile, EqualsFirstHitOnLattices) {
  std::mt19937 random(3);
  const auto below = [&](int n) { return static_cast<int>(random() % static_cast<unsigned>(n)); };
  int hits = 0;
  for (const Layout layout : {Layout::tet20, Layout::tet16}) {
    const Scene scene(tetfmt_test::lattice_mesh(5), layout);
    for (int i = 0; i < 120; ++i) {
      const auto one = [&] {
        return static_cast<float>(below(33) - 8) / (i % 3 == 0 ? 4.0f : i % 3 == 1 ? 2.0f : 1.0f);
      };
      const Location from = locate(scene.view, {one(), one(), one()});
      std::vector<Vec3f> directions;
      const auto count = static_cast<std::size_t>(i % 4 == 0 ? kTileRays : 1 + random() % kTileRays);
      while (directions.size() < count) {
        const auto step = [&] { return static_cast<float>(below(9) - 4); };
        const Vec3f d = {step(), step(), step()};
        if (d != Vec3f{}) directions.push_back(d);
      }
      expect_all_same(scene, from, directions);
      if (HasFatalFailure()) return;
      for (const Vec3f& d : directions) hits += first_hit(scene.view, from, d).outcome == Outcome::hit;
    }
  }
  EXPECT_GT(hits, 1500);
}

/// A camera's tiles, where whole blocks are on one side of most edges.
TEST(Tile, EqualsFirstHitOnPictures) {
  const Scene scene(tetfmt_test::lattice_mesh(6), Layout::tet20);
  for (const Vec3f eye : {Vec3f{3, 3, -9}, {3.25f, 2.5f, 0.5f}, {3, 3, 3}, {-4000, 300, 20}}) {
    const Location from = locate(scene.view, eye);
    for (const float width : {1.0f, 0.05f, 1e-4f, 1e-7f}) {
      std::vector<Vec3f> directions;
      for (std::size_t i = 0; i < kTileRays; ++i) {
        const std::size_t block = i / 16, pixel = i % 16;
        const auto x = static_cast<float>(block % 4 * 4 + pixel % 4),
                   y = static_cast<float>(block / 4 * 4 + pixel / 4);
        directions.push_back({3.1f - eye.x + width * (x - 8), 2.9f - eye.y + width * (y - 8), 3.05f - eye.z});
      }
      expect_all_same(scene, from, directions);
      if (HasFatalFailure()) return;
    }
  }
}

/// Rays that miss the box around the surface are not walked, and no other ray is taken for one of them: also
/// not those that run along its faces and edges. The box of the lattice is its inner one, from 1 to n - 1.
TEST(Tile, MissesByTheSurfacesBounds) {
  const Mesh mesh = tetfmt_test::lattice_mesh(6);
  const Scene plain(mesh, Layout::tet20), bounded(tetfmt_test::with_surface_bounds(mesh), Layout::tet20);
  ASSERT_EQ(bounded.view.surface_bounds().lower, (Vec3f{1, 1, 1}));
  std::mt19937 random(9);
  const auto below = [&](int n) { return static_cast<int>(random() % static_cast<unsigned>(n)); };
  int hits = 0, misses = 0;
  for (int i = 0; i < 60; ++i) {
    const auto one = [&] { return static_cast<float>(below(41) - 14) / 2; };
    const Vec3f eye = {one(), one(), one()};
    const Location from = locate(plain.view, eye);
    std::vector<Vec3f> directions;
    while (directions.size() < kTileRays) {
      const auto at = [&] {
        return static_cast<float>(i % 3 == 0 ? below(7) : below(13)) / (i % 3 == 0 ? 1 : 2);
      };
      const Vec3f d = {at() - eye.x, at() - eye.y, at() - eye.z};
      if (d != Vec3f{}) directions.push_back(d);
    }
    for (const auto& kind : tile_targets()) {
      std::vector<Hit> together(directions.size());
      kind.unchecked.first_hits(bounded.view, from, directions, together);
      for (std::size_t k = 0; k < directions.size(); ++k) {
        SCOPED_TRACE(kind.name);
        expect_same(together[k], first_hit(plain.trusted, from, directions[k]));
        if (HasFatalFailure()) return;
        ++(together[k].outcome == Outcome::hit ? hits : misses);
      }
    }
    for (const Vec3f& d : directions)
      ASSERT_EQ(first_hit(bounded.trusted, from, d).side, first_hit(plain.trusted, from, d).side);
  }
  EXPECT_GT(hits, 1000);
  EXPECT_GT(misses, 1000);
  // One that passes beside the box, through the mesh, costs nothing.
  const Location from = locate(bounded.view, {0.5f, 0.5f, -3});
  std::vector<Hit> together(kTileRays);
  EXPECT_EQ(first_hits(bounded.trusted, from, std::vector<Vec3f>(kTileRays, Vec3f{0, 0, 1}), together), 0u);
  EXPECT_GT(first_hits(plain.trusted, from, std::vector<Vec3f>(kTileRays, Vec3f{0, 0, 1}), together), 0u);
}

TEST(Tile, StartsOnBothSidesOfFaces) {
  const Scene scene(tetfmt_test::lattice_mesh(4), Layout::tet16);
  std::mt19937 random(4);
  std::uniform_real_distribution<float> any(-1, 1);
  for (int i = 0; i < 40; ++i) {
    const Hit hit =
        first_hit(scene.view, locate(scene.view, {-1, 2 + any(random) / 2, 2 + any(random) / 2}), {1, 0, 0});
    ASSERT_EQ(hit.outcome, Outcome::hit);
    std::vector<Vec3f> directions;
    for (std::size_t k = 0; k < kTileRays; ++k) {
      Vec3f d = {any(random), any(random), any(random)};
      if (k % 4 == 0) d.x = 0;  // in the face's plane
      directions.push_back(d);
    }
    expect_all_same(scene, near_side(scene.view, hit), directions);
    expect_all_same(scene, far_side(scene.view, hit), directions);
    if (HasFatalFailure()) return;
  }
}

/// first_hits takes any number of any rays; those that no tile can take go alone.
TEST(FirstHits, TakesWhatFirstHitTakes) {
  const Scene scene(tetfmt_test::lattice_mesh(5), Layout::tet20);
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  std::mt19937 random(5);
  std::uniform_real_distribution<float> any(-1, 1);
  const Location places[] = {locate(scene.view, {2.5f, 2.5f, 2.5f}), locate(scene.view, {9, 1, 2}),
                             locate(scene.view, {kInfinity, 1, 2}), Location{}};
  for (const std::size_t count :
       {std::size_t{0}, std::size_t{1}, kTileRays - 1, kTileRays + 1, 3 * kTileRays}) {
    std::vector<Vec3f> directions;
    for (std::size_t i = 0; i < count; ++i) directions.push_back({any(random), any(random), any(random)});
    if (count == kTileRays + 1) directions[3] = {0, 0, 0};
    if (count == 3 * kTileRays) {
      directions[300] = {std::numeric_limits<float>::quiet_NaN(), 1, 0};
      directions[kTileRays + 600] = {kInfinity, 1, 0};
      directions[kTileRays + 601] = {0x1p-140f, -0x1p-149f, 0};
      directions[kTileRays + 900] = {3e38f, -3e38f, 1};
    }
    for (const Location& from : places) {
      std::vector<Hit> checked(count), trusted(count);
      first_hits(scene.view, from, directions, checked);
      first_hits(scene.trusted, from, directions, trusted);
      for (std::size_t i = 0; i < count; ++i) {
        const Hit alone = first_hit(scene.view, from, directions[i]);
        expect_same(checked[i], alone);
        expect_same(trusted[i], alone);
        if (HasFatalFailure()) return;
      }
    }
  }
}

/// Places of every kind: in and around the mesh, on its vertices and edges, on both sides of faces.
std::vector<Location> some_places(const Scene& scene, std::size_t count, std::mt19937& random) {
  std::vector<Location> places;
  while (places.size() < count) {
    const auto one = [&] { return static_cast<float>(random() % 29) / 4 - 1; };
    const Vec3f point = {one(), one(), one()};
    const Location place = locate(scene.view, point);
    places.push_back(place);
    if (random() % 2 == 0) continue;
    const Hit hit = first_hit(scene.view, place, {one() - 2.5f, one() - 2.5f, one() - 2.5f});
    if (hit.outcome != Outcome::hit) continue;
    places.push_back(near_side(scene.view, hit));
    places.push_back(far_side(scene.view, hit));
  }
  places.resize(count);
  return places;
}

TEST(Tile, EqualsOcclusionBetweenPlaces) {
  std::mt19937 random(6);
  int hidden = 0, seen = 0;
  for (const Layout layout : {Layout::tet20, Layout::tet16}) {
    const Scene scene(tetfmt_test::lattice_mesh(5), layout);
    for (int i = 0; i < 30; ++i) {
      const std::size_t count = i % 3 == 0 ? kTileRays : 1 + random() % kTileRays;
      std::vector<Location> targets = some_places(scene, count, random);
      const Location from = some_places(scene, 3, random).back();
      if (i % 4 == 0) targets[count / 2] = from;
      if (i % 4 == 1) targets[count / 2] = Location{};  // corrupt
      if (i % 4 == 2) targets[count / 2].state = Location::State::absent;
      if (i % 4 == 3) targets[0].position[1] = std::numeric_limits<double>::infinity();
      std::vector<Outcome> alone;
      for (const Location& target : targets) {
        alone.push_back(occlusion(scene.trusted, from, target));
        hidden += alone.back() == Outcome::hit;
        seen += alone.back() == Outcome::miss;
      }
      for (const auto& kind : tile_targets()) {
        for (const auto& tracers : {kind.checked, kind.unchecked}) {
          std::vector<Outcome> together(count, Outcome::absent);
          tracers.occlusions(scene.view, from, targets, together);
          ASSERT_EQ(together, alone) << kind.name << ", round " << i;
        }
      }
    }
  }
  EXPECT_GT(hidden, 5000);
  EXPECT_GT(seen, 5000);
}

/// A light and what is seen of a wall, where whole blocks take one way.
TEST(Tile, EqualsOcclusionFromALight) {
  const Scene scene(tetfmt_test::lattice_mesh(6), Layout::tet20);
  const Location eye = locate(scene.view, {-9, 2.7f, 3.1f});
  std::vector<Location> targets;
  for (std::size_t i = 0; i < kTileRays; ++i) {
    const auto x = static_cast<float>(i % 32), y = static_cast<float>(i / 32);
    const Hit hit = first_hit(scene.view, eye, {10, (x - 16) / 6, (y - 16) / 6});
    if (hit.outcome == Outcome::hit) targets.push_back(near_side(scene.view, hit));
  }
  ASSERT_GT(targets.size(), kTileRays / 2);
  for (const Vec3f light : {Vec3f{-5, 7, 3}, {0.5f, 0.5f, 0.5f}, {0.25f, 3, 3}, {3, 3, 3}, {1, 1, 1}}) {
    const Location from = locate(scene.view, light);
    std::vector<Outcome> together(targets.size());
    EXPECT_GT(occlusions(scene.trusted, from, targets, together), 0u);
    for (std::size_t i = 0; i < targets.size(); ++i)
      ASSERT_EQ(together[i], occlusion(scene.trusted, from, targets[i])) << i;
  }
}

TEST(Occlusions, TakeWhatOcclusionTakes) {
  const Scene scene(tetfmt_test::lattice_mesh(4), Layout::tet16);
  std::mt19937 random(8);
  std::vector<Location> sources = some_places(scene, 4, random);
  sources.push_back({});
  sources.push_back(sources[0]);
  sources.back().state = Location::State::absent;
  sources.push_back(sources[0]);
  sources.back().position[2] = std::numeric_limits<double>::quiet_NaN();
  for (const std::size_t count : {std::size_t{0}, std::size_t{5}, kTileRays + 3}) {
    const std::vector<Location> targets = some_places(scene, count, random);
    for (const Location& from : sources) {
      std::vector<Outcome> checked(count), trusted(count);
      occlusions(scene.view, from, targets, checked);
      occlusions(scene.trusted, from, targets, trusted);
      for (std::size_t i = 0; i < count; ++i) ASSERT_EQ(checked[i], occlusion(scene.view, from, targets[i]));
      ASSERT_EQ(checked, trusted);
    }
  }
}

TEST(FirstHits, CountsSharedVisitsOnce) {
  const Scene scene(tetfmt_test::lattice_mesh(6), Layout::tet20);
  const Location from = locate(scene.view, {3, 3, -30});
  const std::vector<Vec3f> directions(kTileRays, Vec3f{0.01f, 0.013f, 1});
  std::vector<Hit> hits(kTileRays);
  EXPECT_EQ(first_hits(scene.trusted, from, directions, hits),
            first_hit(scene.trusted, from, directions[0]).steps);
}

}  // namespace
