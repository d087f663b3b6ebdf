// SPDX-License-Identifier: AGPL-3.0-or-later
// The two trees that `tet bench` compares with, against exact arithmetic on every triangle.
#include <gtest/gtest.h>

#include <cmath>

#include "bench/dice.hpp"
#include "bench/peers/bvh.hpp"
#include "bench/peers/kd_tree.hpp"
#include "bench/truth/exact_reference.hpp"
#include "sample/surface.hpp"
#include "support/lattice_mesh.hpp"
#include "tetfmt/encode.hpp"

namespace tetfmt_test {
namespace {

using tetbench::Dice;
using tetbench::PeerMesh;
using tetbench::PeerRay;
using tetbench::TreeHit;
using tetbench::Vec3d;
using tetfmt::Vec3f;

constexpr double kFar = std::numeric_limits<double>::infinity();

/// On a grid that float32 holds, so that exact arithmetic can say what is right.
PeerMesh sample(const char* name, std::uint64_t triangles) {
  PeerMesh mesh;
  for (const tetprep::SurfaceKind& kind : tetprep::surface_kinds()) {
    if (std::string(kind.name) != name) continue;
    const tetprep::Surface surface = kind.make(triangles, 1);
    for (const auto& p : surface.points) {
      const auto snapped = [&](std::size_t k) { return std::ldexp(std::round(std::ldexp(p[k], 16)), -16); };
      mesh.vertices.push_back({snapped(0), snapped(1), snapped(2)});
    }
    for (const auto& t : surface.triangles) {
      mesh.numbers.push_back(static_cast<tetfmt::Index>(7 * mesh.triangles.size()));  // not their position
      mesh.triangles.push_back(t);
    }
  }
  return mesh;
}

PeerMesh lattice(int n) {
  LatticeOptions options;
  options.one_triangle_a_face = true;
  const auto bytes = tetfmt::encode(lattice_mesh(n, options), tetfmt::Layout::tet20);
  return PeerMesh(*tetfmt::FileView::open(bytes));
}

tetbench::ExactReference reference(const PeerMesh& mesh) {
  return tetbench::ExactReference(tetbench::Surface(mesh.vertices, mesh.triangles));
}

tetfmt::Bounds bounds(const PeerMesh& mesh) {
  tetfmt::Bounds bounds;
  for (const Vec3f& v : mesh.vertices) bounds.add(v);
  return bounds;
}

/// From around the bounds, in any direction.
PeerRay any_ray(const tetfmt::Bounds& box, Dice& dice) {
  const auto place = [&](float low, float high) {
    const double margin = 0.2 * (double{high} - double{low});
    return static_cast<float>(dice.between(low - margin, high + margin));
  };
  const auto d = dice.direction();
  return {{place(box.lower.x, box.upper.x), place(box.lower.y, box.upper.y), place(box.lower.z, box.upper.z)},
          {static_cast<float>(d[0]), static_cast<float>(d[1]), static_cast<float>(d[2])}};
}

tetbench::ExactLine line(const tetbench::ExactReference& truth, const PeerRay& ray) {
  const auto wide = [](const Vec3f& v) { return Vec3d{double{v.x}, double{v.y}, double{v.z}}; };
  return {truth.surface(), {wide(ray.origin), {}}, wide(ray.direction)};
}

template <class Tree>
class Trees : public testing::Test {};
using Both = testing::Types<tetbench::Bvh, tetbench::KdTree>;
class Names {
 public:
  template <class Tree>
  static std::string GetName(int) {
    return std::is_same_v<Tree, tetbench::Bvh> ? "Bvh" : "KdTree";
  }
};
TYPED_TEST_SUITE(Trees, Both, Names);

TYPED_TEST(Trees, FirstHitsAreTheExactOnesForGenericRays) {
  for (const PeerMesh& mesh : {sample("torus-knot", 3000), sample("sphere", 400), lattice(5)}) {
    const TypeParam tree(mesh);
    const auto truth = reference(mesh);
    const auto box = bounds(mesh);
    Dice dice({1});
    int hits = 0;
    for (int i = 0; i < 1500; ++i) {
      const PeerRay ray = any_ray(box, dice);
      const auto exact = truth.crossings_without_tree(line(truth, ray), 0, kFar);
      tetbench::NotCounted nothing;
      const TreeHit hit = tree.template trace<false>(tetbench::TreeRay(ray), nothing);
      ASSERT_EQ(hit.triangle == tetfmt::kNone, exact.empty()) << i;
      tetbench::NodeCount counter;
      const TreeHit counted = tree.template trace<false>(tetbench::TreeRay(ray), counter);
      EXPECT_EQ(counted.triangle, hit.triangle);
      EXPECT_EQ(counted.t, hit.t);
      if (exact.empty()) continue;
      ++hits;
      EXPECT_GT(counter.nodes, 0U);
      EXPECT_EQ(hit.triangle, mesh.numbers[exact[0].face]) << i;
      EXPECT_NEAR(hit.t, exact[0].low, 1e-4 * (1 + exact[0].low)) << i;
    }
    EXPECT_GT(hits, 100);
  }
}

TYPED_TEST(Trees, AnyHitWithinTheIntervalIsWhatExactArithmeticSays) {
  const PeerMesh mesh = sample("torus-knot", 3000);
  const TypeParam tree(mesh);
  const auto truth = reference(mesh);
  const auto box = bounds(mesh);
  Dice dice({2});
  int blocked = 0, cut = 0;
  for (int i = 0; i < 1500; ++i) {
    PeerRay ray = any_ray(box, dice);
    const double extent = double{box.upper.x} - double{box.lower.x};
    ray.t_min = static_cast<float>(dice.between(0, 0.3) * extent);
    ray.t_max = ray.t_min + static_cast<float>(dice.between(0, 0.5) * extent);
    const auto exact = truth.crossings_without_tree(line(truth, ray), ray.t_min, ray.t_max);
    tetbench::NotCounted nothing;
    const TreeHit any = tree.template trace<true>(tetbench::TreeRay(ray), nothing),
                  first = tree.template trace<false>(tetbench::TreeRay(ray), nothing);
    ASSERT_EQ(any.triangle == tetfmt::kNone, exact.empty()) << i;
    ASSERT_EQ(first.triangle == tetfmt::kNone, exact.empty()) << i;
    blocked += exact.empty() ? 0 : 1;
    cut += exact.empty() && !truth.crossings_without_tree(line(truth, ray), 0, kFar).empty() ? 1 : 0;
    EXPECT_EQ(first.triangle, exact.empty() ? tetfmt::kNone : mesh.numbers[exact[0].face]);
  }
  EXPECT_GT(blocked, 50);
  EXPECT_GT(cut, 50) << "some rays must meet triangles outside of their interval only";
}

TYPED_TEST(Trees, NoRayLeaksThroughEdgesAndVerticesOfALattice) {
  const PeerMesh mesh = lattice(6);  // the box [1, 5]^3, closed
  const TypeParam tree(mesh);
  Dice dice({3});
  for (int i = 0; i < 5000; ++i) {
    // From a lattice point or between two, to a vertex, the middle of an edge, or along an axis.
    const auto inside = [&] { return 1.5F + 0.5F * static_cast<float>(dice.below(6)); };
    const Vec3f from = {inside(), inside(), inside()};
    const auto& corners = mesh.triangles[dice.below(mesh.triangles.size())];
    const Vec3f a = mesh.vertices[corners[0]], b = mesh.vertices[corners[1 + dice.below(2)]];
    const bool edge = dice.below(2) == 0;
    const Vec3f target = edge ? Vec3f{(a.x + b.x) / 2, (a.y + b.y) / 2, (a.z + b.z) / 2} : a;
    const PeerRay ray{from, {target.x - from.x, target.y - from.y, target.z - from.z}};
    tetbench::NotCounted nothing;
    const TreeHit hit = tree.template trace<false>(tetbench::TreeRay(ray), nothing);
    ASSERT_NE(hit.triangle, tetfmt::kNone) << i;
    EXPECT_NEAR(hit.t, 1, 1e-5) << i;
  }
}

TYPED_TEST(Trees, TrianglesInOnePlaceOrWithoutAnAreaAreNoTrouble) {
  PeerMesh mesh;
  mesh.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  for (tetfmt::Index i = 0; i < 100'000; ++i) {
    mesh.triangles.push_back(i % 2 == 0 ? std::array<tetfmt::Index, 3>{0, 1, 2}
                                        : std::array<tetfmt::Index, 3>{0, 1, 1});
    mesh.numbers.push_back(i);
  }
  const TypeParam tree(mesh);
  tetbench::NodeCount counter;
  const TreeHit hit =
      tree.template trace<false>(tetbench::TreeRay(PeerRay{{0.25F, 0.25F, 1}, {0, 0, -1}}), counter);
  ASSERT_NE(hit.triangle, tetfmt::kNone);
  EXPECT_EQ(hit.triangle % 2, 0U);
  EXPECT_EQ(hit.t, 1);

  const TypeParam empty((PeerMesh()));
  EXPECT_EQ(empty.template trace<false>(tetbench::TreeRay(PeerRay{{}, {0, 0, 1}}), counter).triangle,
            tetfmt::kNone);
}

}  // namespace
}  // namespace tetfmt_test
