// SPDX-License-Identifier: AGPL-3.0-or-later
// The truth about a ray and a surface, by exact arithmetic on the float32 numbers as they are. Knows
// triangles only, nothing of tetrahedra, so it shares no mistake with what it judges.
//
// A ray is the set o + t d, t >= 0; a triangle is closed. Where they touch, one of these holds:
//   crossing   the line passes through the triangle's interior, an edge or a vertex, and at that point the
//              surface lies across the line: however little the ray or the surface is moved, the ray still
//              meets one of the triangles that share the point. At t > 0 this stops every ray.
//   graze      everything else: the ray touches an edge or vertex from one side, lies in the triangle's
//   plane, or
//              starts on the triangle. A tracer may report such a contact or pass it.
#pragma once

#include <CGAL/Exact_rational.h>

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "differential/box_tree.hpp"
#include "tetfmt/layout.hpp"
#include "tetfmt/traverse.hpp"
#include "tetfmt/types.hpp"

namespace tetfmt_test {

using Exact = CGAL::Exact_rational;

/// The nearest point at which the surface must stop the ray.
struct Barrier {
  enum class Kind { interior, edge, vertex } kind{};
  Exact t;  ///< above 0
};

/// Where one closed triangle and the line of a ray have points in common.
struct Contact {
  Exact first, last;  ///< parameters; equal unless the line lies in the triangle's plane
  bool in_plane = false;
  bool back = false;  ///< the ray runs along the normal (b - a) x (c - a); false if in_plane
  Exact u, v;         ///< weights of the second and third corner; 0 if in_plane
};

/// One answer of a tracer, as `tet query` writes it.
struct Answer {
  std::int64_t triangle = -1;  ///< -1: a miss
  double t = 0, u = 0, v = 0;
  int side = 0;
};

class ExactReference {
 public:
  /// Both spans must outlive this object. Dropped triangles are not part of the surface. O(n log n).
  ExactReference(std::span<const tetfmt::Vec3f> vertices, std::span<const tetfmt::Triangle> triangles);

  std::optional<Barrier> barrier(const tetfmt::Ray& ray) const;
  /// The same without the box tree: every triangle is tried. For testing the tree. O(n).
  std::optional<Barrier> barrier_without_tree(const tetfmt::Ray& ray) const;

  std::optional<Contact> contact(tetfmt::Index triangle, const tetfmt::Ray& ray) const;

  /// Empty if `answer` is right, given the ray's barrier; otherwise one line that says what is wrong:
  ///   a miss must have no barrier;
  ///   a hit's triangle must contain a point of the ray, at 0 <= t <= the barrier's t;
  ///   t, u and v must be that point's to a relative 1e-6, apart from what the roundings of one evaluation in
  ///   double cost on a nearly parallel ray; side must be the exact one (either, if the ray lies in the
  ///   plane).
  std::string judge(const tetfmt::Ray& ray, const std::optional<Barrier>& barrier,
                    const Answer& answer) const;

 private:
  void consider(tetfmt::Index triangle, const tetfmt::Ray& ray, std::optional<Barrier>& nearest) const;
  bool edge_blocks(tetfmt::Index from, tetfmt::Index to, const tetfmt::Ray& ray) const;
  bool vertex_blocks(tetfmt::Index vertex, const tetfmt::Ray& ray) const;
  std::span<const tetfmt::Index> around(tetfmt::Index vertex) const;

  std::span<const tetfmt::Vec3f> vertices_;
  std::span<const tetfmt::Triangle> triangles_;
  BoxTree tree_;
  std::vector<std::size_t> first_around_;  ///< of each vertex, in around_; one more at the end
  std::vector<tetfmt::Index> around_;      ///< triangles that share a vertex
};

}  // namespace tetfmt_test
