// SPDX-License-Identifier: AGPL-3.0-or-later
// From the polygons that a file lists to triangles.
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Polygon_mesh_processing/triangulate_hole.h>
#include <CGAL/utility.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "prep/read_soup.hpp"
#include "prep/surface_points.hpp"

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

/// Cuts polygons. Triangles come as positions along the polygon.
class Triangulator {
 public:
  explicit Triangulator(const std::vector<Point>& points) : points_(points) {}

  /// The triangles of a polygon with three corners or more; valid until the next call.
  const std::vector<std::array<std::size_t, 3>>& cut(const std::vector<Index>& polygon) {
    triangles_.clear();
    if (polygon.size() == 4) {
      cut_quad(polygon);
    } else if (polygon.size() > 4) {
      cut_large(polygon);
    } else {
      triangles_.push_back({0, 1, 2});
    }
    return triangles_;
  }

 private:
  /// By the shorter diagonal, unless that one lies outside of the quadrilateral.
  void cut_quad(const std::vector<Index>& q) {
    const auto at = [&](std::size_t i) { return points_[q[i % 4]]; };
    const auto inside = [&](std::size_t i) {  // the diagonal from corner i to corner i + 2
      return dot(normal(at(i), at(i + 1), at(i + 2)), normal(at(i), at(i + 2), at(i + 3))) > 0;
    };
    const bool even_is_shorter = squared_distance(at(0), at(2)) <= squared_distance(at(1), at(3));
    const bool even = even_is_shorter ? inside(0) || !inside(1) : inside(0) && !inside(1);
    if (even)
      triangles_ = {{0, 1, 2}, {0, 2, 3}};
    else
      triangles_ = {{0, 1, 3}, {1, 2, 3}};
  }

  /// Not as a fan: the fan of a concave polygon overlaps itself.
  void cut_large(const std::vector<Index>& polygon) {
    loop_.clear();
    pieces_.clear();
    // For a polygon that is not flat CGAL searches all triangulations, which takes time in the cube of its
    // corners. Large ones are cut as their shadows on the coordinate plane that they face most.
    constexpr std::size_t kMostSearched = 64;
    const bool search = polygon.size() <= kMostSearched;
    const std::size_t dropped = search ? 3 : facing(polygon);
    for (const Index i : polygon) {
      Point p = points_[i];
      if (!search) p[dropped] = 0;
      loop_.emplace_back(p[0], p[1], p[2]);
    }
    CGAL::Polygon_mesh_processing::triangulate_hole_polyline(
        loop_, std::back_inserter(pieces_),
        CGAL::parameters::use_2d_constrained_delaunay_triangulation(true)
            .use_delaunay_triangulation(search)
            .do_not_use_cubic_algorithm(!search));
    if (pieces_.size() != polygon.size() - 2) {  // all corners on a line, or a large one that crosses itself
      pieces_.clear();
      for (int i = 2; i < static_cast<int>(polygon.size()); ++i) pieces_.emplace_back(0, i - 1, i);
    }
    for (const auto& piece : pieces_) {
      // Positions along the polygon that ascend run around it the way that the polygon does.
      triangles_.push_back({static_cast<std::size_t>(piece.first), static_cast<std::size_t>(piece.second),
                            static_cast<std::size_t>(piece.third)});
      std::sort(triangles_.back().begin(), triangles_.back().end());
    }
    std::sort(triangles_.begin(), triangles_.end());
  }

  /// The axis along which a polygon's area is largest (Newell's normal).
  std::size_t facing(const std::vector<Index>& polygon) const {
    Point sum{};
    const Point& origin = points_[polygon[0]];
    for (std::size_t i = 2; i < polygon.size(); ++i) {
      const Point n = normal(origin, points_[polygon[i - 1]], points_[polygon[i]]);
      for (std::size_t k = 0; k < 3; ++k) sum[k] += n[k];
    }
    std::size_t axis = 0;
    for (std::size_t k = 1; k < 3; ++k)
      if (std::abs(sum[k]) > std::abs(sum[axis])) axis = k;
    return axis;
  }

  const std::vector<Point>& points_;
  std::vector<std::array<std::size_t, 3>> triangles_;
  std::vector<Kernel::Point_3> loop_;
  std::vector<CGAL::Triple<int, int, int>> pieces_;
};

/// The polygons of one file on their way to triangles.
class Builder {
 public:
  Builder(const SourceFile& file, PolygonSoup& soup)
      : file_(file), soup_(soup), surface_points_(soup), triangulator_(soup.points) {}

  TriangleSoup build() {
    TriangleSoup out;
    Appearance& appearance = out.appearance;
    out.triangles.reserve(soup_.ends.size());
    if (surface_points_.any()) appearance.corners.reserve(soup_.ends.size());
    std::size_t begin = 0;
    for (std::size_t face = 0; face < soup_.ends.size(); ++face) {
      take_polygon(face, begin);
      begin = soup_.ends[face];
      for (const auto& [a, b, c] : triangulator_.cut(polygon_)) {
        out.triangles.push_back({polygon_[a], polygon_[b], polygon_[c]});
        if (surface_points_.any()) appearance.corners.push_back({values_[a], values_[b], values_[c]});
        if (!soup_.face_materials.empty()) appearance.triangle_material.push_back(soup_.face_materials[face]);
        if (!soup_.face_objects.empty()) appearance.triangle_object.push_back(soup_.face_objects[face]);
      }
    }
    surface_points_.fill(appearance);
    if (appearance.surface_points == 0) {
      appearance.corners.clear();
      appearance.properties.clear();
    }
    out.points = std::move(soup_.points);
    out.warnings = std::move(soup_.warnings);
    finish(appearance);
    return out;
  }

 private:
  /// Checks polygon `face`, whose corners start at `begin`, and makes it the current one.
  void take_polygon(std::size_t face, std::size_t begin) {
    const std::size_t line = face < soup_.lines.size() ? soup_.lines[face] : 0;
    const std::size_t count = soup_.ends[face] - begin;
    if (count < 3)
      file_.fail(line, counted("face", face) + " has " + std::to_string(count) + " corners, not 3 or more");
    polygon_.clear();
    values_.clear();
    for (std::size_t corner = begin; corner < soup_.ends[face]; ++corner) {
      const std::uint64_t point = soup_.corners[corner];
      if (point >= soup_.points.size())
        file_.fail(line, counted("face", face) + " refers to point " + std::to_string(point) +
                             " (counted from 0), but there are only " + std::to_string(soup_.points.size()));
      for (const double coordinate : soup_.points[point]) {
        if (std::isfinite(coordinate)) continue;
        file_.fail(point < soup_.point_lines.size() ? soup_.point_lines[point] : 0,
                   counted("point", point) + " has a coordinate that is " +
                       (std::isnan(coordinate) ? "not a number" : "infinite"));
      }
      polygon_.push_back(static_cast<Index>(point));
      if (surface_points_.any()) values_.push_back(surface_points_.at(corner));
    }
  }

  void finish(Appearance& appearance) {
    appearance.materials = std::move(soup_.materials);
    if (appearance.materials.empty()) appearance.triangle_material.clear();
    if (soup_.objects.size() < 2) appearance.triangle_object.clear();
    // Triangles without a material among others that have one: a material that says nothing is theirs.
    const auto none = static_cast<Index>(appearance.materials.size());
    bool used = false;
    for (Index& material : appearance.triangle_material) {
      if (material != kNone) continue;
      material = none;
      used = true;
    }
    if (used) appearance.materials.emplace_back();
    if (appearance.materials.size() < 2) appearance.triangle_material.clear();

    const std::string source = std::filesystem::path(file_.path).filename().string();
    for (std::string& name : soup_.objects) appearance.objects.push_back({std::move(name), source});
    if (appearance.objects.empty()) appearance.objects.push_back({{}, source});
  }

  const SourceFile& file_;
  PolygonSoup& soup_;
  SurfacePoints surface_points_;
  Triangulator triangulator_;
  std::vector<Index> polygon_, values_;  ///< points and surface points of the current polygon
};

}  // namespace

TriangleSoup triangulate(const SourceFile& file, PolygonSoup soup) {
  constexpr std::size_t kMost = 0x7FFFFFFE;  // Index, minus the values with bit 31
  if (soup.ends.empty())
    file.fail(0, soup.points.empty() ? "no mesh in it" : "points without faces: there is no surface in it");
  if (soup.points.size() > kMost || soup.corners.size() > kMost)
    file.unsupported(0, "more than 2^31 points or face corners");
  return Builder(file, soup).build();
}

}  // namespace tetprep
