// SPDX-License-Identifier: AGPL-3.0-or-later
#include "prep/simplify.hpp"

#include <CGAL/Simple_cartesian.h>
#include <CGAL/squared_distance_3.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <limits>
#include <map>
#include <set>

#include "common/threads.hpp"
#include "prep/prep_support.hpp"
#include "sample/surface.hpp"

namespace tetprep_test {
namespace {

using tetprep::ExitCode;
using tetprep::kNone;
using tetprep::Point;
using tetprep::simplify;
using tetprep::SimplifyReport;
using Corners = std::array<Index, 3>;
using Kernel = CGAL::Simple_cartesian<double>;

TriangleSoup simplified(const TriangleSoup& soup, double error, SimplifyReport* report = nullptr) {
  tetprep::Progress progress;
  SimplifyReport own;
  SimplifyReport& used = report != nullptr ? *report : own;
  TriangleSoup result = simplify(soup, error, progress, used);
  EXPECT_EQ(used.triangles_before, soup.triangles.size());
  EXPECT_EQ(used.triangles_after, result.triangles.size());
  EXPECT_LE(used.max_deviation, error);
  // What is left is as an invariant of TriangleSoup says, without unused points, and points are where they
  // were.
  const std::set<Point> before(soup.points.begin(), soup.points.end());
  std::vector<bool> needed(result.points.size());
  for (const Corners& triangle : result.triangles)
    for (const Index v : triangle) needed.at(v) = true;
  EXPECT_TRUE(std::all_of(needed.begin(), needed.end(), [](bool n) { return n; }));
  for (const Point& p : result.points) EXPECT_TRUE(before.contains(p));
  const auto& look = result.appearance;
  EXPECT_TRUE(look.corners.empty() || look.corners.size() == result.triangles.size());
  for (const auto* of : {&look.triangle_material, &look.triangle_object})
    EXPECT_TRUE(of->empty() || of->size() == result.triangles.size());
  return result;
}

std::array<Point, 3> places(const TriangleSoup& soup, std::size_t t) {
  const auto& [a, b, c] = soup.triangles[t];
  return {soup.points[a], soup.points[b], soup.points[c]};
}

/// Every triangle by the places of its corners, the smallest one first, in its direction.
std::multiset<std::array<Point, 3>> shapes(const TriangleSoup& soup) {
  std::multiset<std::array<Point, 3>> result;
  for (std::size_t t = 0; t < soup.triangles.size(); ++t) {
    auto corners = places(soup, t);
    std::rotate(corners.begin(), std::min_element(corners.begin(), corners.end()), corners.end());
    result.insert(corners);
  }
  return result;
}

/// How often each directed edge occurs.
std::map<std::array<Point, 2>, int> edges(const TriangleSoup& soup) {
  std::map<std::array<Point, 2>, int> result;
  for (std::size_t t = 0; t < soup.triangles.size(); ++t)
    for (std::size_t k = 0; k < 3; ++k) ++result[{places(soup, t)[k], places(soup, t)[(k + 1) % 3]}];
  return result;
}

bool is_closed(const TriangleSoup& soup) {
  const auto all = edges(soup);
  return std::all_of(all.begin(), all.end(), [&](const auto& edge) {
    const auto back = all.find({edge.first[1], edge.first[0]});
    return edge.second == 1 && back != all.end() && back->second == 1;
  });
}

long euler(const TriangleSoup& soup) {
  return static_cast<long>(soup.points.size()) - static_cast<long>(edges(soup).size() / 2) +
         static_cast<long>(soup.triangles.size());
}

/// The largest distance from corners, edge midpoints and centroids of `of` to `from`: every point against
/// every triangle.
double distance(const TriangleSoup& of, const TriangleSoup& from) {
  const auto cgal = [](const Point& p) { return Kernel::Point_3(p[0], p[1], p[2]); };
  std::vector<Kernel::Triangle_3> triangles;
  for (std::size_t t = 0; t < from.triangles.size(); ++t) {
    const auto [a, b, c] = places(from, t);
    triangles.emplace_back(cgal(a), cgal(b), cgal(c));
  }
  double farthest = 0;
  for (std::size_t t = 0; t < of.triangles.size(); ++t) {
    const auto [a, b, c] = places(of, t);
    const std::array<Kernel::Point_3, 3> corner{cgal(a), cgal(b), cgal(c)};
    for (const auto& point :
         {corner[0], CGAL::midpoint(corner[0], corner[1]), CGAL::midpoint(corner[1], corner[2]),
          CGAL::midpoint(corner[2], corner[0]), CGAL::centroid(corner[0], corner[1], corner[2])}) {
      double nearest = std::numeric_limits<double>::infinity();
      for (const auto& triangle : triangles)
        nearest = std::min(nearest, CGAL::squared_distance(point, triangle));
      farthest = std::max(farthest, nearest);
    }
  }
  return std::sqrt(farthest);
}

/// A torus of radii 2 and 1, m x n squares of two triangles.
TriangleSoup torus(int m, int n) {
  TriangleSoup soup;
  const double turn = 8 * std::atan(1.0);
  for (int i = 0; i < m; ++i) {
    for (int j = 0; j < n; ++j) {
      const double u = turn * i / m, v = turn * j / n, r = 2 + std::cos(v);
      soup.points.push_back({r * std::cos(u), r * std::sin(u), std::sin(v)});
      const auto at = [&](int k, int l) { return static_cast<Index>((i + k) % m * n + (j + l) % n); };
      soup.triangles.push_back({at(0, 0), at(1, 0), at(1, 1)});
      soup.triangles.push_back({at(0, 0), at(1, 1), at(0, 1)});
    }
  }
  return soup;
}

/// n x n squares of two triangles each, in the plane that two axes span; the square (i, j) has triangles
/// 2 (i n + j) and the next.
TriangleSoup sheet(int n, const Point& u, const Point& v) {
  TriangleSoup soup;
  for (int i = 0; i <= n; ++i)
    for (int j = 0; j <= n; ++j)
      soup.points.push_back({u[0] * i + v[0] * j, u[1] * i + v[1] * j, u[2] * i + v[2] * j});
  for (int i = 0; i < n; ++i) {
    for (int j = 0; j < n; ++j) {
      const auto at = [&](int k, int l) { return static_cast<Index>((i + k) * (n + 1) + j + l); };
      soup.triangles.push_back({at(0, 0), at(1, 0), at(1, 1)});
      soup.triangles.push_back({at(0, 0), at(1, 1), at(0, 1)});
    }
  }
  return soup;
}

double area(const TriangleSoup& soup, std::size_t t) {
  const auto [a, b, c] = places(soup, t);
  const Kernel::Vector_3 u(b[0] - a[0], b[1] - a[1], b[2] - a[2]), v(c[0] - a[0], c[1] - a[1], c[2] - a[2]);
  return std::sqrt(CGAL::cross_product(u, v).squared_length()) / 2;
}

TEST(Simplify, KeepsClosedSurfacesClosedAndNear) {
  struct Case {
    const char* name;
    TriangleSoup soup;
    double error;
    long euler;
    std::size_t at_most;
  };
  for (const Case& each :
       {Case{"ball", ball(16), 0.02, 2, 3072 / 4}, Case{"torus", torus(48, 32), 0.05, 0, 3072 / 4},
        Case{"coarse ball", ball(16), 0.2, 2, 100}}) {
    SCOPED_TRACE(each.name);
    SimplifyReport report;
    const TriangleSoup result = simplified(each.soup, each.error, &report);
    EXPECT_LE(result.triangles.size(), each.at_most);
    EXPECT_EQ(report.skipped_triangles, 0u);
    EXPECT_TRUE(is_closed(result));
    EXPECT_EQ(euler(result), each.euler);
    const double measured = std::max(distance(each.soup, result), distance(result, each.soup));
    EXPECT_LE(measured, each.error);
    EXPECT_GT(report.max_deviation, 0);
    EXPECT_GE(report.max_deviation * (1 + 1e-9), measured) << "the report measures at these points too";
  }
}

TEST(Simplify, WorksFarFromTheOriginAndAtAnySize) {
  const TriangleSoup near = ball(12);
  const std::size_t expected = simplified(near, 0.03).triangles.size();
  for (const double scale : {1e-9, 1e9}) {
    TriangleSoup soup = near;
    for (Point& p : soup.points)
      for (double& x : p) x = (x + 1000) * scale;
    const TriangleSoup result = simplified(soup, 0.03 * scale);
    EXPECT_TRUE(is_closed(result));
    EXPECT_LT(result.triangles.size(), expected * 5 / 4);
  }
}

TEST(Simplify, JoinsTrianglesThatRepeatTheirPoints) {
  const TriangleSoup whole = ball(10);
  TriangleSoup loose;  // as an STL file has them
  for (std::size_t t = 0; t < whole.triangles.size(); ++t) {
    for (const Point& corner : places(whole, t)) loose.points.push_back(corner);
    const auto first = static_cast<Index>(3 * t);
    loose.triangles.push_back({first, first + 1, first + 2});
  }
  EXPECT_EQ(shapes(simplified(loose, 0.03)).size(), shapes(simplified(whole, 0.03)).size());
  EXPECT_TRUE(is_closed(simplified(loose, 0.03)));
}

TEST(Simplify, LeavesAloneWhatIsNotManifold) {
  // Three sheets that meet in a line.
  const TriangleSoup a = sheet(8, {1, 0, 0}, {0, 0, 1}), b = sheet(8, {0, 1, 0}, {0, 0, 1}),
                     c = sheet(8, {-1, -1, 0}, {0, 0, 1});
  const TriangleSoup soup = join(join(a, b), c);
  SimplifyReport report;
  const TriangleSoup result = simplified(soup, 0.01, &report);
  EXPECT_EQ(report.skipped_triangles, 24u) << "eight edges with three triangles each";
  EXPECT_LT(result.triangles.size(), soup.triangles.size() / 2) << "the rest of each sheet is flat";
  const auto left = shapes(result);
  for (std::size_t t = 0; t < soup.triangles.size(); ++t) {
    const auto corners = places(soup, t);
    const auto on_line =
        std::count_if(corners.begin(), corners.end(), [](const Point& p) { return p[0] == 0 && p[1] == 0; });
    if (on_line < 2) continue;
    auto shape = corners;
    std::rotate(shape.begin(), std::min_element(shape.begin(), shape.end()), shape.end());
    EXPECT_TRUE(left.contains(shape));
  }

  // Two balls that touch at one point, and a book of three pages: nothing there can go.
  TriangleSoup book = {{{0, 0, 0}, {0, 0, 1}, {1, 0, 0}, {0, 1, 0}, {-1, -1, 0}},
                       {{0, 1, 2}, {0, 1, 3}, {0, 1, 4}}};
  EXPECT_EQ(shapes(simplified(book, 0.5)), shapes(book));
  const TriangleSoup touching = join(ball(8), moved(ball(8), {2, 0, 0}));
  const TriangleSoup fewer = simplified(touching, 0.05);
  EXPECT_LT(fewer.triangles.size(), touching.triangles.size() / 2);
  EXPECT_TRUE(is_closed(fewer));
  EXPECT_EQ(std::count(fewer.points.begin(), fewer.points.end(), Point{1, 0, 0}), 2) << "where they touch";
}

TEST(Simplify, LeavesAloneTrianglesThatAreOrientedAgainstEachOther) {
  TriangleSoup soup = sheet(6, {1, 0, 0}, {0, 1, 0});
  for (std::size_t t = 0; t < soup.triangles.size(); t += 2)
    std::swap(soup.triangles[t][0], soup.triangles[t][1]);
  SimplifyReport report;
  EXPECT_EQ(shapes(simplified(soup, 0.1, &report)), shapes(soup));
  EXPECT_EQ(report.skipped_triangles, soup.triangles.size());
}

TEST(Simplify, KeepsBoundaries) {
  const TriangleSoup soup = sheet(12, {1, 0, 0.25}, {0, 1, 0.5});
  const TriangleSoup result = simplified(soup, 0.01);
  EXPECT_LE(result.triangles.size(), 60u) << "48 edges around, and few points inside";
  const auto boundary = [](const TriangleSoup& of) {
    std::set<std::array<Point, 2>> found;
    const auto all = edges(of);
    for (const auto& [edge, count] : all)
      if (!all.contains({edge[1], edge[0]})) found.insert(edge);
    return found;
  };
  EXPECT_EQ(boundary(result), boundary(soup));
}

TEST(Simplify, KeepsBordersBetweenMaterialsAndObjects) {
  const int n = 16;
  for (const bool by_material : {true, false}) {
    TriangleSoup soup = sheet(n, {1, 0, 0}, {0, 1, 0});
    std::vector<Index> part(soup.triangles.size());
    for (int i = 0; i < n; ++i)
      for (int j = 0; j < n; ++j)
        for (int k = 0; k < 2; ++k)
          part[static_cast<std::size_t>(2 * (i * n + j) + k)] =
              i + (j % 3) > n / 2 ? 1 : 0;  // a border with steps
    (by_material ? soup.appearance.triangle_material : soup.appearance.triangle_object) = part;
    const TriangleSoup result = simplified(soup, 0.2);
    EXPECT_LT(result.triangles.size(), soup.triangles.size() / 3);
    const auto& now = by_material ? result.appearance.triangle_material : result.appearance.triangle_object;
    std::array<double, 2> before{}, after{};
    for (std::size_t t = 0; t < soup.triangles.size(); ++t) before[part[t]] += area(soup, t);
    for (std::size_t t = 0; t < result.triangles.size(); ++t) after[now.at(t)] += area(result, t);
    EXPECT_NEAR(after[0], before[0], 1e-9);
    EXPECT_NEAR(after[1], before[1], 1e-9);
  }
}

TEST(Simplify, CarriesAttributesCornerByCorner) {
  const int n = 12;
  TriangleSoup soup = sheet(n, {1, 0, 0}, {0, 1, 0});
  auto& look = soup.appearance;
  // Texture coordinates are places times 2, right of x = 6 with another offset: a seam.
  for (int side = 0; side < 2; ++side)
    for (const Point& p : soup.points)
      look.texcoords.push_back({static_cast<float>(2 * p[0] + 100 * side), static_cast<float>(2 * p[1])});
  look.surface_points = look.texcoords.size();
  look.properties.push_back({"height", tetfmt::PropertyType::float64, {}});
  for (std::size_t i = 0; i < look.surface_points; ++i)
    look.properties[0].values.push_back(soup.points[i % soup.points.size()][1] + 7);
  for (std::size_t t = 0; t < soup.triangles.size(); ++t) {
    const auto shift = static_cast<Index>(t < soup.triangles.size() / 2 ? 0 : soup.points.size());
    look.corners.push_back(
        {soup.triangles[t][0] + shift, soup.triangles[t][1] + shift, soup.triangles[t][2] + shift});
  }
  const TriangleSoup result = simplified(soup, 0.1);
  const auto& now = result.appearance;
  EXPECT_LT(result.triangles.size(), soup.triangles.size() / 2);
  EXPECT_LT(now.surface_points, look.surface_points);
  EXPECT_EQ(now.texcoords.size(), now.surface_points);
  EXPECT_EQ(now.properties.at(0).values.size(), now.surface_points);
  ASSERT_EQ(now.corners.size(), result.triangles.size());
  for (std::size_t t = 0; t < result.triangles.size(); ++t) {
    const auto corners = places(result, t);
    const bool right = corners[0][0] + corners[1][0] + corners[2][0] > 18;
    for (std::size_t k = 0; k < 3; ++k) {
      const Index point = now.corners[t][k];
      ASSERT_LT(point, now.surface_points);
      EXPECT_EQ(now.texcoords[point][0], static_cast<float>(2 * corners[k][0] + (right ? 100 : 0)));
      EXPECT_EQ(now.texcoords[point][1], static_cast<float>(2 * corners[k][1]));
      EXPECT_EQ(now.properties[0].values[point], corners[k][1] + 7);
    }
  }
}

TEST(Simplify, ChangesNothingWhereNothingIsToSpare) {
  const TriangleSoup soup = ball(8);
  SimplifyReport report;
  EXPECT_EQ(shapes(simplified(soup, 1e-9, &report)), shapes(soup));
  EXPECT_EQ(report.max_deviation, 0);
  EXPECT_EQ(shapes(simplified(cube({0, 0, 0}, 1), 0.01)), shapes(cube({0, 0, 0}, 1)));
}

TEST(Simplify, IsTheSameForAnyNumberOfThreads) {
  const TriangleSoup soup = torus(40, 30);
  TriangleSoup one, three;
  tetprep::with_threads(1, [&] { one = simplified(soup, 0.03); });
  tetprep::with_threads(3, [&] { three = simplified(soup, 0.03); });
  EXPECT_EQ(one.triangles, three.triangles);
  EXPECT_EQ(one.points, three.points);
}

TEST(Simplify, RefusesErrorsThatAreNone) {
  tetprep::Progress progress;
  SimplifyReport report;
  for (const double error : {0.0, -1.0, std::nan(""), std::numeric_limits<double>::infinity()})
    EXPECT_EQ(failure_of([&] { simplify(ball(3), error, progress, report); }).code(), ExitCode::usage);
}

class SimplifyReal : public FolderTest {};

TEST_F(SimplifyReal, ATenthOfAPercentMakesAScanMuchSmaller) {
  TriangleSoup soup;
  const std::filesystem::path archive = TETFMT_MESH_ARCHIVE;
  if (std::filesystem::is_regular_file(archive)) {
    const std::string command =
        "tar -xzf '" + archive.string() + "' -C '" + path("") + "' data/meshes/dino.off";
    ASSERT_EQ(std::system(command.c_str()), 0);
    soup = tetprep::read_soup(path("data/meshes/dino.off"));
  } else {
    for (const tetprep::SurfaceKind& kind : tetprep::surface_kinds()) {
      if (std::string(kind.name) != "torus-knot") continue;
      const tetprep::Surface surface = kind.make(8000, 1);
      for (const auto& [x, y, z] : surface.points) soup.points.push_back({x, y, z});
      soup.triangles = surface.triangles;
    }
  }
  Point low = soup.points.front(), high = low;
  for (const Point& p : soup.points) {
    for (std::size_t k = 0; k < 3; ++k) {
      low[k] = std::min(low[k], p[k]);
      high[k] = std::max(high[k], p[k]);
    }
  }
  const double error = 1e-3 * std::hypot(high[0] - low[0], high[1] - low[1], high[2] - low[2]);
  EXPECT_LT(simplified(soup, error).triangles.size(), soup.triangles.size() / 2);
}

}  // namespace
}  // namespace tetprep_test
