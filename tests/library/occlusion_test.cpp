// SPDX-License-Identifier: AGPL-3.0-or-later
// Whether something is in the way: along rays, and from place to place, for places of every kind. Held
// against what first_hit and all_hits say, and against the box where it alone decides.
#include <gtest/gtest.h>

#include <random>

#include "support/box_scene.hpp"

namespace tetfmt_test {
namespace {

using namespace tetfmt;

constexpr Outcome kSeen = Outcome::miss, kHidden = Outcome::hit;

class OcclusionOn : public ::testing::TestWithParam<bool> {
 protected:
  /// A point of the lattice's halves in and around the box: vertices, edges, faces and cells.
  std::array<int, 3> some_halves() {
    const auto one = [&] { return static_cast<int>(random_() % 19) - 4; };
    return {one(), one(), one()};
  }
  Location place(const std::array<int, 3>& halves) const {
    return scene_.locate(
        scene_.fixed_to_scene({halves[0] * kOne / 2, halves[1] * kOne / 2, halves[2] * kOne / 2}));
  }
  /// From one place of halves to the other: exact in float32.
  Vec3f direction(const std::array<int, 3>& from, const std::array<int, 3>& to) const {
    return scene_.fixed_to_scene(
        {(to[0] - from[0]) * kOne / 2, (to[1] - from[1]) * kOne / 2, (to[2] - from[2]) * kOne / 2});
  }

  std::mt19937 random_{1};
  const BoxScene scene_{5, GetParam()};
};
INSTANTIATE_TEST_SUITE_P(, OcclusionOn, ::testing::Bool(),
                         [](const auto& given) { return given.param ? "Sheared" : "Straight"; });

TEST_P(OcclusionOn, ARayIsBlockedWhereItHits) {
  int blocked = 0;
  for (int i = 0; i < 4000; ++i) {
    const auto p = some_halves(), q = some_halves();
    const Location from = place(p);
    const Interval interval{static_cast<double>(random_() % 5) / 4, static_cast<double>(random_() % 9) / 4};
    const Hit hit = scene_.first_hit(from, direction(p, q), interval);
    ASSERT_EQ(scene_.occlusion(from, direction(p, q), interval), hit.outcome);
    ASSERT_EQ(scene_.occlusion(from, direction(p, q)), scene_.first_hit(from, direction(p, q)).outcome);
    blocked += hit.outcome == Outcome::hit;
  }
  EXPECT_GT(blocked, 400);
}

// The straight way from p to q is the ray p + t (q - p), t from 0 to 1: also through edges and vertices, and
// where p or q lie on them. Whoever sees is seen.
TEST_P(OcclusionOn, PlacesSeeEachOtherUnlessTheRayBetweenHits) {
  int seen = 0, hidden = 0;
  for (int i = 0; i < 6000; ++i) {
    const auto p = some_halves(), q = i % 50 == 0 ? p : some_halves();
    const Location from = place(p), to = place(q);
    const Outcome outcome = scene_.occlusion(from, to);
    const auto between = scene_.all_hits(from, direction(p, q), {0, 1});
    ASSERT_EQ(outcome, between.hits.empty() ? kSeen : kHidden);
    ASSERT_EQ(scene_.occlusion(to, from), outcome);
    ++(outcome == kSeen ? seen : hidden);
  }
  EXPECT_GT(seen, 1000);
  EXPECT_GT(hidden, 1000);
}

// Directions between these are no float32: no ray can stand in, but the box can.
TEST_P(OcclusionOn, NoDirectionIsRounded) {
  std::uniform_real_distribution<float> any(-2, 7);
  int hidden = 0;
  for (int i = 0; i < 4000; ++i) {
    const auto point = [&] { return scene_.near({any(random_), any(random_), any(random_)}); };
    const Location a = scene_.locate(point()), b = scene_.locate(point());
    const Outcome outcome = scene_.occlusion(a, b);
    ASSERT_EQ(scene_.occlusion(b, a), outcome);
    // Inside and outside never see each other; two places inside always do.
    const auto in_box = [&](const Location& location) {
      return location.state == Location::State::inside && scene_.view20.region_of(location.cell.tet) == 1;
    };
    if (in_box(a) != in_box(b)) {
      ASSERT_EQ(outcome, kHidden);
    } else if (in_box(a)) {
      ASSERT_EQ(outcome, kSeen);
    } else {
      // By slabs, unless the line touches the box so closely that double precision cannot tell.
      double first = 0, last = 1;
      const auto at = [&](const Location& location, std::size_t k) {
        if (!GetParam()) return location.position[k];
        const auto& [x, y, z] = location.position;  // unsheared
        return k == 0 ? 3 * x - 2 * y - 2 * z : k == 1 ? y + z - x : z - x;
      };
      for (std::size_t k = 0; k < 3; ++k) {
        const double o = at(a, k), d = at(b, k) - o;
        const double near = ((d > 0 ? scene_.low : scene_.high) - o) / d,
                     far = ((d > 0 ? scene_.high : scene_.low) - o) / d;
        first = std::max(first, near);
        last = std::min(last, far);
      }
      if (std::abs(first - last) > 1e-9) {
        ASSERT_EQ(outcome, first < last ? kHidden : kSeen) << i;
      }
    }
    hidden += outcome == kHidden;
  }
  EXPECT_GT(hidden, 1000);
}

// A side of a face is seen from in front of it, as far as nothing else is in the way.
TEST_P(OcclusionOn, SidesAreSeenFromInFront) {
  int seen = 0, hidden = 0;
  for (int i = 0; i < 6000; ++i) {
    const auto o = some_halves(), p = some_halves(), q = some_halves();
    const Hit hit = first_hit(scene_.view20, place(o), direction(o, q));
    if (hit.outcome != Outcome::hit) continue;
    const bool far = random_() % 2 == 0, behind = far != hit.back;  // in the box
    const Location side = scene_.side_of(hit, far);
    const Location from = place(p);
    const std::size_t wall = BoxScene::wall_of(hit.triangle), axis = wall / 2;
    // Off the wall's plane: how far outwards, in halves.
    const int outwards = wall % 2 == 1 ? p[axis] - 2 * scene_.high : 2 * scene_.low - p[axis];
    if (outwards == 0) {  // in the face's own plane: behind it or in front, as the tie rule has it
      const Location other = scene_.side_of(hit, !far);
      ASSERT_FALSE(scene_.occlusion(from, side) == kSeen && scene_.occlusion(from, other) == kSeen);
      ASSERT_EQ(scene_.occlusion(from, side), scene_.occlusion(side, from));
      continue;
    }
    const bool in_closed_box =
        std::min({p[0], p[1], p[2]}) >= 2 * scene_.low && std::max({p[0], p[1], p[2]}) <= 2 * scene_.high;
    const bool in_box = from.state == Location::State::inside && scene_.view20.region_of(from.cell.tet) == 1;
    const Outcome expected = behind ? (in_box ? kSeen : kHidden) : (outwards > 0 ? kSeen : kHidden);
    if (behind && in_closed_box && !in_box) continue;  // on another wall: the tie rule decides
    ASSERT_EQ(scene_.occlusion(from, side), expected);
    ASSERT_EQ(scene_.occlusion(side, from), expected);
    ++(expected == kSeen ? seen : hidden);
  }
  EXPECT_GT(seen, 120);
  EXPECT_GT(hidden, 120);
}

// From side to side: two insides of the box see each other, also along the same wall; two outsides only where
// each is in front of the other or beside it; an inside and an outside never do.
TEST_P(OcclusionOn, SidesSeeSides) {
  int seen = 0, along = 0;
  for (int i = 0; i < 6000; ++i) {
    const auto o = some_halves(), q = some_halves(), r = some_halves(), s = some_halves();
    const Hit a = first_hit(scene_.view20, place(o), direction(o, q)),
              b = first_hit(scene_.view20, place(r), direction(r, s));
    if (a.outcome != Outcome::hit || b.outcome != Outcome::hit) continue;
    const bool far_a = random_() % 2 == 0, far_b = random_() % 2 == 0;
    const bool in_a = far_a != a.back, in_b = far_b != b.back;
    const Location from = scene_.side_of(a, far_a), to = scene_.side_of(b, far_b);
    const bool same_wall = BoxScene::wall_of(a.triangle) == BoxScene::wall_of(b.triangle);
    const Outcome expected = in_a != in_b ? kHidden : in_a || same_wall ? kSeen : kHidden;
    ASSERT_EQ(scene_.occlusion(from, to), expected)
        << i << (same_wall ? ", same wall" : "") << (in_a ? ", from inside" : "")
        << (in_b ? ", to inside" : "") << (from.position == to.position ? ", same point" : "");
    ASSERT_EQ(scene_.occlusion(to, from), expected);
    seen += expected == kSeen;
    along += same_wall;
  }
  EXPECT_GT(seen, 120);
  EXPECT_GT(along, 60);
}

TEST_P(OcclusionOn, EqualPlacesSeeEachOtherUnlessAFaceIsBetweenThem) {
  const Hit hit = scene_.first_hit(scene_.locate(scene_.to_scene({-1, 2, 3})), scene_.to_scene({1, 0, 0}));
  const Location front = scene_.side_of(hit, false), back = scene_.side_of(hit, true);
  EXPECT_EQ(scene_.occlusion(front, front), kSeen);
  EXPECT_EQ(scene_.occlusion(back, back), kSeen);
  EXPECT_EQ(scene_.occlusion(front, back), kHidden);
  EXPECT_EQ(scene_.occlusion(back, front), kHidden);
  for (const std::array<int, 3>& p : {std::array<int, 3>{2, 2, 2}, {1, 1, 1}, {-3, 0, 9}, {0, 0, 0}}) {
    const Location here = scene_.locate(scene_.to_scene(p));
    EXPECT_EQ(scene_.occlusion(here, here), kSeen);
  }
}

// Far outside on both sides of the box, past it, and beyond the hull.
TEST_P(OcclusionOn, FromOutsideToOutside) {
  const auto at = [&](const std::array<int, 3>& p) { return scene_.locate(scene_.to_scene(p)); };
  EXPECT_EQ(scene_.occlusion(at({-9, 2, 3}), at({12, 2, 3})), kHidden);
  EXPECT_EQ(scene_.occlusion(at({-9, 2, 3}), at({-3, 2, 3})), kSeen);
  EXPECT_EQ(scene_.occlusion(at({-3, 2, 3}), at({-9, 2, 3})), kSeen);
  EXPECT_EQ(scene_.occlusion(at({-9, -9, -9}), at({12, -9, -9})), kSeen);
  EXPECT_EQ(scene_.occlusion(at({-9, -9, -9}), at({12, 12, 12})), kHidden);
  EXPECT_EQ(scene_.occlusion(at({-9, 2, 3}), at({0, 2, 3})), kSeen);
  EXPECT_EQ(scene_.occlusion(at({0, 2, 3}), at({-9, 2, 3})), kSeen);
}

// Without the inside of the box: what is in it cannot be seen, and nothing is known from there.
TEST(OcclusionPartial, LeftOutSpaceIsHiddenBehindItsWalls) {
  for (const bool sheared : {false, true}) {
    const BoxScene whole(5, sheared), partial(5, sheared, {}, {0});
    std::mt19937 random(2);
    std::uniform_real_distribution<float> any(-2, 7);
    int absent = 0, seen = 0, hidden = 0;
    for (int i = 0; i < 2000; ++i) {
      const auto point = [&] { return whole.near({any(random), any(random), any(random)}); };
      const Vec3f p = point(), q = point();
      const Location from = partial.locate(p), to = partial.locate(q);
      const Outcome outcome = partial.occlusion(from, to);
      if (from.state == Location::State::absent) {
        ASSERT_EQ(outcome, Outcome::absent);
        ++absent;
        continue;
      }
      ASSERT_EQ(outcome, whole.occlusion(whole.locate(p), whole.locate(q)));
      if (to.state == Location::State::absent) {
        ASSERT_EQ(outcome, kHidden);
      }
      ++(outcome == kSeen ? seen : hidden);
    }
    EXPECT_GT(absent, 50);
    EXPECT_GT(seen, 200);
    EXPECT_GT(hidden, 200);
  }
}

// The far side of a wall whose inside is left out: hidden from the near side, and from everywhere.
TEST(OcclusionPartial, SidesInLeftOutSpaceAreHidden) {
  const BoxScene whole(5, false), partial(5, false, {}, {0});
  std::mt19937 random(4);
  std::uniform_real_distribution<float> any(-2, 7);
  int asked = 0;
  for (int i = 0; i < 2000; ++i) {
    const Location from = partial.locate({any(random), any(random), any(random)});
    const Hit hit = partial.first_hit(from, {any(random) - 2.5f, any(random) - 2.5f, any(random) - 2.5f});
    if (hit.outcome != Outcome::hit) continue;
    const Location near = partial.side_of(hit, false), far = partial.side_of(hit, true);
    ASSERT_EQ(far.state, Location::State::absent);
    ASSERT_EQ(partial.occlusion(near, far), kHidden);
    ASSERT_EQ(partial.occlusion(from, far), kHidden);
    ASSERT_EQ(partial.occlusion(far, near), Outcome::absent);
    ++asked;
  }
  EXPECT_GT(asked, 100);
}

// The inside of the box alone: there is no hull, and everything in it sees everything.
TEST(OcclusionPartial, ARoomAlone) {
  const BoxScene room(5, false, {}, {1});
  std::mt19937 random(3);
  std::uniform_real_distribution<float> inside(1, 4);
  const auto point = [&] { return Vec3f{inside(random), inside(random), inside(random)}; };
  const Location away = room.locate({9, 9, 9});
  ASSERT_EQ(away.state, Location::State::absent);
  for (int i = 0; i < 1000; ++i) {
    const Location a = room.locate(point()), b = room.locate(point());
    ASSERT_EQ(room.occlusion(a, b), kSeen);
    ASSERT_EQ(room.occlusion(a, away), kHidden);
    ASSERT_EQ(room.occlusion(away, a), Outcome::absent);
  }
}

TEST(OcclusionStop, EndsInTheTargetsTetrahedronAndIsCorruptWithoutOne) {
  const BoxScene scene(5, false);
  Location nowhere;
  const Location here = scene.locate({2, 2, 2});
  EXPECT_EQ(scene.occlusion(here, nowhere), Outcome::corrupt);
  EXPECT_EQ(scene.occlusion(nowhere, here), Outcome::corrupt);
  const float infinity = std::numeric_limits<float>::infinity();
  EXPECT_EQ(scene.occlusion(scene.locate({infinity, 0, 0}), here), kSeen);  // no line leads there
  EXPECT_EQ(scene.occlusion(here, scene.locate({0, 0, -infinity})), kSeen);
}

}  // namespace
}  // namespace tetfmt_test
