// SPDX-License-Identifier: AGPL-3.0-or-later
// Location and first hits on lattices, where every ray below meets edges, vertices and planes, against the
// inner box's slabs in exact fractions.
#include "tetfmt/traverse.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <optional>
#include <random>

#include "support/scene.hpp"
#include "tetfmt/orientation.hpp"

namespace {

using namespace tetfmt;

using tetfmt_test::Scene;

Hit hit_by_all(const Scene& scene, const Ray& ray) {
  return scene.first_hit(scene.locate(ray.origin), ray.direction);
}

struct Fraction {
  std::int64_t top = 0, bottom = 1;  // bottom > 0
  friend bool operator<(Fraction a, Fraction b) { return a.top * b.bottom < b.top * a.bottom; }
  double value() const { return static_cast<double>(top) / static_cast<double>(bottom); }
};

/// Where an integer ray is inside the closed box [low, high]^3, as an interval of t.
struct Crossing {
  Fraction first{-1000000, 1}, last{1000000, 1};
  bool empty = false;
  bool in_wall = false;  ///< the ray runs in the plane of a wall: whatever it meets, it grazes
};
Crossing cross_box(const std::array<int, 3>& origin, const std::array<int, 3>& direction, int low, int high) {
  Crossing crossing;
  for (std::size_t k = 0; k < 3; ++k) {
    const int d = direction[k];
    if (d == 0) {
      crossing.empty |= origin[k] < low || origin[k] > high;
      crossing.in_wall |= origin[k] == low || origin[k] == high;
      continue;
    }
    Fraction a{low - origin[k], d}, b{high - origin[k], d};
    if (d < 0) {
      a = {-a.top, -d};
      b = {-b.top, -d};
      std::swap(a, b);
    }
    if (crossing.first < a) crossing.first = a;
    if (b < crossing.last) crossing.last = b;
  }
  crossing.empty |= crossing.last < crossing.first;
  return crossing;
}

TEST(FirstHit, EqualsTheBoxOnIntegerRays) {
  for (const int n : {3, 5, 8}) {
    const Scene scene(n);
    std::mt19937 random(static_cast<unsigned>(n));
    std::uniform_int_distribution<int> place(-3, n + 3), toward(-4, 4);
    int hits = 0, through = 0;
    for (int i = 0; i < 20000; ++i) {
      std::array<int, 3> o{}, d{};
      for (std::size_t k = 0; k < 3; ++k) {
        o[k] = place(random);
        d[k] = toward(random);
      }
      if (d == std::array<int, 3>{}) continue;
      const auto vec = [](const std::array<int, 3>& v) {
        return Vec3f{static_cast<float>(v[0]), static_cast<float>(v[1]), static_cast<float>(v[2])};
      };
      const Hit hit = hit_by_all(scene, {vec(o), vec(d)});
      ASSERT_NE(hit.outcome, Outcome::corrupt);
      const Crossing box = cross_box(o, d, 1, n - 1);
      const Fraction zero;
      if (box.empty || box.last < zero) {
        ASSERT_EQ(hit.outcome, Outcome::miss);
        continue;
      }
      const bool proper = box.first < box.last && !box.in_wall;
      if (proper && zero < box.last) {
        ASSERT_EQ(hit.outcome, Outcome::hit) << i;
      }
      through += proper && zero < box.last;
      if (hit.outcome != Outcome::hit) continue;
      ++hits;
      const bool at_first = std::abs(hit.t - box.first.value()) < 1e-12,
                 at_last = std::abs(hit.t - box.last.value()) < 1e-12;
      if (proper && zero < box.first) {
        ASSERT_TRUE(at_first) << hit.t;
        ASSERT_FALSE(hit.back);
      } else if (proper && box.first < zero) {
        ASSERT_TRUE(at_last) << hit.t;
        ASSERT_TRUE(hit.back);
      } else if (!box.in_wall) {
        ASSERT_TRUE(at_first || at_last) << hit.t;
      }
    }
    EXPECT_GT(hits, 200);
    EXPECT_GT(through, 80);
  }
}

TEST(FirstHit, TAndBarycentricsGiveTheSamePoint) {
  const Scene scene(4);
  std::mt19937 random(3);
  std::uniform_real_distribution<float> place(-2, 6);
  int hits = 0;
  for (int i = 0; i < 20000; ++i) {
    const Vec3f o = {place(random), place(random), place(random)},
                q = {place(random), place(random), place(random)};
    const Ray ray = {o, {q.x - o.x, q.y - o.y, q.z - o.z}};
    const Hit hit = hit_by_all(scene, ray);
    if (hit.outcome != Outcome::hit) continue;
    ++hits;
    ASSERT_GE(hit.u, 0);
    ASSERT_GE(hit.v, 0);
    ASSERT_LE(hit.u + hit.v, 1);
    const auto& corner = scene.mesh.triangles[hit.triangle].vertices;
    const auto at = [&](float Vec3f::*axis) {
      const double a = scene.mesh.vertices[corner[0]].*axis, b = scene.mesh.vertices[corner[1]].*axis,
                   c = scene.mesh.vertices[corner[2]].*axis;
      return a + hit.u * (b - a) + hit.v * (c - a);
    };
    ASSERT_NEAR(at(&Vec3f::x), ray.origin.x + hit.t * ray.direction.x, 1e-12);
    ASSERT_NEAR(at(&Vec3f::y), ray.origin.y + hit.t * ray.direction.y, 1e-12);
    ASSERT_NEAR(at(&Vec3f::z), ray.origin.z + hit.t * ray.direction.z, 1e-12);
    ASSERT_EQ(scene.mesh.sides[hit.side].tet, hit.tet);
    ASSERT_EQ(scene.mesh.sides[twin(hit.side)].tet, hit.neighbor);
    ASSERT_EQ(hit.back, hit.side % 2 == 1);
  }
  EXPECT_GT(hits, 3000);
}

TEST(FirstHit, TIsInUnitsOfTheDirection) {
  const Scene scene(4);
  const Vec3f origin = {2.25f, 1.75f, -3};
  for (const float length : {0x1p-120f, 0.5f, 1.0f, 0x1p100f}) {
    const Hit hit = hit_by_all(scene, {origin, {0, 0, length}});
    ASSERT_EQ(hit.outcome, Outcome::hit);
    EXPECT_DOUBLE_EQ(hit.t, 4 / static_cast<double>(length));
  }
}

TEST(FirstHit, RaysWithoutADirectionOrAPlaceHitNothing) {
  const Scene scene(3);
  const float nan = std::numeric_limits<float>::quiet_NaN(),
              infinity = std::numeric_limits<float>::infinity();
  for (const Ray& ray : {Ray{{1.5f, 1.5f, 1.5f}, {0, 0, 0}}, Ray{{1.5f, 1.5f, 1.5f}, {nan, 0, 1}},
                         Ray{{1.5f, 1.5f, 1.5f}, {infinity, 0, 0}}, Ray{{nan, 1, 1}, {1, 0, 0}},
                         Ray{{-infinity, 1, 1}, {1, 0, 0}}}) {
    const Hit hit = hit_by_all(scene, ray);
    EXPECT_EQ(hit.outcome, Outcome::miss);
    EXPECT_EQ(hit.triangle, kNone);
    EXPECT_TRUE(std::isinf(hit.t));
  }
}

TEST(FirstHit, FromVeryFarAway) {
  const Scene scene(6);
  std::mt19937 random(5);
  std::uniform_int_distribution<int> cell(1, 4);
  for (const float distance : {0x1p10f, 0x1p20f, 0x1p40f, 0x1p120f}) {
    for (int i = 0; i < 200; ++i) {
      // Towards the middle of a lattice square of the inner box's near wall: exactly representable.
      const Vec3f through = {static_cast<float>(cell(random)) + 0.25f,
                             static_cast<float>(cell(random)) + 0.5f, 1};
      const Hit hit = hit_by_all(scene, {{through.x, through.y, -distance}, {0, 0, distance}});
      ASSERT_EQ(hit.outcome, Outcome::hit);
      ASSERT_NEAR(hit.t, 1 + 1 / static_cast<double>(distance), 1e-15);
      ASSERT_FALSE(hit.back);
      ASSERT_EQ(hit_by_all(scene, {{through.x, through.y, -distance}, {0, 0, -distance}}).outcome,
                Outcome::miss);
    }
  }
}

TEST(FirstHit, OpenSurfacesAreHitFromBothSides) {
  tetfmt_test::LatticeOptions options;
  options.walls = 1;  // x = low only
  const Scene scene(4, options);
  const Hit front = hit_by_all(scene, {{0, 2.25f, 1.75f}, {1, 0, 0}});
  const Hit back = hit_by_all(scene, {{3.5f, 2.25f, 1.75f}, {-1, 0, 0}});
  ASSERT_EQ(front.outcome, Outcome::hit);
  ASSERT_EQ(back.outcome, Outcome::hit);
  EXPECT_FALSE(front.back);
  EXPECT_TRUE(back.back);
  EXPECT_EQ(front.side, twin(back.side));
  EXPECT_EQ(front.tet, back.neighbor);
}

TEST(Locate, GivesOneCellFromEveryCellThatTouchesThePoint) {
  const Scene scene(3);
  const Vec3f corner = {1, 2, 1};  // a lattice vertex, on the inner box too
  std::vector<Cell> touching;
  for (Index t = 0; t < scene.mesh.tets.size(); ++t) {
    const FullTet& tet = scene.mesh.tets[t];
    for (const Index id : tet.vertices)
      if (scene.mesh.vertices[id] == corner) touching.push_back({t, tet.vertices, tet.neighbors});
  }
  ASSERT_GT(touching.size(), 10u);
  const Location located = locate(scene.view16, corner);
  for (const Cell& cell : touching) {
    const Location again = locate(scene.view16, corner, &cell);
    ASSERT_EQ(again.cell, located.cell);
  }
}

TEST(FirstHit, ManyHullFacesAreSearchedAsFewAre) {
  // A lattice has 12 n^2 hull faces, far more than a location keeps: rays from outside look at all of them.
  const Scene many(6);
  const Location start = locate(many.view20, {-3, 2.75f, 3.375f});
  ASSERT_EQ(start.state, Location::State::outside);
  ASSERT_EQ(start.entrance_count, Location::kManyEntrances);
  EXPECT_EQ(first_hit(many.view20, start, {2, 0, 0}).t, 2);
  EXPECT_EQ(first_hit(many.view20, start, {-2, 0, 0}).outcome, Outcome::miss);

  tetfmt_test::LatticeOptions empty;
  empty.walls = 0;
  const Scene few(1, empty);
  const Location corner = locate(few.view20, {-3, 0.75f, 0.375f});
  ASSERT_EQ(corner.state, Location::State::outside);
  ASSERT_EQ(corner.entrance_count, 2);
  EXPECT_EQ(first_hit(few.view20, corner, {2, 0, 0}).outcome, Outcome::miss);
  EXPECT_GT(first_hit(few.view20, corner, {2, 0, 0}).steps, 0u);
  EXPECT_EQ(first_hit(few.view20, corner, {-2, 0, 0}).steps, 0u);
}

TEST(Locate, FindsACellThatHoldsThePointFromAnywhere) {
  const Scene scene(5);
  std::mt19937 random(11);
  std::uniform_int_distribution<int> half(-2, 12);
  std::uniform_int_distribution<Index> any(0, static_cast<Index>(scene.mesh.tets.size() - 1));
  const auto grid = [](const Vec3f& p) {
    return GridPoint{static_cast<int>(2 * p.x), static_cast<int>(2 * p.y), static_cast<int>(2 * p.z)};
  };
  int inside = 0;
  for (int i = 0; i < 5000; ++i) {
    const Vec3f point = {static_cast<float>(half(random)) / 2, static_cast<float>(half(random)) / 2,
                         static_cast<float>(half(random)) / 2};
    const Location location = locate(scene.view20, point);
    ASSERT_NE(location.state, Location::State::corrupt);
    const Index t = any(random);
    const Cell start = {t, scene.mesh.tets[t].vertices, scene.mesh.tets[t].neighbors};
    for (const Location& other : {locate(scene.view16, point), locate(scene.view16, point, &start),
                                  locate(scene.trusted20, point, &start)}) {
      ASSERT_EQ(other.state, location.state);
      ASSERT_EQ(other.cell, location.cell);
    }
    const bool outside =
        std::min({point.x, point.y, point.z}) < 0 || std::max({point.x, point.y, point.z}) > 5;
    const bool strictly_inside =
        std::min({point.x, point.y, point.z}) > 0 && std::max({point.x, point.y, point.z}) < 5;
    if (outside) {
      ASSERT_EQ(location.state, Location::State::outside);
    }
    if (strictly_inside) {
      ASSERT_EQ(location.state, Location::State::inside);
    }
    if (location.state != Location::State::inside) continue;
    ++inside;
    const FullTet& tet = scene.mesh.tets[location.cell.tet];
    ASSERT_EQ(location.cell.vertices, tet.vertices);
    ASSERT_EQ(location.cell.neighbors, tet.neighbors);
    // No corner's replacement by the point may turn the tetrahedron over.
    std::array<GridPoint, 4> corner;
    for (std::size_t k = 0; k < 4; ++k) corner[k] = grid(scene.mesh.vertices[tet.vertices[k]]);
    const int sign = orientation(corner[0], corner[1], corner[2], corner[3]);
    for (std::size_t k = 0; k < 4; ++k) {
      auto moved = corner;
      moved[k] = grid(point);
      ASSERT_NE(orientation(moved[0], moved[1], moved[2], moved[3]), -sign);
    }
  }
  EXPECT_GT(inside, 1000);
}

TEST(FloatKernel, AgreesOnGenericRaysAndAlwaysEnds) {
  const Scene scene(6);
  std::mt19937 random(13);
  std::uniform_real_distribution<float> place(-2, 8);
  for (int i = 0; i < 20000; ++i) {
    const Ray ray = {{place(random), place(random), place(random)},
                     {place(random), place(random), place(random)}};
    const Location start = locate(scene.view20, ray.origin);
    const Hit exact = first_hit(scene.view20, start, ray.direction),
              rough = first_hit(scene.view20, start, ray.direction, {}, Kernel::float_only);
    ASSERT_EQ(exact.outcome, rough.outcome);
    ASSERT_EQ(exact.triangle, rough.triangle);
  }
  std::uniform_int_distribution<int> lattice(-1, 7);
  for (int i = 0; i < 5000; ++i) {  // hostile to it: only the end is promised
    const auto one = [&] { return static_cast<float>(lattice(random)); };
    const Ray ray = {{one(), one(), one()}, {one() - 3, one() - 3, one() - 3}};
    ASSERT_LE(first_hit(scene.view16, locate(scene.view16, ray.origin), ray.direction, {}, Kernel::float_only)
                  .steps,
              scene.mesh.tets.size() + 1);
  }
}

// The inner box without what is inside: rays from outside meet what they met, points inside are nowhere.
TEST(Partial, RaysFromOutsideHitWhatTheyHitInTheWholeFile) {
  const int n = 5, low = 1, high = 4;
  const Mesh lattice = tetfmt_test::lattice_mesh(n);
  const Scene whole(tetfmt_test::with_regions(lattice, {0, 1}));
  const Scene partial(tetfmt_test::with_regions(lattice, {0}));
  EXPECT_LT(partial.mesh.tets.size(), whole.mesh.tets.size());
  std::mt19937 random(1);
  const auto coordinate = [&] { return static_cast<float>(static_cast<int>(random() % 29) - 4) / 4; };
  int hits = 0, absent = 0;
  for (int i = 0; i < 20000; ++i) {
    const Ray ray{{coordinate(), coordinate(), coordinate()}, {coordinate(), coordinate(), coordinate()}};
    const auto strictly_inside = [&](float x) { return x > low && x < high; };
    const auto in_closed_box = [&](float x) { return x >= low && x <= high; };
    const auto& [x, y, z] = ray.origin;
    const Hit found = hit_by_all(partial, ray);
    if (strictly_inside(x) && strictly_inside(y) && strictly_inside(z)) {
      EXPECT_EQ(found.outcome, Outcome::absent);
      EXPECT_EQ(locate(partial.trusted16, ray.origin).state, Location::State::absent);
      ++absent;
    } else if (!in_closed_box(x) || !in_closed_box(y) || !in_closed_box(z)) {
      const Hit expected = hit_by_all(whole, ray);
      EXPECT_EQ(found.outcome, expected.outcome);
      EXPECT_EQ(found.triangle, expected.triangle);
      EXPECT_EQ(found.t, expected.t);
      EXPECT_EQ(found.back, expected.back);
      EXPECT_EQ(found.neighbor, kNone);
      hits += found.outcome == Outcome::hit;
    }
  }
  EXPECT_GT(hits, 1000);
  EXPECT_GT(absent, 1000);
}

// A room without what is around it has no hull; what is outside is not there either.
TEST(Partial, ARoomAlone) {
  const Mesh lattice = tetfmt_test::lattice_mesh(5);
  const Scene room(tetfmt_test::with_regions(lattice, {1}));
  EXPECT_TRUE(room.view20.hull().empty());
  std::mt19937 random(2);
  for (int i = 0; i < 5000; ++i) {
    const auto inside = [&] { return 1 + static_cast<float>(1 + random() % 95) / 32; };
    const auto any = [&] { return static_cast<float>(random() % 65) / 32 - 1; };
    const Ray ray{{inside(), inside(), inside()}, {any(), any(), any()}};
    if (ray.direction == Vec3f{}) continue;
    const Hit hit = hit_by_all(room, ray);
    EXPECT_EQ(hit.outcome, Outcome::hit);
    EXPECT_TRUE(hit.back);
    EXPECT_EQ(hit.neighbor, kNone);
  }
  EXPECT_EQ(locate(room.view20, {0.5f, 0.5f, 0.5f}).state, Location::State::absent);
  EXPECT_EQ(locate(room.view16, {100, 0, 0}).state, Location::State::absent);
}

// Left-out space between the start and the point: the search goes around, from whichever cell it starts.
TEST(Partial, LocationGoesAroundWhatIsLeftOut) {
  const Mesh lattice = tetfmt_test::lattice_mesh(5);
  const Scene scene(tetfmt_test::with_regions(lattice, {0}));
  std::mt19937 random(3);
  std::vector<Cell> cells;
  for (int i = 0; i < 3000; ++i) {
    const auto coordinate = [&] { return static_cast<float>(random() % 161) / 32; };
    const Vec3f point{coordinate(), coordinate(), coordinate()};
    const Location first = locate(scene.view20, point);
    if (first.state != Location::State::inside) continue;
    cells.push_back(first.cell);
    const Cell& from = cells[random() % cells.size()];
    const Location second = locate(scene.trusted20, point, &from);
    ASSERT_EQ(second.state, Location::State::inside);
    EXPECT_EQ(second.cell, first.cell);
    EXPECT_EQ(second.positive, first.positive);
    EXPECT_EQ(locate(scene.view16, point, &from).cell, first.cell);
  }
  EXPECT_GT(cells.size(), 1000u);
}

// Where the file's triangles are pieces, hits name the input's triangle, with its weights.
TEST(FirstHit, PiecesReportTheTriangleThatTheyAreOf) {
  tetfmt_test::LatticeOptions options;
  options.one_triangle_a_face = true;
  const int n = 6, low = 1;
  Mesh mesh = tetfmt_test::lattice_mesh(n, options);
  // The twelve halves of the walls, as they are without that option.
  const std::vector<Triangle> inputs = tetfmt_test::lattice_mesh(n).triangles;
  const auto id = [&](int x, int y, int z) { return static_cast<Index>(x + (n + 1) * (y + (n + 1) * z)); };
  ASSERT_EQ(inputs[0].vertices[0], id(low, low, low));
  const auto plane_and_half = [&](const Triangle& piece) -> Index {
    for (Index i = 0; i < inputs.size(); ++i) {
      const auto point = [&](Index v) {
        const Vec3f& p = mesh.vertices[v];
        return GridPoint{static_cast<int>(p.x), static_cast<int>(p.y), static_cast<int>(p.z)};
      };
      const GridPoint a = point(inputs[i].vertices[0]), b = point(inputs[i].vertices[1]),
                      c = point(inputs[i].vertices[2]);
      bool inside = true;
      for (const Index v : piece.vertices) {
        inside &= orientation(a, b, c, point(v)) == 0;
        for (std::size_t axis = 0; axis < 3; ++axis) {
          const std::int64_t whole = doubled_area(a, b, c, axis);
          for (const std::int64_t part :
               {doubled_area(a, b, point(v), axis), doubled_area(b, c, point(v), axis),
                doubled_area(c, a, point(v), axis)})
            inside &= whole >= 0 ? part >= 0 : part <= 0;
        }
      }
      if (inside) return i;
    }
    return kNone;
  };
  std::vector<Index> origins;
  for (const Triangle& piece : mesh.triangles) origins.push_back(plane_and_half(piece));
  ASSERT_EQ(std::count(origins.begin(), origins.end(), kNone), 0);
  mesh.optional = {tetfmt_test::optional_section(kOrigins, 4, origins),
                   tetfmt_test::optional_section(kInputTriangles, 12, inputs)};
  const Scene pieces(mesh);
  const Scene whole(n);
  std::mt19937 random(4);
  int hits = 0;
  for (int i = 0; i < 5000; ++i) {
    const auto any = [&] { return static_cast<float>(static_cast<int>(random() % 2001) - 1000) / 128; };
    const auto near = [&] { return static_cast<float>(random() % 1025) / 128 - 1; };
    const Ray ray{{near(), near(), near()}, {any(), any(), any()}};
    const Hit found = hit_by_all(pieces, ray), expected = hit_by_all(whole, ray);
    ASSERT_EQ(found.outcome, expected.outcome);
    if (found.outcome != Outcome::hit) continue;
    ++hits;
    EXPECT_EQ(found.triangle, expected.triangle);
    EXPECT_NEAR(found.t, expected.t, 1e-12 * expected.t);
    EXPECT_NEAR(found.u, expected.u, 1e-12);
    EXPECT_NEAR(found.v, expected.v, 1e-12);
  }
  EXPECT_GT(hits, 1000);
}

}  // namespace
