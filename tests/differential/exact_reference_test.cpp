// SPDX-License-Identifier: AGPL-3.0-or-later
// The reference itself, on surfaces whose answers are known by construction.
#include "differential/exact_reference.hpp"

#include <gtest/gtest.h>

#include <random>

namespace tetfmt_test {
namespace {

using tetfmt::Ray;
using tetfmt::Triangle;
using tetfmt::Vec3f;
using Kind = Barrier::Kind;

struct Surface {
  std::vector<Vec3f> vertices;
  std::vector<Triangle> triangles;
  ExactReference reference() const { return {vertices, triangles}; }
};

/// The square [0, 2]^2 at z = 0, four triangles around the centre (1, 1, 0), normals up.
Surface square() {
  return {{{0, 0, 0}, {2, 0, 0}, {2, 2, 0}, {0, 2, 0}, {1, 1, 0}},
          {{{0, 1, 4}}, {{1, 2, 4}}, {{2, 3, 4}}, {{3, 0, 4}}}};
}

/// A roof: two triangles that share the ridge from (0, 0, 1) to (0, 2, 1) and fall to z = 0 on both sides.
Surface roof() {
  return {{{0, 0, 1}, {0, 2, 1}, {1, 1, 0}, {-1, 1, 0}}, {{{0, 2, 1}}, {{0, 1, 3}}}};
}

void expect_barrier(const Surface& surface, const Ray& ray, Kind kind, double t) {
  const auto barrier = surface.reference().barrier(ray);
  ASSERT_TRUE(barrier);
  EXPECT_EQ(barrier->kind, kind);
  EXPECT_EQ(barrier->t, Exact(t));
}

TEST(ExactReference, InteriorEdgeAndVertexStopARay) {
  expect_barrier(square(), {{1, 0.25F, 3}, {0, 0, -2}}, Kind::interior, 1.5);
  expect_barrier(square(), {{0.5F, 0.5F, 3}, {0, 0, -1}}, Kind::edge, 3);
  expect_barrier(square(), {{1, 1, 3}, {0, 0, -1}}, Kind::vertex, 3);
  expect_barrier(square(), {{0, 0, 1}, {1, 1, -1}}, Kind::vertex, 1);
}

TEST(ExactReference, RimAndStartGraze) {
  const Surface surface = square();
  const auto reference = surface.reference();
  EXPECT_FALSE(reference.barrier({{1, 0, 3}, {0, 0, -1}})) << "an edge of the rim";
  EXPECT_FALSE(reference.barrier({{2, 2, 3}, {0, 0, -1}})) << "a corner of the rim";
  EXPECT_FALSE(reference.barrier({{1, 0.25F, 0}, {0, 0, -1}})) << "starts on the surface";
  EXPECT_FALSE(reference.barrier({{-1, 1, 0}, {1, 0, 0}})) << "in the plane";
  EXPECT_FALSE(reference.barrier({{3, 3, 3}, {0, 0, -1}})) << "beside";
  EXPECT_FALSE(reference.barrier({{1, 0.25F, 3}, {0, 0, 1}})) << "behind the origin";
}

TEST(ExactReference, ARidgeStopsFromAboveAndGrazesFromTheSide) {
  expect_barrier(roof(), {{0, 1, 3}, {0, 0, -1}}, Kind::edge, 2);
  EXPECT_FALSE(roof().reference().barrier({{-3, 1, 1}, {1, 0, 0}}));
  const Answer graze{0, 3, 0, 0.5, 0};
  EXPECT_TRUE(roof().reference().contact(0, {{-3, 1, 1}, {1, 0, 0}}));
  EXPECT_EQ(roof().reference().judge({{-3, 1, 1}, {1, 0, 0}}, {}, {-1, 0, 0, 0, 0}), "");
  EXPECT_EQ(roof().reference().judge({{-3, 1, 1}, {1, 0, 0}}, {}, {0, 3, 0, 0.5, 1}), "");
  EXPECT_NE(roof().reference().judge({{-3, 1, 1}, {1, 0, 0}}, {}, graze), "") << "seen from below";
}

TEST(ExactReference, OneUnitInTheLastPlaceDecides) {
  // The ray passes the rim x = 2 at x = 2, or at the next float32 beyond it.
  const Surface surface = square();
  const auto reference = surface.reference();
  const Ray beyond{{std::nextafter(2.0F, 3.0F), 1, 1}, {0, 0, -1}};
  const Ray within{{std::nextafter(2.0F, 1.0F), 1.5F, 1}, {0, 0, -1}};
  EXPECT_FALSE(reference.barrier(beyond));
  EXPECT_FALSE(reference.contact(1, beyond));
  EXPECT_TRUE(reference.barrier(within));
  // The exact t of a ray that no double holds: 1 / 3.
  const auto third = reference.barrier({{1, 0.25F, 1}, {0, 0, -3}});
  ASSERT_TRUE(third);
  EXPECT_EQ(third->t, Exact(1) / Exact(3));
}

TEST(ExactReference, VertexWhoseTrianglesLeaveAGapGrazes) {
  Surface surface = square();
  surface.triangles.pop_back();
  EXPECT_FALSE(surface.reference().barrier({{1, 1, 3}, {0, 0, -1}}));
  // Two more triangles over the gap, at other heights but at the same vertex, close it again.
  surface.vertices.push_back({-1, 1, 1});
  surface.triangles.push_back({{3, 5, 4}});
  EXPECT_FALSE(surface.reference().barrier({{1, 1, 3}, {0, 0, -1}}));
  surface.triangles.push_back({{5, 0, 4}});
  expect_barrier(surface, {{1, 1, 3}, {0, 0, -1}}, Kind::vertex, 3);
}

TEST(ExactReference, ContactInThePlaneIsAnInterval) {
  const Surface surface = square();
  const auto reference = surface.reference();
  const Ray ray{{-1, 0.5F, 0}, {0.5F, 0, 0}};
  const auto contact = reference.contact(3, ray);  // the triangle at the left
  ASSERT_TRUE(contact);
  EXPECT_TRUE(contact->in_plane);
  EXPECT_EQ(contact->first, Exact(2));
  EXPECT_EQ(contact->last, Exact(3));
  EXPECT_FALSE(reference.contact(3, {{-1, 0.5F, 1}, {0.5F, 0, 0}}));
  EXPECT_FALSE(reference.contact(3, {{-1, 3, 0}, {0.5F, 0, 0}}));
  // Weights of the corners (0, 0) and (1, 1) at the point (0.25, 0.5): 0.625 and 0.25.
  EXPECT_EQ(reference.judge(ray, {}, {3, 2.5, 0.625, 0.25, 0}), "");
  EXPECT_NE(reference.judge(ray, {}, {3, 3.1, 0.625, 0.25, 0}), "");
  EXPECT_NE(reference.judge(ray, {}, {3, 2.5, 0.5, 0.25, 0}), "");
}

TEST(ExactReference, JudgeRefusesWhatIsWrong) {
  // Two squares, at z = 0 and z = -1.
  Surface surface = square();
  for (std::size_t i = 0; i < 5; ++i) {
    surface.vertices.push_back({surface.vertices[i].x, surface.vertices[i].y, -1});
  }
  for (std::size_t i = 0; i < 4; ++i) {
    const auto& v = surface.triangles[i].vertices;
    surface.triangles.push_back({{v[0] + 5, v[1] + 5, v[2] + 5}});
  }
  surface.triangles.emplace_back();  // dropped
  const auto reference = surface.reference();
  const Ray ray{{1, 0.25F, 3}, {0, 0, -2}};
  const auto barrier = reference.barrier(ray);
  const Answer right{0, 1.5, 0.375, 0.25, 0};
  EXPECT_EQ(reference.judge(ray, barrier, right), "");
  Answer wrong = right;
  wrong.triangle = -1;
  EXPECT_NE(reference.judge(ray, barrier, wrong), "") << "missed";
  wrong = {4, 2, 0.375, 0.25, 0};
  EXPECT_NE(reference.judge(ray, barrier, wrong), "") << "passed the first square";
  wrong = right;
  wrong.triangle = 1;
  EXPECT_NE(reference.judge(ray, barrier, wrong), "") << "a neighbour that does not contain the point";
  wrong = right;
  wrong.t += 1e-5;
  EXPECT_NE(reference.judge(ray, barrier, wrong), "") << "t";
  wrong = right;
  wrong.u += 1e-5;
  EXPECT_NE(reference.judge(ray, barrier, wrong), "") << "u";
  std::swap(wrong.u, wrong.v);
  EXPECT_NE(reference.judge(ray, barrier, wrong), "") << "u and v exchanged";
  wrong = right;
  wrong.side = 1;
  EXPECT_NE(reference.judge(ray, barrier, wrong), "") << "side";
  wrong = right;
  wrong.t = std::numeric_limits<double>::quiet_NaN();
  EXPECT_NE(reference.judge(ray, barrier, wrong), "") << "not a number";
  wrong.triangle = 8;
  EXPECT_NE(reference.judge(ray, barrier, wrong), "") << "a dropped triangle";
  wrong.triangle = 9;
  EXPECT_NE(reference.judge(ray, barrier, wrong), "") << "no such triangle";
  // From below, the back of the lower square; through an edge, either of its two triangles.
  const Ray up{{1, 0.25F, -2}, {0, 0, 1}};
  EXPECT_EQ(reference.judge(up, reference.barrier(up), {4, 1, 0.375, 0.25, 1}), "");
  const Ray edge{{0.5F, 0.5F, 3}, {0, 0, -1}};
  EXPECT_EQ(reference.judge(edge, reference.barrier(edge), {0, 3, 0, 0.5, 0}), "");
  EXPECT_EQ(reference.judge(edge, reference.barrier(edge), {3, 3, 0.5, 0.5, 0}), "");
  EXPECT_NE(reference.judge(edge, reference.barrier(edge), {-1, 0, 0, 0, 0}), "") << "leaked through an edge";
}

TEST(ExactReference, TheBoxTreeLeavesNothingOut) {
  // Triangles with integer corners from 0 to 9, rays likewise: every kind of degeneracy, and boxes met
  // exactly at their faces, edges and corners.
  std::mt19937_64 random(7);
  const auto digit = [&] { return static_cast<float>(random() % 10); };
  Surface surface;
  for (tetfmt::Index i = 0; i < 300; ++i) {
    for (int k = 0; k < 3; ++k) surface.vertices.push_back({digit(), digit(), digit()});
    const Exact area = [&] {
      Exact sum = 0;
      const auto* v = &surface.vertices[3 * i];
      const Exact ab[3] = {v[1].x - v[0].x, v[1].y - v[0].y, v[1].z - v[0].z};
      const Exact ac[3] = {v[2].x - v[0].x, v[2].y - v[0].y, v[2].z - v[0].z};
      for (int k = 0; k < 3; ++k) {
        const Exact n = ab[(k + 1) % 3] * ac[(k + 2) % 3] - ab[(k + 2) % 3] * ac[(k + 1) % 3];
        sum += n * n;
      }
      return sum;
    }();
    if (area != 0) surface.triangles.push_back({{3 * i, 3 * i + 1, 3 * i + 2}});
  }
  const auto reference = surface.reference();
  int hits = 0;
  for (int i = 0; i < 3000; ++i) {
    const Ray ray{{digit(), digit(), digit()}, {digit() - 4, digit() - 4, digit() - 4}};
    if (ray.direction == Vec3f{0, 0, 0}) continue;
    const auto fast = reference.barrier(ray), slow = reference.barrier_without_tree(ray);
    ASSERT_EQ(fast.has_value(), slow.has_value()) << i;
    if (fast) {
      ASSERT_EQ(fast->t, slow->t) << i;
      ++hits;
    }
  }
  EXPECT_GT(hits, 1000);
}

}  // namespace
}  // namespace tetfmt_test
