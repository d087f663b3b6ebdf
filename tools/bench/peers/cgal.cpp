// SPDX-License-Identifier: AGPL-3.0-or-later
// CGAL's AABB tree with exact predicates: the careful peer.
#include <CGAL/AABB_traits.h>
#include <CGAL/AABB_tree.h>
#include <CGAL/AABB_triangle_primitive.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/version.h>

#include <cmath>

#include "bench/statistics.hpp"
#include "bench/tracer.hpp"

namespace tetbench {
namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Triangles = std::vector<Kernel::Triangle_3>;
using Primitive = CGAL::AABB_triangle_primitive<Kernel, Triangles::const_iterator>;
using Traits = CGAL::AABB_traits<Kernel, Primitive>;
using Tree = CGAL::AABB_tree<Traits>;

Kernel::Point_3 point(const tetfmt::Vec3f& p) {
  return {double{p.x}, double{p.y}, double{p.z}};
}

/// Triangles without an area have no place in it.
struct CgalTree {
  Triangles triangles;
  std::vector<tetfmt::Index> numbers;
  Tree tree;
  Structure structure;

  explicit CgalTree(const PeerMesh& mesh) {
    structure.name = "CGAL AABB tree";
    structure.version = CGAL_VERSION_STR;
    structure.build_seconds = process_seconds([&] {
      for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
        const auto corners = mesh.corners(i);
        const Kernel::Triangle_3 triangle(point(corners[0]), point(corners[1]), point(corners[2]));
        if (triangle.is_degenerate()) continue;
        triangles.push_back(triangle);
        numbers.push_back(mesh.numbers[i]);
      }
      tree.insert(triangles.begin(), triangles.end());
      tree.build();
    });
    // It does not tell; what it is made of, by its headers: a node less than triangles, a primitive each.
    structure.bytes = triangles.size() * (sizeof(Kernel::Triangle_3) + sizeof(tetfmt::Index) +
                                          sizeof(Primitive) + sizeof(CGAL::AABB_node<Traits>));
  }
};

class CgalTracer : public Tracer {
 public:
  explicit CgalTracer(std::shared_ptr<const CgalTree> tree) : cgal_(std::move(tree)) {}
  const Structure& structure() const override { return cgal_->structure; }
  std::size_t most_rays() const override { return 100000; }

  void trace(const RayList& rays, Answers& answers) const override {
    for (std::size_t i = 0; i < rays.size(); ++i) {
      const PeerRay ray = rays.peer(i);
      const auto at = [&](float t) {
        const auto along = [t](float o, float d) { return double{o} + double{t} * double{d}; };
        return Kernel::Point_3(along(ray.origin.x, ray.direction.x), along(ray.origin.y, ray.direction.y),
                               along(ray.origin.z, ray.direction.z));
      };
      const Kernel::Point_3 start = at(ray.t_min);
      const Kernel::Ray_3 line(
          start, Kernel::Vector_3(double{ray.direction.x}, double{ray.direction.y}, double{ray.direction.z}));
      if (!rays.occlusion) {
        const auto found = cgal_->tree.first_intersected_primitive(line);
        answers[i] = found ? cgal_->numbers[static_cast<std::size_t>(*found - cgal_->triangles.begin())]
                           : tetfmt::kNone;
      } else {
        const bool blocked = std::isinf(ray.t_max)
                                 ? cgal_->tree.do_intersect(line)
                                 : cgal_->tree.do_intersect(Kernel::Segment_3(start, at(ray.t_max)));
        answers[i] = blocked ? kBlocked : tetfmt::kNone;
      }
    }
  }

 private:
  std::shared_ptr<const CgalTree> cgal_;
};

}  // namespace

void add_cgal(std::vector<TracerKind>& kinds) {
  kinds.push_back({"cgal", "CGAL's AABB tree with exact predicates; asked at most 100,000 rays", Family::cgal,
                   false, [](Structures& s) {
                     return std::make_unique<CgalTracer>(s.once<CgalTree>("CGAL AABB tree", s.mesh));
                   }});
}

}  // namespace tetbench
