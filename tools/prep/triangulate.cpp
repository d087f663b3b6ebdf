// SPDX-License-Identifier: AGPL-3.0-or-later
// From the polygons that a file lists to triangles.
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Polygon_mesh_processing/triangulate_hole.h>
#include <CGAL/utility.h>

#include <algorithm>
#include <cmath>

#include "prep/read_soup.hpp"

namespace tetprep {
namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;

Point normal(const Point& a, const Point& b, const Point& c) {
  const Point u{b[0] - a[0], b[1] - a[1], b[2] - a[2]}, v{c[0] - a[0], c[1] - a[1], c[2] - a[2]};
  return {u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]};
}

double dot(const Point& a, const Point& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

double squared_distance(const Point& a, const Point& b) {
  const Point d{a[0] - b[0], a[1] - b[1], a[2] - b[2]};
  return dot(d, d);
}

class Triangulator {
 public:
  Triangulator(const std::vector<Point>& points, TriangleSoup& out) : points_(points), out_(out) {}

  void add(const std::vector<Index>& polygon) {
    if (polygon.size() == 4) {
      add_quad(polygon);
    } else if (polygon.size() > 4) {
      add_large(polygon);
    } else {
      out_.triangles.push_back({polygon[0], polygon[1], polygon[2]});
    }
  }

 private:
  /// By the shorter diagonal, unless that one lies outside of the quadrilateral.
  void add_quad(const std::vector<Index>& q) {
    const auto at = [&](std::size_t i) { return points_[q[i % 4]]; };
    const auto inside = [&](std::size_t i) {  // the diagonal from corner i to corner i + 2
      return dot(normal(at(i), at(i + 1), at(i + 2)), normal(at(i), at(i + 2), at(i + 3))) > 0;
    };
    const bool even_is_shorter = squared_distance(at(0), at(2)) <= squared_distance(at(1), at(3));
    const bool even = even_is_shorter ? inside(0) || !inside(1) : inside(0) && !inside(1);
    if (even) {
      out_.triangles.push_back({q[0], q[1], q[2]});
      out_.triangles.push_back({q[0], q[2], q[3]});
    } else {
      out_.triangles.push_back({q[0], q[1], q[3]});
      out_.triangles.push_back({q[1], q[2], q[3]});
    }
  }

  /// Not as a fan: the fan of a concave polygon overlaps itself.
  void add_large(const std::vector<Index>& polygon) {
    loop_.clear();
    for (const Index i : polygon) loop_.emplace_back(points_[i][0], points_[i][1], points_[i][2]);
    pieces_.clear();
    CGAL::Polygon_mesh_processing::triangulate_hole_polyline(
        loop_, std::back_inserter(pieces_),
        CGAL::parameters::use_2d_constrained_delaunay_triangulation(true));
    if (pieces_.size() != polygon.size() - 2) {  // all corners on a line, or in one point
      pieces_.clear();
      for (int i = 2; i < static_cast<int>(polygon.size()); ++i) pieces_.emplace_back(0, i - 1, i);
    }
    std::vector<std::array<int, 3>> sorted;
    for (const auto& piece : pieces_) {
      // Positions along the polygon that ascend run around it the way that the polygon does.
      std::array<int, 3> corners{piece.first, piece.second, piece.third};
      std::sort(corners.begin(), corners.end());
      sorted.push_back(corners);
    }
    std::sort(sorted.begin(), sorted.end());
    for (const auto& c : sorted) {
      out_.triangles.push_back({polygon[static_cast<std::size_t>(c[0])],
                                polygon[static_cast<std::size_t>(c[1])],
                                polygon[static_cast<std::size_t>(c[2])]});
    }
  }

  const std::vector<Point>& points_;
  TriangleSoup& out_;
  std::vector<Kernel::Point_3> loop_;
  std::vector<CGAL::Triple<int, int, int>> pieces_;
};

}  // namespace

TriangleSoup triangulate(const SourceFile& file, const PolygonSoup& soup) {
  constexpr std::size_t kMost = 0x7FFFFFFE;  // Index, minus the values with bit 31
  if (soup.ends.empty())
    file.fail(0, soup.points.empty() ? "no mesh in it" : "points without faces: there is no surface in it");
  if (soup.points.size() > kMost || soup.corners.size() > kMost)
    throw Failure(ExitCode::unsupported, file.path + ": more than 2^31 points or face corners");

  const auto face_name = [](std::size_t face) {
    return "face " + std::to_string(face) + " (counted from 0)";
  };
  TriangleSoup out;
  out.points = soup.points;
  out.triangles.reserve(soup.ends.size());
  Triangulator triangulator(out.points, out);
  std::vector<Index> polygon;
  std::size_t begin = 0;
  for (std::size_t face = 0; face < soup.ends.size(); ++face) {
    const std::size_t line = face < soup.lines.size() ? soup.lines[face] : 0;
    const std::size_t count = soup.ends[face] - begin;
    if (count < 3)
      file.fail(line, face_name(face) + " has " + std::to_string(count) + " corners, not 3 or more");
    polygon.clear();
    for (; begin < soup.ends[face]; ++begin) {
      const std::uint64_t point = soup.corners[begin];
      if (point >= soup.points.size())
        file.fail(line, face_name(face) + " refers to point " + std::to_string(point) +
                            " (counted from 0), but there are only " + std::to_string(soup.points.size()));
      for (const double coordinate : soup.points[point]) {
        if (std::isfinite(coordinate)) continue;
        file.fail(point < soup.point_lines.size() ? soup.point_lines[point] : 0,
                  "point " + std::to_string(point) + " (counted from 0) has a coordinate that is " +
                      (std::isnan(coordinate) ? "not a number" : "infinite"));
      }
      polygon.push_back(static_cast<Index>(point));
    }
    triangulator.add(polygon);
  }
  return out;
}

}  // namespace tetprep
