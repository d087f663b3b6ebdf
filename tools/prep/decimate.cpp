// SPDX-License-Identifier: AGPL-3.0-or-later
#include "prep/decimate.hpp"

#include <OpenMesh/Core/Mesh/TriMesh_ArrayKernelT.hh>
#include <OpenMesh/Tools/Decimater/DecimaterT.hh>
#include <OpenMesh/Tools/Decimater/ModBaseT.hh>
#include <OpenMesh/Tools/Decimater/ModQuadricT.hh>  // for the quadrics: their own header lacks an include
#include <OpenMesh/Tools/Decimater/Observer.hh>

#include <CGAL/squared_distance_3.h>

#include <algorithm>
#include <limits>
#include <numeric>

#include "prep/deviation.hpp"
#include "prep/surface_tree.hpp"

namespace tetprep {
namespace {

struct Traits : OpenMesh::DefaultTraits {
  using Point = OpenMesh::Vec3d;
  using Normal = OpenMesh::Vec3d;
};
using HalfedgeMesh = OpenMesh::TriMesh_ArrayKernelT<Traits>;
using Vector = OpenMesh::Vec3d;
using Handle = HalfedgeMesh::VertexHandle;

/// cos of 78 degrees: how far a triangle may turn in one collapse. Further, it is about to fold.
constexpr double kLeastCosine = 0.2;

Kernel::Point_3 cgal(const Vector& v) {
  return {v[0], v[1], v[2]};
}

Vector doubled_area(const std::array<Vector, 3>& corner) {
  return (corner[1] - corner[0]) % (corner[2] - corner[0]);
}

/// Decides which collapses are allowed and which comes first. Also keeps the triangles by their corners,
/// since OpenMesh has no place for what belongs to a corner.
class Judge : public OpenMesh::Decimater::ModBaseT<HalfedgeMesh> {
 public:
  using Base = OpenMesh::Decimater::ModBaseT<HalfedgeMesh>;
  using CollapseInfo = Base::CollapseInfo;
  DECIMATER_MODNAME(Judge)
  explicit Judge(HalfedgeMesh& halfedges) : Base(halfedges, false), mesh_(halfedges) {}

  void set(ManifoldSurface& surface, const SurfaceTree& tree, double spacing) {
    surface_ = &surface;
    tree_ = &tree;
    spacing_ = spacing;
  }

  void initialize() override {
    quadrics_.assign(surface_->vertices.size(), OpenMesh::Geometry::Quadricd(0, 0, 0, 0));
    samples_.resize(surface_->triangles.size());
    moved_to_.resize(surface_->vertices.size());
    std::iota(moved_to_.begin(), moved_to_.end(), Index{0});
    for (std::size_t f = 0; f < surface_->triangles.size(); ++f) {
      const auto& triangle = surface_->triangles[f];
      sample(f);
      const auto corner = corners(triangle, Handle(), Vector());
      Vector normal = doubled_area(corner);
      const double area = normal.norm();
      if (!(area > 0)) continue;
      normal /= area;
      OpenMesh::Geometry::Quadricd quadric(normal[0], normal[1], normal[2], -(normal | corner[0]));
      quadric *= area / 2;
      for (const Index v : triangle) quadrics_[v] += quadric;
    }
  }

  float collapse_priority(const CollapseInfo& info) override {
    constexpr auto kNever = static_cast<float>(Base::ILLEGAL_COLLAPSE);
    Index mark = 0;
    if (!new_mark(info, mark)) return kNever;
    auto quadric = quadrics_[index(info.v0)];
    quadric += quadrics_[index(info.v1)];
    const auto cost = static_cast<float>(std::max(0.0, quadric(info.p1)));
    // The decimater asks for all edges of a vertex in a row and takes the cheapest: no need to look at
    // others.
    if (last_ != info.v0) {
      last_ = info.v0;
      cheapest_ = std::numeric_limits<float>::infinity();
    }
    if (cost >= cheapest_ || !stays_near(info)) return kNever;
    cheapest_ = cost;
    return cost;
  }

  void preprocess_collapse(const CollapseInfo& info) override {
    Index mark = 0;
    new_mark(info, mark);
    moved_to_[index(info.v0)] = index(info.v1);
    for (const auto face : mesh_.vf_range(info.v0)) {
      const auto f = static_cast<std::size_t>(face.idx());
      auto& triangle = surface_->triangles[f];
      if (face == info.fl || face == info.fr) {
        triangle = {kNone, kNone, kNone};
        continue;
      }
      for (std::size_t k = 0; k < 3; ++k) {
        if (triangle[k] != index(info.v0)) continue;
        triangle[k] = index(info.v1);
        surface_->marks[f][k] = mark;
      }
    }
  }

  void postprocess_collapse(const CollapseInfo& info) override {
    last_ = Handle();
    quadrics_[index(info.v1)] += quadrics_[index(info.v0)];
    // What was taken away around here goes to the nearest of the triangles that are left.
    points_.assign(1, cgal(info.p0));
    const auto take = [&](std::size_t f) {
      points_.insert(points_.end(), samples_[f].begin(), samples_[f].end());
      samples_[f].clear();
    };
    for (const auto face : {info.fl, info.fr})
      if (face.is_valid()) take(static_cast<std::size_t>(face.idx()));
    faces_.clear();
    for (const auto face : mesh_.vf_range(info.v1)) {
      const auto f = static_cast<std::size_t>(face.idx());
      take(f);
      faces_.push_back({f, triangle(corners(surface_->triangles[f], Handle(), Vector()))});
    }
    for (const auto& point : points_) {
      const Face* nearest = nullptr;
      double least = std::numeric_limits<double>::infinity();
      for (const Face& face : faces_) {
        const double distance = CGAL::squared_distance(point, face.triangle);
        if (distance >= least) continue;
        least = distance;
        nearest = &face;
      }
      if (nearest != nullptr) samples_[nearest->number].push_back(point);
    }
  }

  std::vector<Index> destinations() const {
    std::vector<Index> result = moved_to_;
    for (Index& v : result)
      while (moved_to_[v] != v) v = moved_to_[v];
    return result;
  }

 private:
  struct Face {
    std::size_t number;
    Kernel::Triangle_3 triangle;
  };

  /// Corners are left to when they go; edges are one triangle's, and need none where only one has them, for
  /// those stay.
  void sample(std::size_t f) {
    const auto& place = surface_->vertices;
    const Index a = surface_->triangles[f][0], b = surface_->triangles[f][1], c = surface_->triangles[f][2];
    for_each_sample({place[a], place[b], place[c]}, spacing_, [&](const Point& point, double u, double v) {
      const double w = 1 - u - v;
      const bool first = v == 0, second = u + v == 1, third = u == 0;  // on the edge a b, b c, c a
      if (u == 1 || v == 1 || w == 1 || (first && a > b) || (second && b > c) || (third && c > a)) return;
      samples_[f].emplace_back(point[0], point[1], point[2]);
    });
  }

  static Index index(Handle vertex) { return static_cast<Index>(vertex.idx()); }

  /// Places of a triangle's corners, with vertex `moved` at `place`.
  std::array<Vector, 3> corners(const std::array<Index, 3>& triangle, Handle moved,
                                const Vector& place) const {
    std::array<Vector, 3> result;
    for (std::size_t k = 0; k < 3; ++k)
      result[k] = moved.is_valid() && triangle[k] == index(moved)
                      ? place
                      : mesh_.point(Handle(static_cast<int>(triangle[k])));
    return result;
  }

  static Kernel::Triangle_3 triangle(const std::array<Vector, 3>& corner) {
    return {cgal(corner[0]), cgal(corner[1]), cgal(corner[2])};
  }

  /// The mark that corners at v0 have after the collapse. False if it is not clear.
  bool new_mark(const CollapseInfo& info, Index& mark) const {
    if (!info.fl.is_valid() || !info.fr.is_valid()) return false;
    const auto mark_at = [&](HalfedgeMesh::FaceHandle face, Handle vertex) {
      const auto f = static_cast<std::size_t>(face.idx());
      std::size_t k = 0;
      while (k < 2 && surface_->triangles[f][k] != index(vertex)) ++k;
      return surface_->marks[f][k];
    };
    mark = mark_at(info.fl, info.v1);
    if (mark_at(info.fr, info.v1) != mark) return false;
    const Index old = mark_at(info.fl, info.v0);
    for (const auto face : mesh_.vf_range(info.v0))
      if (mark_at(face, info.v0) != old) return false;
    return true;
  }

  bool stays_near(const CollapseInfo& info) {
    const double tolerance =
        std::min(surface_->tolerance[index(info.v0)], surface_->tolerance[index(info.v1)]);
    const double squared = tolerance * tolerance;
    faces_.clear();
    points_.assign(1, cgal(info.p0));
    for (const auto face : mesh_.vf_range(info.v0)) {
      const auto f = static_cast<std::size_t>(face.idx());
      points_.insert(points_.end(), samples_[f].begin(), samples_[f].end());
      if (face == info.fl || face == info.fr) continue;
      const auto before = corners(surface_->triangles[f], Handle(), Vector());
      const auto after = corners(surface_->triangles[f], info.v0, info.p1);
      const Vector old_normal = doubled_area(before), new_normal = doubled_area(after);
      if (!((old_normal | new_normal) > kLeastCosine * old_normal.norm() * new_normal.norm())) return false;
      faces_.push_back({f, triangle(after)});
    }
    // The new surface near the old one: the middles of triangles and of the edges between them (the other
    // edges stay), and the other way round.
    for (const Face& face : faces_) {
      const auto middle = CGAL::centroid(face.triangle);
      if (!tree_->is_within(middle, squared)) return false;
    }
    for (const auto vertex : mesh_.vv_range(info.v0))
      if (vertex != info.v1 && !tree_->is_within(cgal((mesh_.point(vertex) + info.p1) / 2), squared))
        return false;
    return std::all_of(points_.begin(), points_.end(), [&](const Kernel::Point_3& point) {
      return std::any_of(faces_.begin(), faces_.end(), [&](const Face& face) {
        return CGAL::squared_distance(point, face.triangle) <= squared;
      });
    });
  }

  HalfedgeMesh& mesh_;
  ManifoldSurface* surface_ = nullptr;
  const SurfaceTree* tree_ = nullptr;  ///< the surface as it was
  double spacing_ = 0;
  std::vector<OpenMesh::Geometry::Quadricd> quadrics_;
  std::vector<std::vector<Kernel::Point_3>>
      samples_;                  ///< of each triangle, of the surface that it stands for
  std::vector<Index> moved_to_;  ///< by its last collapse, of each vertex
  Handle last_;
  float cheapest_ = 0;
  std::vector<Face> faces_;
  std::vector<Kernel::Point_3> points_;
};

class Counter : public OpenMesh::Decimater::Observer {
 public:
  Counter(Progress& progress, std::size_t vertices)
      : Observer(1024), progress_(progress), vertices_(vertices) {}
  void notify(size_t step) override {
    progress_.fraction(std::min(1.0, static_cast<double>(step) / static_cast<double>(vertices_)));
  }

 private:
  Progress& progress_;
  std::size_t vertices_;
};

}  // namespace

std::vector<Index> decimate(ManifoldSurface& surface, double spacing, Progress& progress) {
  HalfedgeMesh mesh;
  mesh.reserve(surface.vertices.size(), 3 * surface.triangles.size() / 2 + 1, surface.triangles.size());
  for (const Point& p : surface.vertices) mesh.add_vertex(Vector(p[0], p[1], p[2]));
  for (const auto& [a, b, c] : surface.triangles) {
    const auto vertex = [](Index v) { return Handle(static_cast<int>(v)); };
    if (!mesh.add_face(vertex(a), vertex(b), vertex(c)).is_valid())
      throw Failure(ExitCode::runtime, "--simplify: a part of the surface that should be manifold is not");
  }
  std::vector<Kernel::Triangle_3> triangles;
  for (const auto face : mesh.faces()) {
    std::array<Vector, 3> corner;
    std::size_t k = 0;
    for (const auto vertex : mesh.fv_range(face)) corner[k++] = mesh.point(vertex);
    triangles.emplace_back(cgal(corner[0]), cgal(corner[1]), cgal(corner[2]));
  }
  const SurfaceTree tree(std::move(triangles));
  OpenMesh::Decimater::DecimaterT<HalfedgeMesh> decimater(mesh);
  for (std::size_t v = 0; v < surface.vertices.size(); ++v) {
    const Handle vertex(static_cast<int>(v));
    if (surface.locked[v] || mesh.is_boundary(vertex)) mesh.status(vertex).set_locked(true);
  }
  OpenMesh::Decimater::ModHandleT<Judge> judge;
  decimater.add(judge);
  decimater.module(judge).set(surface, tree, spacing);
  Counter counter(progress, surface.vertices.size());
  decimater.set_observer(&counter);
  if (!decimater.initialize()) throw Failure(ExitCode::runtime, "--simplify: the decimater did not start");
  decimater.decimate();
  return decimater.module(judge).destinations();
}

}  // namespace tetprep
