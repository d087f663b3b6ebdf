// SPDX-License-Identifier: AGPL-3.0-or-later
#include "prep/resolve.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <map>
#include <random>
#include <set>

#include "prep/box_tree.hpp"
#include "prep/nasty_surfaces.hpp"
#include "prep/prep_support.hpp"

namespace tetprep_test {
namespace {

using tetprep::CleanSurface;
using tetprep::ExitCode;
using tetprep::GridPoint;
using tetprep::kNone;
using tetprep::Point;
using tetprep::ResolveReport;
using tetprep::snap;
using Corners = std::array<Index, 3>;

std::vector<tetprep::TrianglePair> intersections(const CleanSurface& surface) {
  tetprep::IntersectionSearch search(surface, 2);
  return search.wait();
}

CleanSurface resolved(const CleanSurface& surface, ResolveReport& report, unsigned threads = 2) {
  tetprep::Progress progress;
  return tetprep::resolve(surface, intersections(surface), threads, progress, report);
}

Point minus(const Point& a, const Point& b) {
  return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
}
double dot(const Point& a, const Point& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}
Point cross(const Point& a, const Point& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
double length(const Point& a) {
  return std::sqrt(dot(a, a));
}

struct Triangle {
  Point a, b, c;
  Triangle(const CleanSurface& surface, const Corners& corners) {
    const auto at = [&](Index i) -> Point {
      const GridPoint& p = surface.points[i];
      return {static_cast<double>(p[0]), static_cast<double>(p[1]), static_cast<double>(p[2])};
    };
    a = at(corners[0]);
    b = at(corners[1]);
    c = at(corners[2]);
  }
  Point normal() const { return cross(minus(b, a), minus(c, a)); }
  double area() const { return length(normal()) / 2; }
  double perimeter() const { return length(minus(b, a)) + length(minus(c, b)) + length(minus(a, c)); }
  double distance(const Point& p) const {
    const Point n = normal();
    const double side = dot(cross(minus(b, a), minus(p, a)), n),
                 next = dot(cross(minus(c, b), minus(p, b)), n),
                 last = dot(cross(minus(a, c), minus(p, c)), n);
    if (side >= 0 && next >= 0 && last >= 0) return std::abs(dot(minus(p, a), n)) / length(n);
    const auto from_edge = [&](const Point& u, const Point& v) {
      const Point along = minus(v, u), aside = minus(p, u);
      const double share = std::clamp(dot(aside, along) / dot(along, along), 0.0, 1.0);
      return length(minus(aside, {along[0] * share, along[1] * share, along[2] * share}));
    };
    return std::min({from_edge(a, b), from_edge(b, c), from_edge(c, a)});
  }
};

/// How far points of the surface are from it at most: random points of each triangle that `before` has, to
/// the triangles of `after`.
double furthest(const CleanSurface& before, const CleanSurface& after, double look) {
  std::vector<Index> all(after.triangles.size());
  for (Index i = 0; i < all.size(); ++i) all[i] = i;
  const tetprep::BoxTree tree(std::move(all),
                              [&](Index t) { return tetprep::box_around(after.points, after.triangles[t]); });
  std::mt19937 random(7);
  double most = 0;
  for (const Corners& corners : before.triangles) {
    const Triangle t(before, corners);
    for (int i = 0; i < 5; ++i) {
      double u = std::ldexp(random(), -32), v = std::ldexp(random(), -32);
      if (u + v > 1) u = 1 - u, v = 1 - v;
      Point p{};
      tetprep::GridBox box;
      for (std::size_t k = 0; k < 3; ++k) {
        p[k] = t.a[k] + u * (t.b[k] - t.a[k]) + v * (t.c[k] - t.a[k]);
        box.low[k] = static_cast<std::int32_t>(std::floor(p[k] - look));
        box.high[k] = static_cast<std::int32_t>(std::ceil(p[k] + look));
      }
      double least = 1e9;
      tree.visit_leaves(box, 0, [&](std::size_t leaf) {
        for (std::size_t at = 0; at < tetprep::BoxTree::kWidth; ++at)
          if (const Index piece = tree.item(leaf, at); piece != kNone)
            least = std::min(least, Triangle(after, after.triangles[piece]).distance(p));
      });
      most = std::max(most, least);
    }
  }
  return most;
}

/// What CleanSurface and resolve() promise.
void expect_resolved(const CleanSurface& before, const CleanSurface& after, const ResolveReport& report) {
  const double step = std::ldexp(1.0, before.grid_exponent);
  const double deviation = report.max_deviation / step;
  EXPECT_EQ(after.grid_exponent, before.grid_exponent);
  EXPECT_EQ(after.origin, before.origin);
  EXPECT_LE(deviation, 16);
  EXPECT_TRUE(intersections(after).empty());

  EXPECT_EQ(std::set<GridPoint>(after.points.begin(), after.points.end()).size(), after.points.size());
  std::vector<bool> used(after.points.size(), false);
  std::set<Corners> places;
  for (Corners corners : after.triangles) {
    EXPECT_GT(Triangle(after, corners).area(), 0);
    for (const Index corner : corners) used[corner] = true;
    std::sort(corners.begin(), corners.end());
    EXPECT_TRUE(places.insert(corners).second) << "a triangle twice";
  }
  EXPECT_EQ(std::count(used.begin(), used.end(), false), 0) << "unused points";

  // Each piece near what it is a piece of, and facing the same way.
  std::map<Index, Corners> input;
  for (std::size_t t = 0; t < before.triangles.size(); ++t)
    input[before.input_triangle[t]] = before.triangles[t];
  std::map<Index, double> area, tolerance;
  ASSERT_EQ(after.input_triangle.size(), after.triangles.size());
  EXPECT_TRUE(std::is_sorted(after.input_triangle.begin(), after.input_triangle.end()));
  double astray = 0;
  std::size_t turned = 0;
  for (std::size_t i = 0; i < after.triangles.size(); ++i) {
    ASSERT_TRUE(input.contains(after.input_triangle[i]));
    const Triangle whole(before, input[after.input_triangle[i]]), piece(after, after.triangles[i]);
    for (const Point& corner : {piece.a, piece.b, piece.c}) astray = std::max(astray, whole.distance(corner));
    area[after.input_triangle[i]] += piece.area();
    tolerance[after.input_triangle[i]] += (deviation + 1) * piece.perimeter();
    // A piece that is thicker than what its corners moved cannot have turned over.
    const double thickness = 2 * piece.area() / piece.perimeter();
    const double wide = 2 * whole.area() / whole.perimeter();
    if (std::min(thickness, wide) > 4 * (deviation + 1)) turned += dot(piece.normal(), whole.normal()) <= 0;
  }
  EXPECT_LE(astray, deviation + 1);
  EXPECT_EQ(turned, 0u);
  for (const auto& [t, corners] : input) {
    const double whole = Triangle(before, corners).area();
    EXPECT_LE(area[t], whole + tolerance[t]) << t;
    if (report.overlaps == 0) {
      EXPECT_GE(area[t], whole - tolerance[t] - (deviation + 1) * Triangle(before, corners).perimeter()) << t;
    }
  }
  EXPECT_LE(furthest(before, after, 2 * deviation + 4), 2 * deviation + 2);

  // Corners of the input.
  if (report.intersecting_pairs == 0) return;
  ASSERT_EQ(after.input_corners.size(), before.input_triangle_count);
  for (Index t = 0; t < after.input_corners.size(); ++t) {
    const Corners& now = after.input_corners[t];
    const bool dropped = now == Corners{kNone, kNone, kNone};
    if (!input.contains(t)) {
      EXPECT_TRUE(dropped);
    } else if (!dropped) {
      const Triangle was(before, input[t]), is(after, now);
      EXPECT_GT(is.area(), 0);
      if (report.max_deviation == 0) {
        EXPECT_EQ(was.a, is.a);
        EXPECT_EQ(was.b, is.b);
        EXPECT_EQ(was.c, is.c);
      }
    } else {
      EXPECT_EQ(area.count(t), 1u);
      EXPECT_EQ(area[t], 0) << "pieces of a triangle that was dropped";
    }
  }
}

bool same(const CleanSurface& a, const CleanSurface& b) {
  return a.points == b.points && a.triangles == b.triangles && a.input_triangle == b.input_triangle &&
         a.input_corners == b.input_corners;
}

CleanSurface check(const TriangleSoup& soup, bool must_intersect = true) {
  const CleanSurface before = snap(soup);
  ResolveReport report;
  const CleanSurface after = resolved(before, report);
  if (must_intersect) {
    EXPECT_GT(report.intersecting_pairs, 0u);
    EXPECT_GT(report.rounds, 0);
  }
  expect_resolved(before, after, report);
  ResolveReport again;
  EXPECT_TRUE(same(resolved(before, again, 1), after)) << "not the same with one thread";
  EXPECT_EQ(again.max_deviation, report.max_deviation);
  EXPECT_EQ(again.overlaps, report.overlaps);
  return after;
}

/// Edges with an odd number of triangles.
std::size_t open_edges(const CleanSurface& surface) {
  std::map<std::array<Index, 2>, int> count;
  for (const Corners& t : surface.triangles)
    for (std::size_t i = 0; i < 3; ++i)
      ++count[{std::min(t[i], t[(i + 1) % 3]), std::max(t[i], t[(i + 1) % 3])}];
  return static_cast<std::size_t>(
      std::count_if(count.begin(), count.end(), [](const auto& edge) { return edge.second % 2 != 0; }));
}

TEST(Resolve, NothingToDo) {
  const CleanSurface before = snap(ball(5));
  ResolveReport report;
  EXPECT_TRUE(same(resolved(before, report), before));
  EXPECT_EQ(report.rounds, 0);
}

TEST(Resolve, TwoTrianglesThatCross) {
  TriangleSoup soup;
  soup.points = {{0, 0, 0}, {8, 0, 0}, {0, 8, 0}, {2, 2, -4}, {2, 2, 4}, {-4, -4, 4}, {0, 0, 9}};
  soup.triangles = {{0, 0, 1}, {2, 1, 0}, {3, 4, 5}, {0, 0, 0}};
  const CleanSurface before = snap(soup);
  ResolveReport report;
  const CleanSurface after = resolved(before, report);
  expect_resolved(before, after, report);
  EXPECT_EQ(report.intersecting_pairs, 1u);
  EXPECT_EQ(report.cut_triangles, 2u);
  EXPECT_EQ(report.max_deviation, 0) << "every crossing is a grid point here";
  EXPECT_EQ(after.input_corners[0], (Corners{kNone, kNone, kNone}));
  EXPECT_EQ(after.input_corners[1], (Corners{0, 1, 2})) << "points keep their numbers";
  EXPECT_EQ(after.input_corners[2], (Corners{3, 4, 5}));
}

TEST(Resolve, CrossingBallsStayClosed) {
  const TriangleSoup balls = join(ball(20), moved(ball(20), {0.7, 0.1, 0.2}));
  EXPECT_EQ(open_edges(check(balls)), 0u);
  EXPECT_EQ(open_edges(check(moved(balls, {2e4, 2e4, 2e4}))), 0u) << "far away";
  EXPECT_EQ(open_edges(check(join(balls, moved(ball(17), {0.3, 0.5, 0.1})))), 0u) << "three";
}

TEST(Resolve, OverlapsBelongToTheFirst) {
  TriangleSoup soup;
  soup.points = {{0, 0, 0}, {8, 0, 0}, {0, 8, 0}, {2, 2, 0}, {10, 2, 0}, {2, 10, 0}};
  soup.triangles = {{0, 1, 2}, {3, 4, 5}};
  const CleanSurface before = snap(soup);
  ResolveReport report;
  const CleanSurface after = resolved(before, report);
  expect_resolved(before, after, report);
  double first = 0, second = 0;
  for (std::size_t i = 0; i < after.triangles.size(); ++i)
    (after.input_triangle[i] == 0 ? first : second) += Triangle(after, after.triangles[i]).area();
  const double unit = std::ldexp(1.0, -2 * before.grid_exponent);
  EXPECT_DOUBLE_EQ(first, 32 * unit);
  EXPECT_DOUBLE_EQ(second, (32 - 8) * unit);  // they share a triangle of legs 4
  EXPECT_GT(report.overlaps, 0u);
}

TEST(Resolve, CoveredTrianglesKeepTheirCorners) {
  TriangleSoup soup;
  soup.points = {{0, 0, 0}, {8, 0, 0}, {0, 8, 0}, {1, 1, 0}, {3, 1, 0}, {1, 3, 0}};
  soup.triangles = {{0, 1, 2}, {3, 5, 4}};
  ResolveReport report;
  const CleanSurface after = resolved(snap(soup), report);
  EXPECT_EQ(std::count(after.input_triangle.begin(), after.input_triangle.end(), Index{1}), 0);
  EXPECT_EQ(after.input_corners[1], (Corners{3, 4, 5})) << "in order of first use";
}

TEST(Resolve, RandomTriangles) {
  check(random_triangles(60, 1));
  check(random_triangles(300, 0.3));
  check(random_triangles(1000, 0.12));
}

TEST(Resolve, CoplanarTriangles) {
  check(coplanar_triangles(1000, 0.04));
  check(coplanar_triangles(60, 0.7));
}

TEST(Resolve, Needles) {
  check(needle_fans(1e-6));
  TriangleSoup soup = needle_fans(1e-4);  // and a triangle across them all
  const auto first = static_cast<Index>(soup.points.size());
  soup.points.insert(soup.points.end(), {{0.5, -2, -0.3}, {0.4, 2, 0.2}, {0.6, 0.1, 1.5}});
  soup.triangles.push_back({first, first + 1, first + 2});
  check(soup);
}

TEST(Resolve, SpheresThatTouch) {
  check(nested_spheres(6, 8), false);
  check(touching_spheres(4, 8), false);
  check(touching_spheres(4, 9));
}

TEST(Resolve, CopiesAStepApart) {
  check(doubled(ball(12), {1, 0, 0}));
  check(doubled(ball(12), {1, 1, 1}));
  check(doubled(ball(12), {0, 2, 1}));
  check(doubled(ball(12), {5, 3, 1}));
}

TEST(Resolve, Sheets) {
  check(sheets(50, false), false);
  check(sheets(50, true));
}

TEST(Resolve, TinyComponents) {
  check(tiny_components(8000), false);
  check(tiny_components(300, true));
}

TEST(Resolve, ResultCanBeFilled) {
  for (const TriangleSoup& soup :
       {join(ball(10), moved(ball(10), {0.7, 0.1, 0.2})), random_triangles(100, 0.5), sheets(50, true),
        doubled(ball(8), {1, 1, 1})}) {
    ResolveReport report;
    CleanSurface surface = resolved(snap(soup), report);
    const tetprep::TetMesh mesh = fill(surface);
    expect_sound(surface, mesh);
  }
}

TEST(Resolve, TooManyPieces) {
  const CleanSurface surface = snap(random_triangles(100, 1));
  for (const std::size_t most : {std::size_t{200}, std::size_t{5000}}) {
    tetprep::Progress progress;
    ResolveReport report;
    const auto failure =
        failure_of([&] { tetprep::resolve(surface, intersections(surface), 2, progress, report, most); });
    EXPECT_EQ(failure.code(), ExitCode::unsupported);
    EXPECT_TRUE(mentions(failure.what(), {std::to_string(most), "triangle ", " at (", "meets"}));
  }
}

TEST(Resolve, ProgressGrows) {
  struct Watch : tetprep::Progress {
    void fraction(double done) override { told.push_back(done); }
    std::vector<double> told;
  } progress;
  const CleanSurface surface = snap(random_triangles(300, 0.3));
  ResolveReport report;
  tetprep::resolve(surface, intersections(surface), 1, progress, report);
  ASSERT_FALSE(progress.told.empty());
  EXPECT_TRUE(std::is_sorted(progress.told.begin(), progress.told.end()));
  EXPECT_GT(progress.told.front(), 0);
  EXPECT_LE(progress.told.back(), 1);
}

/// Those of CGAL's meshes that intersect themselves.
class ResolveReal : public FolderTest {};

TEST_F(ResolveReal, Meshes) {
  const std::filesystem::path archive = TETFMT_MESH_ARCHIVE;
  if (!std::filesystem::is_regular_file(archive))
    GTEST_SKIP() << "no real meshes here (Debian: libcgal-demo)";
  const std::string command = "tar -xzf '" + archive.string() + "' -C '" + path("") + "' data/meshes";
  ASSERT_EQ(std::system(command.c_str()), 0);
  for (const std::string name :
       {"ALSTOM_TEST4.off", "ChineseDragon-10kv.off", "anchor_dense.off", "b9_mesh.off", "bones.off",
        "bull.off", "camel.off", "cow.off", "degtri_sliding.off", "diplodocus.off", "elk.off", "man.off",
        "mannequin-devil.off", "mask_cone.off", "pig.off", "pig.stl", "polygon_mesh.off",
        "tetra_intersected_by_triangle.off", "triceratops.off"}) {
    SCOPED_TRACE(name);
    check(tetprep::read_soup(path("data/meshes/" + name)));
  }
}

}  // namespace
}  // namespace tetprep_test
