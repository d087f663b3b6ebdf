// SPDX-License-Identifier: AGPL-3.0-or-later
// Bounded rays: ends exactly on faces, one step of a double beside them, and beyond what makes sense.
#include <gtest/gtest.h>

#include <cfloat>
#include <cmath>
#include <limits>
#include <random>
#include <set>

#include "support/box_scene.hpp"

namespace tetfmt_test {
namespace {

using namespace tetfmt;

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr double kSubnormal = std::numeric_limits<double>::denorm_min();

double before(double t) {
  return std::nextafter(t, -kInfinity);
}
double after(double t) {
  return std::nextafter(t, kInfinity);
}

class IntervalOn : public ::testing::TestWithParam<bool> {
 protected:
  /// first_hit and occlusion agree; the hit's t lies in the interval.
  Hit hit_in(const Location& from, const Vec3f& direction, const Interval& interval) const {
    const Hit hit = scene_.first_hit(from, direction, interval);
    EXPECT_EQ(scene_.occlusion(from, direction, interval), hit.outcome);
    if (hit.outcome == Outcome::hit) {
      EXPECT_GE(hit.t, interval.t_min);
      EXPECT_GE(hit.t, 0);
      EXPECT_LE(hit.t, interval.t_max);
    }
    return hit;
  }
  const BoxScene scene_{6, GetParam()};
};
INSTANTIATE_TEST_SUITE_P(, IntervalOn, ::testing::Bool(),
                         [](const auto& given) { return given.param ? "Sheared" : "Straight"; });

// Through the walls x = 1 and x = 5 at t = 2 and t = 6, off all edges.
TEST_P(IntervalOn, OneStepBesideAFaceIsBesideIt) {
  const Location from = scene_.locate(scene_.fixed_to_scene({-kOne, 9 * kOne / 4, 7 * kOne / 4}));
  const Vec3f d = scene_.to_scene({1, 0, 0});
  const auto t_of = [&](double t_min, double t_max) {
    const Hit hit = hit_in(from, d, {t_min, t_max});
    return hit.outcome == Outcome::hit ? hit.t : -1;
  };
  EXPECT_EQ(t_of(0, kInfinity), 2);
  EXPECT_EQ(t_of(before(2), kInfinity), 2);
  EXPECT_EQ(t_of(after(2), kInfinity), 6);
  EXPECT_EQ(t_of(before(6), kInfinity), 6);
  EXPECT_EQ(t_of(after(6), kInfinity), -1);
  EXPECT_EQ(t_of(0, before(2)), -1);
  EXPECT_EQ(t_of(0, after(2)), 2);
  EXPECT_EQ(t_of(after(2), before(6)), -1);
  EXPECT_EQ(t_of(after(2), after(6)), 6);
  EXPECT_EQ(t_of(before(2), after(2)), 2);
  EXPECT_EQ(t_of(before(6), after(6)), 6);
  EXPECT_EQ(t_of(3, 5), -1);
}

// Exactly at the end: in [0, 2] or in [2, infinity), and never in both or none.
TEST_P(IntervalOn, AFaceAtAnEndLiesOnOneSideOfIt) {
  std::mt19937 random(1);
  for (int i = 0; i < 600; ++i) {
    // Off the walls' edges, as often as not through edges and vertices of the faces that they are made of.
    const auto quarter = [&] { return (5 + static_cast<std::int64_t>(random() % 15)) * (kOne / 4); };
    const std::size_t axis = random() % 3;
    Fixed origin = {quarter(), quarter(), quarter()};
    std::array<int, 3> d{};
    const bool up = random() % 2 == 0;
    origin[axis] = (up ? -1 : 7) * kOne;
    d[axis] = up ? 1 : -1;
    const Location from = scene_.locate(scene_.fixed_to_scene(origin));
    for (const double t : {2.0, 6.0}) {
      const Hit early = hit_in(from, scene_.to_scene(d), {before(t), t}),
                late = hit_in(from, scene_.to_scene(d), {t, after(t)});
      ASSERT_NE(early.outcome == Outcome::hit, late.outcome == Outcome::hit);
      ASSERT_EQ(early.outcome == Outcome::hit ? early.t : late.t, t);
      const Hit both = hit_in(from, scene_.to_scene(d), {before(t), after(t)});
      ASSERT_TRUE(both.side == early.side || both.side == late.side);
      ASSERT_EQ(hit_in(from, scene_.to_scene(d), {t, t}).outcome, Outcome::miss);  // an infinitesimal away
    }
  }
}

// Where no wall is tilted, the tie rule says which: every vertex moves towards higher coordinates, each by
// another infinitesimal, and so do walls. A ray upwards meets its wall just after t, one downwards just
// before.
TEST(Interval, TheTieRuleMovesWallsUpwards) {
  const BoxScene scene(6, false);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    for (const bool up : {false, true}) {
      Fixed origin = {9 * kOne / 4, 7 * kOne / 4, 11 * kOne / 4};
      std::array<int, 3> d{};
      origin[axis] = (up ? -1 : 7) * kOne;
      d[axis] = up ? 1 : -1;
      const Location from = scene.locate(scene.fixed_to_scene(origin));
      for (const double t : {2.0, 6.0}) {
        EXPECT_EQ(scene.first_hit(from, scene.to_scene(d), {before(t), t}).outcome,
                  up ? Outcome::miss : Outcome::hit);
        EXPECT_EQ(scene.first_hit(from, scene.to_scene(d), {t, after(t)}).outcome,
                  up ? Outcome::hit : Outcome::miss);
      }
      // The same for a start on the wall: it is just before it, or just behind.
      origin[axis] = scene.low * kOne;
      const Hit hit = scene.first_hit(scene.locate(scene.fixed_to_scene(origin)), scene.to_scene(d));
      EXPECT_EQ(hit.outcome, up ? Outcome::hit : Outcome::miss);
      if (up) {
        EXPECT_EQ(hit.t, 0);
        EXPECT_FALSE(hit.back);
      }
    }
  }
}

TEST_P(IntervalOn, EndsThatMakeNoSense) {
  const Location from = scene_.locate(scene_.to_scene({2, 3, 2}));
  const Vec3f d = scene_.fixed_to_scene({kOne, kOne / 8, kOne / 4});
  const double t = hit_in(from, d, {}).t;
  ASSERT_EQ(t, 3);
  const auto met = [&](double t_min, double t_max) {
    const Hit hit = hit_in(from, d, {t_min, t_max});
    EXPECT_NE(hit.outcome, Outcome::corrupt);
    EXPECT_TRUE(hit.outcome == Outcome::miss || hit.t == t);
    return hit.outcome == Outcome::hit;
  };
  // Below 0 is 0.
  EXPECT_TRUE(met(-1, kInfinity));
  EXPECT_TRUE(met(-kInfinity, kInfinity));
  EXPECT_TRUE(met(-kSubnormal, 4));
  EXPECT_TRUE(met(-0.0, DBL_MAX));
  // Empty.
  EXPECT_FALSE(met(0, -1));
  EXPECT_FALSE(met(0, -kSubnormal));
  EXPECT_FALSE(met(4, 2));
  EXPECT_FALSE(met(after(t), t));
  EXPECT_FALSE(met(-5, -4));
  EXPECT_FALSE(met(kInfinity, kInfinity));
  EXPECT_FALSE(met(0, -kInfinity));
  EXPECT_FALSE(met(kNaN, kInfinity));
  EXPECT_FALSE(met(0, kNaN));
  EXPECT_FALSE(met(kNaN, kNaN));
  // As small and as large as doubles get.
  EXPECT_FALSE(met(0, 0));
  EXPECT_FALSE(met(0, kSubnormal));
  EXPECT_FALSE(met(0, DBL_MIN));
  EXPECT_TRUE(met(kSubnormal, 1e308));
  EXPECT_TRUE(met(DBL_MIN, DBL_MAX));
  EXPECT_FALSE(met(1e308, kInfinity));
  EXPECT_FALSE(met(1e308, DBL_MAX));
  EXPECT_FALSE(met(DBL_MAX, DBL_MAX));
}

// The largest and smallest directions that float32 has: their t are far from 1, and ends are still exact.
TEST_P(IntervalOn, EndsAreInUnitsOfAnyDirection) {
  const Location from = scene_.locate(scene_.fixed_to_scene({-kOne, 9 * kOne / 4, 7 * kOne / 4}));
  const Vec3f along = scene_.to_scene({1, 0, 0});
  for (const int power : {-149, -126, -40, 40, 126}) {
    const auto scaled = [&](float x) { return std::ldexp(x, power); };
    const Vec3f d = {scaled(along.x), scaled(along.y), scaled(along.z)};
    const double t = std::ldexp(2.0, -power);
    ASSERT_EQ(hit_in(from, d, {}).t, t);
    EXPECT_EQ(hit_in(from, d, {before(t), after(t)}).outcome, Outcome::hit);
    EXPECT_EQ(hit_in(from, d, {0, before(t)}).outcome, Outcome::miss);
    EXPECT_EQ(hit_in(from, d, {after(t), kInfinity}).t, 3 * t);
    EXPECT_NE(hit_in(from, d, {0, t}).outcome, hit_in(from, d, {t, after(t)}).outcome);
  }
}

/// Rays through vertices of the box's lattice, from whole numbers, with every t at which they meet the walls'
/// planes: exact in a double, because the components are powers of two.
struct IntegerRay {
  std::array<int, 3> origin{}, direction{};
  std::set<double> crossings;
};
IntegerRay some_ray(std::mt19937& random, int n) {
  IntegerRay ray;
  constexpr std::array<int, 9> kComponents = {0, 1, -1, 2, -2, 4, -4, 0, 1};
  while (ray.direction == std::array<int, 3>{}) {
    for (std::size_t k = 0; k < 3; ++k) {
      ray.origin[k] = static_cast<int>(random() % static_cast<unsigned>(n - 1)) + 1;
      ray.direction[k] = kComponents[random() % kComponents.size()];
    }
  }
  const int back = static_cast<int>(random() % 4);
  for (std::size_t k = 0; k < 3; ++k) ray.origin[k] -= back * ray.direction[k];
  for (std::size_t k = 0; k < 3; ++k) {
    if (ray.direction[k] == 0) continue;
    for (const int plane : {1, n - 1}) {
      const double t = static_cast<double>(plane - ray.origin[k]) / ray.direction[k];
      if (t >= 0) ray.crossings.insert(t);
    }
  }
  ray.crossings.insert({0, 0.5, kInfinity});
  return ray;
}

std::vector<Index> sides_of(const std::vector<Hit>& hits) {
  std::vector<Index> sides;
  for (const Hit& hit : hits) sides.push_back(hit.side);
  return sides;
}

// The promise of Interval: what lies in [a, b] and what lies in [b, c] is what lies in [a, c], once each.
TEST_P(IntervalOn, NeighbouringIntervalsShareNothingAndLoseNothing) {
  std::mt19937 random(2);
  int crossings = 0, ends_on_faces = 0;
  for (int i = 0; i < 700; ++i) {
    const IntegerRay ray = some_ray(random, 6);
    const Location from = scene_.locate(scene_.to_scene(ray.origin));
    const Vec3f d = scene_.to_scene(ray.direction);
    const auto whole_ray = scene_.all_hits(from, d);
    ASSERT_EQ(whole_ray.outcome, Outcome::miss);
    crossings += static_cast<int>(whole_ray.hits.size());

    // All pieces between neighbouring ends, put together.
    std::vector<Index> together;
    double a = 0;
    for (const double b : ray.crossings) {
      const auto piece = scene_.all_hits(from, d, {a, b});
      ASSERT_EQ(piece.outcome, Outcome::miss);
      for (const Hit& hit : piece.hits) {
        ASSERT_GE(hit.t, a);
        ASSERT_LE(hit.t, b);
        ends_on_faces += hit.t == a || hit.t == b;
        together.push_back(hit.side);
      }
      // [a, b] and [b, infinity) are [a, infinity).
      auto both = sides_of(piece.hits);
      for (const Index side : sides_of(scene_.all_hits(from, d, {b, kInfinity}).hits)) both.push_back(side);
      ASSERT_EQ(both, sides_of(scene_.all_hits(from, d, {a, kInfinity}).hits));
      // The first of a piece is what first_hit says.
      const Hit first = hit_in(from, d, {a, b});
      ASSERT_EQ(first.outcome == Outcome::hit, !piece.hits.empty());
      if (!piece.hits.empty()) {
        ASSERT_EQ(first.side, piece.hits[0].side);
      }
      a = b;
    }
    ASSERT_EQ(together, sides_of(whole_ray.hits));
  }
  EXPECT_GT(crossings, 500);
  EXPECT_GT(ends_on_faces, 500);
}

// An origin on a side of a face is an infinitesimal before it, so t = 0 alone meets nothing.
TEST_P(IntervalOn, FromASideOfAFace) {
  const Hit hit = scene_.first_hit(scene_.locate(scene_.fixed_to_scene({-kOne, 9 * kOne / 4, 7 * kOne / 4})),
                                   scene_.to_scene({1, 0, 0}));
  const Location front = scene_.side_of(hit, false), back = scene_.side_of(hit, true);
  const Vec3f in = scene_.to_scene({1, 0, 0}), out = scene_.to_scene({-1, 0, 0});
  EXPECT_EQ(hit_in(front, in, {0, 0}).outcome, Outcome::miss);
  EXPECT_EQ(hit_in(front, in, {0, kSubnormal}).t, 0);
  EXPECT_EQ(hit_in(front, in, {0, kSubnormal}).side, hit.side);
  EXPECT_EQ(hit_in(front, in, {kSubnormal, kInfinity}).t, 4);
  EXPECT_EQ(hit_in(front, out, {}).outcome, Outcome::miss);
  EXPECT_EQ(hit_in(back, out, {0, 1}).side, twin(hit.side));
  EXPECT_EQ(hit_in(back, out, {kSubnormal, 100}).outcome, Outcome::miss);
  EXPECT_EQ(hit_in(back, in, {0, before(4)}).outcome, Outcome::miss);
  EXPECT_EQ(hit_in(back, in, {0, after(4)}).t, 4);
}

// A bounded ray through a lattice of 18 layers visits little more than it has to.
TEST(Interval, BoundedRaysStopEarly) {
  LatticeOptions empty;
  empty.walls = 0;
  const Scene scene(18, empty);
  std::mt19937 random(3);
  std::uniform_real_distribution<float> any(-1, 1);
  for (int i = 0; i < 300; ++i) {
    const Location from = scene.locate({9 + any(random), 9 + any(random), 9 + any(random)});
    const Vec3f d = {any(random), any(random), any(random)};
    const double length = std::hypot(d.x, d.y, d.z);
    const std::uint32_t whole = scene.first_hit(from, d).steps;
    std::uint32_t last = 0;
    for (const double reached : {0.0, 1.0, 2.0, 4.0, 8.0, 40.0}) {
      const std::uint32_t steps = scene.first_hit(from, d, {0, reached / length}).steps;
      EXPECT_GE(steps, last);
      EXPECT_LE(steps, whole);
      // A unit of length crosses at most 6 planes on average of each of the families that cut the lattice;
      // the tetrahedron after the end may be needed to know that it is the end.
      EXPECT_LE(steps, 12 + 12 * reached);
      last = steps;
    }
    EXPECT_EQ(last, whole);
  }
}

}  // namespace
}  // namespace tetfmt_test
