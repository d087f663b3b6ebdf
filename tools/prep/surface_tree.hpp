// SPDX-License-Identifier: AGPL-3.0-or-later
// CGAL's box tree over a surface.
#pragma once

#include <CGAL/AABB_traits.h>
#include <CGAL/AABB_tree.h>
#include <CGAL/AABB_triangle_primitive.h>
#include <CGAL/Simple_cartesian.h>

#include <array>
#include <vector>

#include "prep/prep.hpp"

namespace tetprep {

using Kernel = CGAL::Simple_cartesian<double>;

inline Kernel::Point_3 cgal_point(const Point& p) {
  return {p[0], p[1], p[2]};
}

/// Distances to a surface that has at least one triangle. Threads may ask at the same time.
class SurfaceTree {
 public:
  explicit SurfaceTree(std::vector<Kernel::Triangle_3> triangles)
      : triangles_(std::move(triangles)), tree_(triangles_.begin(), triangles_.end()) {
    tree_.build();
  }
  SurfaceTree(const SurfaceTree&) = delete;
  SurfaceTree& operator=(const SurfaceTree&) = delete;

  using Nearest = std::vector<Kernel::Triangle_3>::const_iterator;
  Nearest any() const { return triangles_.begin(); }

  /// Squared distance of `point`. `nearest`: a triangle to start from, the better the nearer; then the
  /// nearest.
  double squared_distance(const Kernel::Point_3& point, Nearest& nearest) const {
    const auto project = Kernel().construct_projected_point_3_object();
    const auto found = tree_.closest_point_and_primitive(point, {project(*nearest, point), nearest});
    nearest = found.second;
    return CGAL::squared_distance(point, found.first);
  }

  bool is_within(const Kernel::Point_3& point, double squared_distance) const {
    return tree_.do_intersect(Kernel::Sphere_3(point, squared_distance));
  }

 private:
  using Primitive = CGAL::AABB_triangle_primitive<Kernel, Nearest>;
  std::vector<Kernel::Triangle_3> triangles_;
  CGAL::AABB_tree<CGAL::AABB_traits<Kernel, Primitive>> tree_;
};

}  // namespace tetprep
