// SPDX-License-Identifier: AGPL-3.0-or-later
// Every crossing of a ray, in order, with the regions between: parity, lengths that add up, and the same as
// going on from hit to hit.
#include <gtest/gtest.h>

#include <random>

#include "support/box_scene.hpp"

namespace tetfmt_test {
namespace {

using namespace tetfmt;

/// Where the line of a ray of whole numbers is strictly inside the box: exact.
struct Chord {
  Fraction first{-1000000, 1}, last{1000000, 1};
  bool proper = true;  ///< of some length
};
Chord chord_of(const BoxScene& scene, const std::array<int, 3>& origin, const std::array<int, 3>& direction) {
  Chord chord;
  for (std::size_t k = 0; k < 3; ++k) {
    const int d = direction[k];
    if (d == 0) {
      chord.proper &= scene.low < origin[k] && origin[k] < scene.high;
      continue;
    }
    const Fraction a = Fraction::of((d > 0 ? scene.low : scene.high) - origin[k], d),
                   b = Fraction::of((d > 0 ? scene.high : scene.low) - origin[k], d);
    if (chord.first < a) chord.first = a;
    if (b < chord.last) chord.last = b;
  }
  chord.proper &= chord.first < chord.last;
  return chord;
}

class AllHitsOn : public ::testing::TestWithParam<bool> {
 protected:
  int between(int low, int high) {
    return low + static_cast<int>(random_() % static_cast<unsigned>(high - low + 1));
  }
  std::array<int, 3> point(int low, int high) {
    return {between(low, high), between(low, high), between(low, high)};
  }

  std::mt19937 random_{1};
  const BoxScene scene_{6, GetParam()};
};
INSTANTIATE_TEST_SUITE_P(, AllHitsOn, ::testing::Bool(),
                         [](const auto& given) { return given.param ? "Sheared" : "Straight"; });

/// What must hold of any list of hits in a file with regions: in order, each beyond the one before, and
/// in the region that the one before led to.
void expect_connected(const Scene& scene, const std::vector<Hit>& hits) {
  for (std::size_t i = 0; i < hits.size(); ++i) {
    const Hit& hit = hits[i];
    ASSERT_EQ(hit.outcome, Outcome::hit);
    ASSERT_EQ(hit.back, hit.side % 2 == 1);
    ASSERT_EQ(scene.mesh.sides[hit.side].tet, hit.tet);
    ASSERT_EQ(scene.mesh.sides[twin(hit.side)].tet, hit.neighbor);
    if (i == 0) continue;
    ASSERT_LE(hits[i - 1].t, hit.t);
    ASSERT_LT(hits[i - 1].steps, hit.steps);
    ASSERT_EQ(scene.view20.region_of(hits[i - 1].neighbor), scene.view20.region_of(hit.tet));
  }
}

// From outside, a closed surface is crossed an even number of times: in, out, in, out. Most of these rays
// meet edges and vertices, or run in the planes of walls.
TEST_P(AllHitsOn, ClosedSurfacesAreCrossedInPairs) {
  int hits = 0;
  for (int i = 0; i < 10000; ++i) {
    std::array<int, 3> o = point(-3, 9);
    const std::array<int, 3> d = point(-3, 3);
    if (d == std::array<int, 3>{}) continue;
    const bool outside = std::min({o[0], o[1], o[2]}) < 1 || std::max({o[0], o[1], o[2]}) > 5;
    if (!outside) continue;
    const auto all = scene_.all_hits(scene_.locate(scene_.to_scene(o)), scene_.to_scene(d));
    ASSERT_EQ(all.outcome, Outcome::miss);
    expect_connected(scene_, all.hits);
    ASSERT_EQ(all.hits.size() % 2, 0u);
    for (std::size_t k = 0; k < all.hits.size(); ++k) {
      ASSERT_EQ(all.hits[k].back, k % 2 == 1);
      ASSERT_EQ(scene_.view20.region_of(all.hits[k].neighbor), k % 2 == 0 ? 1u : 0u);
    }
    hits += static_cast<int>(all.hits.size());
  }
  EXPECT_GT(hits, 500);
}

// Lengths of the stretches in the box add up to the exact chord: nothing is lost where it ties.
TEST_P(AllHitsOn, PathLengthsAddUpToTheChord) {
  int chords = 0, from_inside = 0;
  for (int i = 0; i < 10000; ++i) {
    const std::array<int, 3> o = point(-2, 8), d = point(-3, 3);
    if (d == std::array<int, 3>{}) continue;
    const Location from = scene_.locate(scene_.to_scene(o));
    const auto all = scene_.all_hits(from, scene_.to_scene(d));
    ASSERT_EQ(all.outcome, Outcome::miss);
    const Chord chord = chord_of(scene_, o, d);
    double in_box = 0, since = 0;
    bool inside = from.state == Location::State::inside && scene_.view20.region_of(from.cell.tet) == 1;
    for (const Hit& hit : all.hits) {
      ASSERT_EQ(scene_.view20.region_of(hit.tet), inside ? 1u : 0u);
      if (inside) in_box += hit.t - since;
      since = hit.t;
      inside = scene_.view20.region_of(hit.neighbor) == 1;
    }
    ASSERT_FALSE(inside);
    const double last = chord.last.value(), first = std::max(chord.first.value(), 0.0);
    if (chord.proper && last > 0) {
      ASSERT_NEAR(in_box, last - first, 4e-15 * last);
      ++chords;
      from_inside += chord.first.value() < 0;
    } else {
      // Along a wall or through an edge: the tie rule says whether inside or outside. Never a part of it.
      const bool all_or_nothing =
          in_box <= 4e-15 * std::abs(last) || std::abs(in_box - (last - first)) <= 4e-15 * std::abs(last);
      ASSERT_TRUE(all_or_nothing || GetParam()) << in_box;  // a sheared wall's faces may tilt either way
      ASSERT_LE(in_box, std::max(0.0, last - first) + 4e-15 * std::abs(last));
    }
  }
  EXPECT_GT(chords, 400);
  EXPECT_GT(from_inside, 100);
}

// In general position, going on from the far side of each hit meets the same faces, at the t that are left.
TEST_P(AllHitsOn, IsFirstHitFromFarSideToFarSide) {
  std::uniform_real_distribution<float> any(-2, 8);
  int crossings = 0;
  for (int i = 0; i < 4000; ++i) {
    const auto some = [&] { return scene_.near({any(random_), any(random_), any(random_)}); };
    const Vec3f o = some(), q = some(), d = {q.x - o.x, q.y - o.y, q.z - o.z};
    const auto all = scene_.all_hits(scene_.locate(o), d);
    expect_connected(scene_, all.hits);
    Location from = scene_.locate(o);
    double t = 0;
    for (const Hit& expected : all.hits) {
      const Hit hit = scene_.first_hit(from, d);
      ASSERT_EQ(hit.outcome, Outcome::hit);
      ASSERT_EQ(hit.triangle, expected.triangle);
      ASSERT_EQ(hit.back, expected.back);
      ASSERT_NEAR(t + hit.t, expected.t, 1e-5);
      t += hit.t;
      from = scene_.side_of(hit, true);
      ++crossings;
    }
    ASSERT_EQ(scene_.first_hit(from, d).outcome, Outcome::miss);
  }
  EXPECT_GT(crossings, 500);
}

// The first of all hits is first_hit's, in every field; and lists are added to, not replaced.
TEST_P(AllHitsOn, BeginsWithTheFirstHitAndKeepsWhatIsThere) {
  for (int i = 0; i < 4000; ++i) {
    const std::array<int, 3> o = point(-1, 7), d = point(-2, 2);
    if (d == std::array<int, 3>{}) continue;
    const Location from = scene_.locate(scene_.to_scene(o));
    const Hit first = scene_.first_hit(from, scene_.to_scene(d));
    std::vector<Hit> hits(3);
    hits[2].triangle = 77;
    const Outcome outcome = all_hits(scene_.trusted16, from, scene_.to_scene(d), hits);
    ASSERT_EQ(outcome, Outcome::miss);
    ASSERT_GE(hits.size(), 3u);
    ASSERT_EQ(hits[2].triangle, 77u);
    ASSERT_EQ(hits.size() > 3, first.outcome == Outcome::hit);
    if (hits.size() > 3) {
      ASSERT_TRUE(same(hits[3], first));
    }
  }
}

// Open surfaces close nothing off: both sides are in one region, and rays pass through.
TEST_P(AllHitsOn, OpenSurfacesAreCrossedOnce) {
  LatticeOptions options;
  options.walls = 0b000011;  // x = low and x = high only
  const BoxScene open(6, GetParam(), options, {0});
  for (int i = 0; i < 2000; ++i) {
    const std::array<int, 3> o = {-1, between(1, 5), between(1, 5)}, d = {1, 0, 0};
    const auto all = open.all_hits(open.locate(open.to_scene(o)), open.to_scene(d));
    ASSERT_EQ(all.outcome, Outcome::miss);
    expect_connected(open, all.hits);
    const auto inner = [](int x) { return x > 1 && x < 5; };
    if (!inner(o[1]) || !inner(o[2])) continue;  // along an edge of the surface
    ASSERT_EQ(all.hits.size(), 2u);
    ASSERT_FALSE(all.hits[0].back);
    ASSERT_TRUE(all.hits[1].back);
    ASSERT_EQ(all.hits[0].t, 2);
    ASSERT_EQ(all.hits[1].t, 6);
    ASSERT_EQ(open.view20.region_of(all.hits[0].neighbor), 0u);
  }
}

// Without the inside of the box a list ends at the wall, and says so; unless the interval ends before.
TEST_P(AllHitsOn, EndsWhereTheFileLeavesSpaceOut) {
  const BoxScene partial(6, GetParam(), {}, {0});
  int absent = 0;
  for (int i = 0; i < 5000; ++i) {
    const std::array<int, 3> o = point(-3, 9), d = point(-2, 2);
    const bool outside = std::min({o[0], o[1], o[2]}) < 1 || std::max({o[0], o[1], o[2]}) > 5;
    if (!outside || d == std::array<int, 3>{}) continue;
    const Location from = partial.locate(partial.to_scene(o));
    const auto all = partial.all_hits(from, partial.to_scene(d)),
               whole = scene_.all_hits(scene_.locate(scene_.to_scene(o)), scene_.to_scene(d));
    if (whole.hits.empty()) {
      ASSERT_EQ(all.outcome, Outcome::miss);
      ASSERT_TRUE(all.hits.empty());
      continue;
    }
    ++absent;
    ASSERT_EQ(all.outcome, Outcome::absent);
    ASSERT_EQ(all.hits.size(), 1u);
    ASSERT_EQ(all.hits[0].triangle, whole.hits[0].triangle);
    ASSERT_EQ(all.hits[0].t, whole.hits[0].t);
    ASSERT_EQ(all.hits[0].neighbor, kNone);
    const double t = all.hits[0].t, before = std::nextafter(t, 0);
    if (t > 0 && before >= 0) {
      const auto early = partial.all_hits(from, partial.to_scene(d), {0, before - 1e-9});
      ASSERT_EQ(early.outcome, Outcome::miss);
      ASSERT_TRUE(early.hits.empty());
    }
    const double beyond = t + 1e-3;
    if (whole.hits[1].t > beyond) {
      // At t_min the ray is in left-out space.
      ASSERT_EQ(partial.first_hit(from, partial.to_scene(d), {beyond, 1e9}).outcome, Outcome::absent);
      ASSERT_EQ(partial.all_hits(from, partial.to_scene(d), {beyond, 1e9}).outcome, Outcome::absent);
    }
  }
  EXPECT_GT(absent, 100);
}

TEST(RegionOf, EveryTetrahedronHasOneWhereTheFileTells) {
  const Mesh lattice = lattice_mesh(5);
  for (const std::vector<Index>& kept : {std::vector<Index>{0, 1}, {0}, {1}}) {
    const Scene scene(with_regions(lattice, kept));
    const auto& view = scene.view20;
    ASSERT_EQ(view.regions().size(), kept.size());
    const auto expected = regions_of(scene.mesh);  // numbered from 0 again
    for (Index tet = 0; tet < view.tet_count(); ++tet) {
      ASSERT_EQ(view.region_of(tet), kept.size() == 1 ? 0 : expected[tet]);
      ASSERT_EQ(scene.view16.region_of(tet), view.region_of(tet));
    }
    for (const Index tet : {view.tet_count(), Index{0x7FFFFFFF}, kNone})
      EXPECT_EQ(view.region_of(tet), kNone);
  }
  const Scene untold(lattice);
  EXPECT_EQ(untold.view20.region_of(0), kNone);
  EXPECT_EQ(untold.view20.region_of(kNone), kNone);
}

}  // namespace
}  // namespace tetfmt_test
