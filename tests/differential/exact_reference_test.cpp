// SPDX-License-Identifier: AGPL-3.0-or-later
// The reference itself: on surfaces whose answers are known by construction, against brute force, and against
// rational arithmetic that really moves the vertices by small amounts.
#include "bench/truth/exact_reference.hpp"

#include <CGAL/Exact_rational.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <set>

#include "common/failure.hpp"

namespace tetfmt_test {
namespace {

using tetbench::Crossing;
using tetbench::ExactLine;
using tetbench::ExactReference;
using tetbench::Face;
using tetbench::Place;
using tetbench::Surface;
using tetbench::Vec3d;
using tetfmt::Vec3f;
using Rational = CGAL::Exact_rational;
using Point = std::array<Rational, 3>;

constexpr double kForever = std::numeric_limits<double>::infinity();

/// The square [0, 2]^2 at z = 0, four triangles around the centre (1, 1, 0), normals up.
Surface square() {
  return {{{0, 0, 0}, {2, 0, 0}, {2, 2, 0}, {0, 2, 0}, {1, 1, 0}},
          {{0, 1, 4}, {1, 2, 4}, {2, 3, 4}, {3, 0, 4}}};
}

/// A tetrahedron with normals outwards.
Surface closed() {
  return {{{0, 0, 0}, {4, 0, 0}, {0, 4, 0}, {0, 0, 4}}, {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}}};
}

ExactLine from_point(const Surface& surface, const Vec3d& origin, const Vec3d& direction) {
  return {surface, Place{origin, {}}, direction};
}

std::vector<Crossing> crossings(const Surface& surface, const Vec3d& origin, const Vec3d& direction,
                                double t_min = 0, double t_max = kForever) {
  const ExactReference reference(surface);
  const ExactLine line = from_point(reference.surface(), origin, direction);
  const auto all = reference.crossings(line, t_min, t_max);
  const auto first = reference.first_crossing(line, t_min, t_max);
  EXPECT_EQ(first.size(), all.empty() ? 0U : 1U);
  EXPECT_TRUE(first.empty() || first[0] == all[0]);
  EXPECT_EQ(all, reference.crossings_without_tree(line, t_min, t_max));
  return all;
}

TEST(ExactReference, InteriorEdgeAndVertexAreCrossedOnce) {
  const auto inside = crossings(square(), {1, 0.25, 3}, {0, 0, -2});
  ASSERT_EQ(inside.size(), 1U);
  EXPECT_EQ(inside[0].face, 0U);
  EXPECT_FALSE(inside[0].back);
  EXPECT_LE(inside[0].low, 1.5);
  EXPECT_GE(inside[0].high, 1.5);
  EXPECT_LT(inside[0].high - inside[0].low, 1e-14);
  EXPECT_EQ(crossings(square(), {0.5, 0.5, 3}, {0, 0, -1}).size(), 1U) << "an edge";
  EXPECT_EQ(crossings(square(), {1, 1, 3}, {0, 0, -1}).size(), 1U) << "the vertex in the middle";
  EXPECT_TRUE(crossings(square(), {1, 1, 3}, {0, 0, 1}).empty()) << "behind the origin";
  EXPECT_TRUE(crossings(square(), {3, 3, 3}, {0, 0, -1}).empty()) << "beside";
  const auto below = crossings(square(), {1, 0.25, -2}, {0, 0, 1});
  ASSERT_EQ(below.size(), 1U);
  EXPECT_TRUE(below[0].back);
  EXPECT_EQ(below[0].side(), 1U);
}

TEST(ExactReference, ClosedSurfacesAreCrossedEvenlyAndInTurn) {
  const ExactReference reference(closed());
  EXPECT_TRUE(reference.surface().closed);
  EXPECT_FALSE(square().closed);
  int tied = 0;
  for (int x = -1; x <= 5; ++x)
    for (int y = -1; y <= 5; ++y)
      for (int dx = -1; dx <= 1; ++dx)
        for (int dy = -1; dy <= 1; ++dy) {
          const ExactLine line =
              from_point(reference.surface(), {double(x), double(y), -3}, {double(dx), double(dy), 1});
          const auto found = reference.crossings(line, 0, kForever);
          ASSERT_EQ(found.size() % 2, 0U);
          for (std::size_t i = 0; i < found.size(); ++i) EXPECT_EQ(found[i].back, i % 2 == 1);
          for (std::size_t i = 1; i < found.size(); ++i) tied += found[i - 1].high >= found[i].low ? 1 : 0;
        }
  EXPECT_GT(tied, 5) << "lines through edges and vertices, where the order is infinitesimal";
}

TEST(ExactReference, OneUnitInTheLastPlaceDecides) {
  EXPECT_TRUE(crossings(square(), {std::nextafter(2.0, 3.0), 1, 1}, {0, 0, -1}).empty());
  EXPECT_EQ(crossings(square(), {std::nextafter(2.0, 1.0), 1.5, 1}, {0, 0, -1}).size(), 1U);
}

TEST(ExactReference, EndsOnAFaceFallOnOneSideOfIt) {
  const Vec3d origin = {1, 0.25, 3}, direction = {0, 0, -2};
  for (const double t : {1.5, 1.25, 2.0}) {
    const std::size_t before = crossings(square(), origin, direction, 0, t).size();
    const std::size_t after = crossings(square(), origin, direction, t).size();
    EXPECT_EQ(before + after, 1U) << t;
    EXPECT_TRUE(crossings(square(), origin, direction, t, t).empty()) << "nothing lies between t and t";
  }
  EXPECT_EQ(crossings(square(), origin, direction, std::nextafter(1.5, 0), std::nextafter(1.5, 2)).size(),
            1U);
  // An origin on the face: in front of it or behind it, and a ray both ways crosses it once.
  const std::size_t up = crossings(square(), {1, 0.25, 0}, {0, 0, 1}).size();
  EXPECT_EQ(up + crossings(square(), {1, 0.25, 0}, {0, 0, -1}).size(), 1U);
}

TEST(ExactReference, ASideIsOffItsFace) {
  const ExactReference reference(square());
  const Surface& surface = reference.surface();
  const auto count = [&](double z, const Vec3d& direction) {
    Place place{{1, 0.25, 0}, surface.normal(surface.faces[0])};
    if (z < 0)
      for (auto& k : place.off) k = -k;
    return reference.crossings(ExactLine(surface, place, direction), 0, kForever).size();
  };
  EXPECT_EQ(count(1, {0, 0, 1}), 0U) << "leaves the face";
  EXPECT_EQ(count(1, {0, 0, -1}), 1U) << "goes into the face";
  EXPECT_EQ(count(-1, {0, 0, -1}), 0U);
  EXPECT_EQ(count(-1, {0, 0, 1}), 1U);
  // Along the plane, over the faces beside: the infinitesimal off the face exceeds those of the tie rule.
  for (const Vec3d& along : {Vec3d{0, 1, 0}, Vec3d{1, 0, 0}, Vec3d{-1, 1, 0}, Vec3d{0, 0.75, 0}}) {
    EXPECT_EQ(count(1, along), 0U);
    EXPECT_EQ(count(-1, along), 0U);
  }
  const Place front{{1, 0.25, 0}, surface.normal(surface.faces[0])};
  const auto between = [&](const Place& to) {
    return reference.crossings(ExactLine(surface, front, to), 0, 1).size();
  };
  EXPECT_EQ(between({{1, 1, 1}, {}}), 0U);
  EXPECT_EQ(between({{1, 1, -1}, {}}), 1U);
  EXPECT_EQ(between({{1, 1.75, 0}, {0, 0, 1}}), 0U) << "two places on one plane's front";
  EXPECT_EQ(between({{1, 1.75, 0}, {0, 0, -1}}), 1U) << "front and back";
}

TEST(ExactReference, TheBoxTreeLeavesNothingOut) {
  // Triangles with integer corners from 0 to 9, lines likewise: every kind of degeneracy, and boxes met
  // exactly at their faces, edges and corners.
  std::mt19937_64 random(7);
  const auto digit = [&] { return static_cast<float>(random() % 10); };
  std::vector<Vec3f> vertices;
  std::vector<Face> faces;
  std::set<Face> different;
  for (int i = 0; i < 60; ++i) vertices.push_back({digit(), digit(), digit()});
  while (faces.size() < 300) {
    const Face face = {static_cast<tetfmt::Index>(random() % 60), static_cast<tetfmt::Index>(random() % 60),
                       static_cast<tetfmt::Index>(random() % 60)};
    Face corners = face;
    std::sort(corners.begin(), corners.end());
    if (Surface(vertices, {face}).normal(face) != tetbench::GridPoint{} && different.insert(corners).second)
      faces.push_back(face);
  }
  const ExactReference reference(Surface(vertices, faces));
  std::size_t found = 0;
  for (int i = 0; i < 3000; ++i) {
    const Vec3d origin = {digit(), digit(), digit()};
    const Vec3d direction = {digit() - 4, digit() - 4, digit() - 4};
    if (direction == Vec3d{}) continue;
    const ExactLine line = from_point(reference.surface(), origin, direction);
    const auto fast = reference.crossings(line, 0, kForever);
    ASSERT_EQ(fast, reference.crossings_without_tree(line, 0, kForever)) << i;
    const auto first = reference.first_crossing(line, 0, kForever);
    ASSERT_EQ(first.size(), fast.empty() ? 0U : 1U);
    ASSERT_TRUE(fast.empty() || first[0] == fast[0]);
    // Order is antisymmetric and transitive, so that sorting means something.
    for (std::size_t a = 0; a < fast.size(); ++a)
      for (std::size_t b = a + 1; b < fast.size(); ++b)
        ASSERT_EQ(
            line.compare(reference.surface().faces[fast[a].face], reference.surface().faces[fast[b].face]),
            -1);
    found += fast.size();
  }
  EXPECT_GT(found, 10000U);
}

// ------------------------------------------------------------------------------- vertices that really move

Rational power_of_two(long exponent) {
  Rational result = 1, base = exponent < 0 ? Rational(1) / 2 : Rational(2);
  for (long n = std::abs(exponent); n > 0; n /= 2) {
    if (n % 2 == 1) result *= base;
    base *= base;
  }
  return result;
}

Point minus(const Point& a, const Point& b) {
  return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
}
Point cross(const Point& a, const Point& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
Rational dot(const Point& a, const Point& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/// A surface on a tiny lattice whose vertices are moved as the tie rule says, with e = 2^-bits.
struct Moved {
  std::vector<Point> vertices;
  Point origin, direction;
  Moved(const Surface& surface, const Vec3d& o, const Vec3d& d, long bits)
      : origin{o[0], o[1], o[2]}, direction{d[0], d[1], d[2]} {
    for (std::size_t i = 0; i < surface.vertices.size(); ++i) {
      const Vec3f& v = surface.vertices[i];
      Point p = {v.x, v.y, v.z};
      for (std::size_t k = 0; k < 3; ++k) p[k] += power_of_two(-(bits << (3 * i + k)));
      vertices.push_back(p);
    }
  }
  int crosses(const Face& face) const {
    int sum = 0;
    for (std::size_t k = 0; k < 3; ++k)
      sum += CGAL::sign(dot(
          direction, cross(minus(vertices[face[k]], origin), minus(vertices[face[(k + 1) % 3]], origin))));
    return sum == 3 ? 1 : sum == -3 ? -1 : 0;
  }
  Rational t(const Face& face) const {
    const Point a = minus(vertices[face[0]], origin), b = minus(vertices[face[1]], origin),
                c = minus(vertices[face[2]], origin);
    const Point normal = cross(minus(b, a), minus(c, a));
    return dot(normal, a) / dot(normal, direction);
  }
};

TEST(ExactReference, TiesAreThoseOfVerticesThatReallyMove) {
  std::mt19937_64 random(11);
  const auto digit = [&](int n) { return static_cast<float>(random() % static_cast<unsigned>(n)); };
  int crossed = 0, degenerate = 0, in_plane = 0, ordered = 0, at_origin = 0;
  for (int i = 0; i < 2000; ++i) {
    std::vector<Vec3f> vertices;
    for (int k = 0; k < 4; ++k) vertices.push_back({digit(3), digit(3), digit(3)});
    std::vector<Face> faces;
    for (const Face& face : {Face{0, 1, 2}, Face{3, 2, 1}, Face{0, 2, 3}})
      if (Surface(vertices, {face}).normal(face) != tetbench::GridPoint{}) faces.push_back(face);
    const Vec3d origin = {digit(3), digit(3), digit(3)};
    const Vec3d direction = {digit(3) - 1, digit(3) - 1, digit(3) - 1};
    if (faces.empty() || direction == Vec3d{}) continue;
    const Surface surface(vertices, faces);
    const ExactLine line = from_point(surface, origin, direction);
    const Moved moved(surface, origin, direction, 12);
    std::vector<Face> met;
    for (const Face& face : faces) {
      const int expected = moved.crosses(face);
      ASSERT_EQ(line.crosses(face), expected) << i;
      if (expected == 0) continue;
      ++crossed;
      degenerate += line.crosses_inside(face) ? 0 : 1;
      in_plane += line.sine(face) == 0 ? 1 : 0;
      const Rational t = moved.t(face);
      for (const double end : {0.0, 0.5, 1.0, 2.0}) {
        ASSERT_EQ(line.compare(face, end), CGAL::sign(t - Rational(end))) << i << " at " << end;
        const auto [low, high] = line.parameter(face);
        if (low <= end && high >= end) ++at_origin;
      }
      const Point& a = moved.vertices[face[0]];
      const Point from_origin = minus(a, moved.origin);
      const Point normal = cross(minus(moved.vertices[face[1]], a), minus(moved.vertices[face[2]], a));
      ASSERT_EQ(line.height(face), CGAL::sign(dot(normal, from_origin))) << i;
      const auto [low, high] = line.parameter(face);
      EXPECT_LE(std::abs(CGAL::to_double(t) - low), 1e-3) << i;
      EXPECT_LE(low, high);
      met.push_back(face);
    }
    for (std::size_t a = 0; a < met.size(); ++a)
      for (std::size_t b = 0; b < met.size(); ++b) {
        if (a == b) continue;
        ASSERT_EQ(line.compare(met[a], met[b]), CGAL::sign(moved.t(met[a]) - moved.t(met[b]))) << i;
        ++ordered;
      }
  }
  EXPECT_GT(crossed, 100);
  EXPECT_GT(degenerate, 50);
  EXPECT_EQ(in_plane, 0)
      << "all corners of a face move to the same side of its plane, so lines in it pass beside";
  EXPECT_GT(ordered, 20);
  EXPECT_GT(at_origin, 20);
}

TEST(ExactReference, ErrorsInUnitsOfTheLastPlace) {
  const Surface surface = square();
  const ExactLine line = from_point(surface, {1, 0.25, 1}, {0, 0, -3});  // t = 1 / 3, which no double holds
  const Face& face = surface.faces[0];
  EXPECT_NEAR(line.ulps_off(face, 1.0 / 3), 1.0 / 3, 1e-9);
  EXPECT_NEAR(line.ulps_off(face, std::nextafter(1.0 / 3, 0)), 4.0 / 3, 1e-9);
  const ExactLine exact = from_point(surface, {1, 0.25, 1}, {0, 0, -4});
  EXPECT_EQ(exact.ulps_off(face, 0.25), 0);
  const ExactLine on = from_point(surface, {1, 0.25, 0}, {0, 0, -4});
  EXPECT_EQ(on.ulps_off(face, 0), 0);
  EXPECT_EQ(on.ulps_off(face, 1e-300), kForever);
  // Where almost everything cancels: the origin one part in 2^50 over the plane z = x + y, at (1/4, 1/4).
  const Surface slope({{0, 0, 0}, {1, 0, 1}, {0, 1, 1}}, {{0, 1, 2}});
  const ExactLine near = from_point(slope, {0.25, 0.25, 0.5 + 0x1p-50}, {1, 1, 1});
  EXPECT_EQ(near.ulps_off(slope.faces[0], 0x1p-50), 0);
  EXPECT_NEAR(near.ulps_off(slope.faces[0], 0x1.8p-50), 0x1p51, 1);
}

TEST(ExactReference, DenormalAndFarNumbersAreNumbers) {
  const double tiny = std::numeric_limits<float>::denorm_min();
  EXPECT_EQ(crossings(square(), {1, 0.25, 3}, {0, 0, -tiny}).size(), 1U);
  EXPECT_EQ(crossings(square(), {1, 0.25, 3}, {tiny, tiny, -1}).size(), 1U);
  EXPECT_EQ(crossings(square(), {1, 1, 3e30}, {0, 0, -1}).size(), 1U);
  EXPECT_EQ(crossings(square(), {1, 1, 0x1p100}, {tiny, 0, -0x1p-20}).size(), 1U)
      << "2^-29 beside the vertex";
}

TEST(ExactReference, TetrahedraContainEachPointOnce) {
  // A cube's six tetrahedra around its diagonal: every point of the cube's inside, lattice points of edges
  // and faces between them included, is in exactly one.
  std::vector<Vec3f> vertices;
  for (int i = 0; i < 8; ++i)
    vertices.push_back({static_cast<float>(4 * (i & 1)), static_cast<float>(4 * (i >> 1 & 1)),
                        static_cast<float>(4 * (i >> 2))});
  const Surface surface(vertices, {{0, 1, 2}});
  const std::array<std::array<tetfmt::Index, 4>, 6> tets = {
      {{0, 1, 3, 7}, {0, 1, 5, 7}, {0, 2, 3, 7}, {0, 2, 6, 7}, {0, 4, 5, 7}, {0, 4, 6, 7}}};
  for (int x = 1; x < 4; ++x)
    for (int y = 1; y < 4; ++y)
      for (int z = 1; z < 4; ++z) {
        const ExactLine at = from_point(surface, {double(x), double(y), double(z)}, Vec3d{});
        EXPECT_EQ(std::count_if(tets.begin(), tets.end(), [&](const auto& tet) { return at.starts_in(tet); }),
                  1);
      }
  const ExactLine outside = from_point(surface, {5, 1, 1}, Vec3d{});
  EXPECT_TRUE(
      std::none_of(tets.begin(), tets.end(), [&](const auto& tet) { return outside.starts_in(tet); }));
}

TEST(ExactReference, CoordinatesOffEveryGridAreRefused) {
  EXPECT_THROW(Surface({{1, 0, 0}, {0x1p-40F, 0, 0}, {0, 1, 0}}, {{0, 1, 2}}), tetprep::Failure);
}

}  // namespace
}  // namespace tetfmt_test
