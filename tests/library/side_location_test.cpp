// SPDX-License-Identifier: AGPL-3.0-or-later
// Rays that start on a side of a face: where exactly they start, that they never meet that face on their way
// off it, and that no chain of them ever leaves a closed box.
#include <gtest/gtest.h>

#include <optional>
#include <random>

#include "support/box_scene.hpp"

namespace tetfmt_test {
namespace {

using namespace tetfmt;

int below(std::mt19937& random, int count) {
  return static_cast<int>(random() % static_cast<unsigned>(count));
}
int between(std::mt19937& random, int low, int high) {
  return low + below(random, high - low + 1);
}

/// A hit on the box from in and around it: on quarters of the lattice, so that many lie on edges and
/// vertices; every other one in general position.
std::optional<Hit> some_hit(const BoxScene& scene, std::mt19937& random, bool lattice) {
  const auto coordinate = [&]() -> std::int64_t {
    const std::int64_t quarters = between(random, 4 * (scene.low - 1), 4 * (scene.high + 1)) * (kOne / 4);
    return lattice ? quarters : quarters + between(random, 0, 255) * (kOne / 4 / 256);
  };
  const Fixed origin = {coordinate(), coordinate(), coordinate()};
  const std::array<int, 3> direction = {between(random, -3, 3), between(random, -3, 3),
                                        between(random, -3, 3)};
  const Hit hit =
      first_hit(scene.view20, locate(scene.view20, scene.fixed_to_scene(origin)), scene.to_scene(direction));
  if (hit.outcome != Outcome::hit) return std::nullopt;
  return hit;
}

/// The face that a location is on: its corners in the scene's (whole) coordinates.
std::array<Fixed, 3> face_corners(const Scene& scene, const Location& location) {
  std::array<Fixed, 3> corners;
  for (std::size_t k = 0, n = 0; k < 4; ++k) {
    if (k == location.face) continue;
    const Vec3f& v = scene.mesh.vertices[location.cell.vertices[k]];
    corners[n++] = {static_cast<int>(v.x), static_cast<int>(v.y), static_cast<int>(v.z)};
  }
  return corners;
}

Fixed minus(const Fixed& a, const Fixed& b) {
  return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
}
Fixed cross(const Fixed& a, const Fixed& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
std::int64_t dot(const Fixed& a, const Fixed& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

class SideLocation : public ::testing::TestWithParam<bool> {
 protected:
  const BoxScene scene_{5, GetParam()};
};
INSTANTIATE_TEST_SUITE_P(, SideLocation, ::testing::Bool(),
                         [](const auto& given) { return given.param ? "Sheared" : "Straight"; });

TEST_P(SideLocation, IsExactlyInItsFaceAndNamesTheTetrahedronOfItsSide) {
  std::mt19937 random(1);
  int count = 0;
  for (int i = 0; i < 20000; ++i) {
    const auto hit = some_hit(scene_, random, i % 2 == 0);
    if (!hit) continue;
    ++count;
    for (const bool far : {false, true}) {
      const Location at = scene_.side_of(*hit, far);
      const Index side = far ? twin(hit->side) : hit->side;
      ASSERT_EQ(at.state, Location::State::inside);
      ASSERT_EQ(at.cell.tet, far ? hit->neighbor : hit->tet);
      ASSERT_EQ(at.cell.vertices, scene_.mesh.tets[at.cell.tet].vertices);
      ASSERT_EQ(at.cell.neighbors, scene_.mesh.tets[at.cell.tet].neighbors);
      ASSERT_LT(at.face, 4);
      ASSERT_EQ(at.cell.neighbors[at.face], side_ref(side));

      // In whole numbers: coordinates times 2^26.
      Fixed p{};
      for (std::size_t k = 0; k < 3; ++k) {
        const double scaled = std::ldexp(at.position[k], 26);
        ASSERT_EQ(scaled, std::floor(scaled));
        p[k] = static_cast<std::int64_t>(scaled);
      }
      const auto corners = face_corners(scene_, at);
      const auto fixed = [&](std::size_t k) {
        return Fixed{corners[k][0] * kOne, corners[k][1] * kOne, corners[k][2] * kOne};
      };
      const Fixed normal = cross(minus(corners[1], corners[0]), minus(corners[2], corners[0]));
      ASSERT_EQ(dot(normal, minus(p, fixed(0))), 0);
      for (std::size_t k = 0; k < 3; ++k) {
        const Fixed edge = minus(corners[(k + 1) % 3], corners[k]);
        ASSERT_GT(dot(normal, cross(edge, minus(p, fixed(k)))), 0);
      }
      // And it is the hit's own point.
      const auto& abc = scene_.mesh.triangles[hit->triangle].vertices;
      const auto near_coordinate = [&](float Vec3f::*axis, double found) {
        const double a = scene_.mesh.vertices[abc[0]].*axis, b = scene_.mesh.vertices[abc[1]].*axis,
                     c = scene_.mesh.vertices[abc[2]].*axis;
        return std::abs(a + hit->u * (b - a) + hit->v * (c - a) - found) < 1e-6;
      };
      ASSERT_TRUE(near_coordinate(&Vec3f::x, at.position[0]));
      ASSERT_TRUE(near_coordinate(&Vec3f::y, at.position[1]));
      ASSERT_TRUE(near_coordinate(&Vec3f::z, at.position[2]));
    }
    ASSERT_EQ(scene_.side_of(*hit, false).position, scene_.side_of(*hit, true).position);
  }
  EXPECT_GT(count, 4000);
}

/// By which walls of the box a line from p along d leaves it, and where: exact. Nothing for a standstill.
struct Exit {
  Fraction t{kOne, 1};
  unsigned walls = 0;  ///< a bit for each wall that is met at t
};
Exit leave_box(const BoxScene& scene, const Fixed& p, const std::array<int, 3>& d, std::size_t own_axis) {
  Exit exit;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if (d[axis] == 0) continue;
    const bool high = d[axis] > 0;
    const std::int64_t way = (high ? scene.high : scene.low) * kOne - p[axis];
    if (axis == own_axis && way == 0) continue;  // away from where it starts
    const Fraction t = Fraction::of(way, d[axis] * kOne);
    const unsigned wall = 1u << (2 * axis + (high ? 1 : 0));
    if (t < exit.t) exit = {t, 0};
    if (t == exit.t) exit.walls |= wall;
  }
  return exit;
}

// From in front of each wall and from behind, into it, away from it and parallel to it: every ray along whole
// numbers, from points of which half lie so that everything ties.
TEST_P(SideLocation, RaysMeetTheirOwnFaceOnlyIfTheyPointIntoIt) {
  std::mt19937 random(2);
  int into = 0, parallel = 0, away = 0;
  for (int i = 0; i < 30000; ++i) {
    const auto hit = some_hit(scene_, random, i % 2 == 0);
    if (!hit) continue;
    const bool far = below(random, 2) == 0;
    const Location from = scene_.side_of(*hit, far);
    const Index own = far ? twin(hit->side) : hit->side;
    const bool inside = own % 2 == 1;  // behind the wall is in the box
    const std::size_t wall = BoxScene::wall_of(hit->triangle), axis = wall / 2;
    const Fixed p = scene_.to_lattice(from);
    ASSERT_EQ(p[axis], (wall % 2 == 1 ? scene_.high : scene_.low) * kOne);

    std::array<int, 3> d = {between(random, -3, 3), between(random, -3, 3), between(random, -3, 3)};
    if (below(random, 3) == 0) d[axis] = 0;
    if (d == std::array<int, 3>{}) continue;
    const int outward = wall % 2 == 1 ? d[axis] : -d[axis], towards = inside ? outward : -outward;
    const Hit found = scene_.first_hit(from, scene_.to_scene(d));
    if (towards > 0) {
      ++into;
      ASSERT_EQ(found.outcome, Outcome::hit);
      ASSERT_EQ(found.t, 0);
      ASSERT_EQ(found.side, own);
      ASSERT_EQ(found.tet, from.cell.tet);
      ASSERT_EQ(found.steps, 1u);
    } else if (inside) {
      const Exit exit = leave_box(scene_, p, d, axis);
      ASSERT_EQ(found.outcome, Outcome::hit);
      ASSERT_TRUE(found.back);
      ASSERT_TRUE(within_four_ulp(found.t, exit.t)) << found.t << " instead of " << exit.t.value();
      ASSERT_NE(exit.walls >> BoxScene::wall_of(found.triangle) & 1u, 0u);
      ASSERT_NE(found.side, own);
      ++(towards == 0 ? parallel : away);
    } else {
      ASSERT_EQ(found.outcome, Outcome::miss);  // the box is convex
      ++(towards == 0 ? parallel : away);
    }
  }
  EXPECT_GT(into, 2000);
  EXPECT_GT(parallel, 1500);
  EXPECT_GT(away, 2000);
}

// The same line in the plane of a wall, thought of in front of it or behind: what stands on the wall's back
// is met by one of them only.
TEST_P(SideLocation, ParallelRaysRunOnTheirOwnSide) {
  const std::array<int, 3> start = {scene_.low, 2, 3}, across = {1, 0, 0};
  const Hit hit = scene_.first_hit(scene_.locate(scene_.to_scene({-1, 2, 3})), scene_.to_scene(across));
  ASSERT_EQ(hit.outcome, Outcome::hit);
  ASSERT_EQ(hit.t, 2);
  ASSERT_EQ(BoxScene::wall_of(hit.triangle), 0u);
  const Location front = scene_.side_of(hit, false), back = scene_.side_of(hit, true);
  ASSERT_FALSE(hit.back);
  const Fixed p = scene_.to_lattice(front);
  for (std::size_t i = 0; i < 3; ++i) ASSERT_NEAR(static_cast<double>(p[i] - whole(start)[i]), 0, 2);
  for (const std::array<int, 3>& d : {std::array<int, 3>{0, 1, 0},
                                      {0, -1, 0},
                                      {0, 0, 1},
                                      {0, 0, -2},
                                      {0, 1, 1},
                                      {0, -1, -1},
                                      {0, 1, -1},
                                      {0, -3, 1}}) {
    EXPECT_EQ(scene_.first_hit(front, scene_.to_scene(d)).outcome, Outcome::miss);
    const Hit found = scene_.first_hit(back, scene_.to_scene(d));
    const Exit exit = leave_box(scene_, p, d, 0);
    ASSERT_EQ(found.outcome, Outcome::hit);
    EXPECT_TRUE(found.back);
    EXPECT_TRUE(within_four_ulp(found.t, exit.t));
    EXPECT_NE(exit.walls >> BoxScene::wall_of(found.triangle) & 1u, 0u);
  }
}

/// A direction of a kind that rounding is unkind to: in general position, along the lattice, in the face's
/// plane, or almost in it.
Vec3f some_direction(const BoxScene& scene, std::mt19937& random, std::size_t axis) {
  std::uniform_real_distribution<float> any(-1, 1);
  std::array<int, 3> d = {between(random, -1, 1), between(random, -1, 1), between(random, -1, 1)};
  switch (below(random, 4)) {
    case 0:
      return {any(random), any(random), any(random)};
    case 1:
      return scene.to_scene(d);
    case 2:
      d[axis] = 0;
      return scene.to_scene(d);
    default:
      d[axis] = 0;
      const Vec3f flat = scene.to_scene(d);
      return {flat.x + any(random) * 0x1p-30f, flat.y + any(random) * 0x1p-60f, flat.z};
  }
}

// Reflected and refracted at random, from face to face: a ray that is in the box stays in it until it is sent
// through a wall, and one outside never finds itself inside.
TEST_P(SideLocation, ChainsOfBouncesNeverLeak) {
  std::mt19937 random(3);
  const Location centre = scene_.locate(scene_.to_scene({2, 3, 2}));
  ASSERT_EQ(scene_.view20.region_of(centre.cell.tet), 1u);
  Location from = centre;
  bool inside = true;
  std::size_t axis = 0;
  int bounces = 0, passed = 0;
  for (int i = 0; i < 40000; ++i) {
    const Vec3f direction = some_direction(scene_, random, axis);
    if (direction == Vec3f{}) continue;
    const Hit hit = scene_.first_hit(from, direction);
    if (hit.outcome == Outcome::miss && !inside) {
      from = centre;
      inside = true;
      continue;
    }
    ASSERT_EQ(hit.outcome, Outcome::hit) << i;
    ASSERT_EQ(hit.back, inside) << i;
    ASSERT_EQ(scene_.view20.region_of(hit.tet), inside ? 1u : 0u);
    ASSERT_EQ(scene_.view20.region_of(hit.neighbor), inside ? 0u : 1u);
    const bool through = below(random, 8) == 0;
    from = scene_.side_of(hit, through);
    inside ^= through;
    axis = BoxScene::wall_of(hit.triangle) / 2;
    ++bounces;
    passed += through;
  }
  EXPECT_GT(bounces, 20000);
  EXPECT_GT(passed, 2000);
}

// Mirror reflection flips one component of the direction: exact, so that the path through the box can be
// followed in whole numbers from bounce to bounce.
TEST(SideLocationMirror, PathsStayInTheBoxForever) {
  const BoxScene scene(5, false);
  std::mt19937 random(4);
  for (int chain = 0; chain < 20; ++chain) {
    Location from = scene.locate({2.5f, 1.75f, 3.125f});
    std::array<int, 3> d = {between(random, 1, 3), between(random, -3, 3), between(random, -3, -1)};
    for (int bounce = 0; bounce < 1000; ++bounce) {
      const Hit hit = scene.first_hit(from, scene.to_scene(d));
      ASSERT_EQ(hit.outcome, Outcome::hit);
      ASSERT_TRUE(hit.back);
      from = scene.side_of(hit, false);
      const std::size_t wall = BoxScene::wall_of(hit.triangle);
      ASSERT_EQ(d[wall / 2] > 0, wall % 2 == 1);  // it was going there
      d[wall / 2] = -d[wall / 2];
    }
  }
}

TEST(SideLocationState, LeftOutSpaceIsAbsentAndWhatIsNoHitIsNoPlace) {
  const BoxScene scene(5, true, {}, {0});
  const Hit hit = scene.first_hit(scene.locate(scene.to_scene({-1, 2, 3})), scene.to_scene({1, 0, 0}));
  ASSERT_EQ(hit.outcome, Outcome::hit);
  EXPECT_EQ(hit.neighbor, kNone);
  EXPECT_EQ(scene.side_of(hit, false).state, Location::State::inside);
  const Location far = scene.side_of(hit, true);
  EXPECT_EQ(far.state, Location::State::absent);
  EXPECT_EQ(far.position, scene.side_of(hit, false).position);
  EXPECT_EQ(scene.first_hit(far, {1, 0, 0}).outcome, Outcome::absent);
  EXPECT_EQ(scene.occlusion(far, {1, 0, 0}), Outcome::absent);
  EXPECT_EQ(scene.all_hits(far, {1, 0, 0}).outcome, Outcome::absent);

  const Hit miss = scene.first_hit(scene.locate(scene.to_scene({-1, 2, 3})), scene.to_scene({-1, 0, 0}));
  ASSERT_EQ(miss.outcome, Outcome::miss);
  EXPECT_EQ(scene.side_of(miss, false).state, Location::State::corrupt);
  EXPECT_EQ(scene.first_hit(scene.side_of(miss, true), {1, 0, 0}).outcome, Outcome::corrupt);
  Hit invented = hit;
  invented.side = static_cast<Index>(scene.mesh.sides.size());
  EXPECT_EQ(scene.side_of(invented, false).state, Location::State::corrupt);
}

}  // namespace
}  // namespace tetfmt_test
