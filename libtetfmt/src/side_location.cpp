// SPDX-License-Identifier: MIT
// Where rays start that leave a surface: exactly on it, by choice of the point instead of by an offset.
#include <algorithm>
#include <cmath>

#include "cells.hpp"
#include "predicates.hpp"
#include "projection.hpp"
#include "tetfmt/traverse.hpp"
#include "walk.hpp"

namespace tetfmt {
namespace {

using namespace detail;

/// A file's coordinates are multiples of a power of two, and at most 2^24 of it. Weights that are multiples
/// of 2^-26 give points whose coordinates a double holds exactly: sums of products of 50 bits.
constexpr int kWeightBits = 26;

/// A point next to `point`, off by a rounding of the weights, that is exactly in the face's plane and
/// strictly inside the face. `corners` are not collinear.
Vec3d inside_face(const std::array<Vec3d, 3>& corners, const Vec3d& point) {
  const Vec3d ab = minus(corners[1], corners[0]), ac = minus(corners[2], corners[0]),
              ap = minus(point, corners[0]);
  const Vec3d normal = cross(ab, ac);
  const std::size_t axis = Axes(normal).largest, i = (axis + 1) % 3, j = (axis + 2) % 3;
  constexpr double kOne = 1 << kWeightBits;
  const auto weight = [&](double area) {
    const double w = std::round(kOne * (area / normal[axis]));
    return w >= 1 ? std::min(w, kOne - 2) : 1;  // not NaN either
  };
  double w1 = weight(ap[i] * ac[j] - ap[j] * ac[i]), w2 = weight(ab[i] * ap[j] - ab[j] * ap[i]);
  const double excess = w1 + w2 - (kOne - 1);
  if (excess > 0) (w1 > w2 ? w1 : w2) -= excess;  // of kOne - 2 at most, so that it leaves 1 or more
  const double w0 = kOne - w1 - w2;
  Vec3d inside{};
  for (std::size_t k = 0; k < 3; ++k)
    inside[k] = (w0 * corners[0][k] + w1 * corners[1][k] + w2 * corners[2][k]) / kOne;
  return inside;
}

Location on_side(const FileView& view, const Hit& hit, Index side) {
  Location location;
  const auto vertices = view.vertices();
  const auto sides = view.sides();
  if (hit.outcome != Outcome::hit || side >= sides.size()) return location;
  const Index tet = sides[side].tet, triangle = sides[side].triangle;
  const auto exist = [&](const std::array<Index, 3>& v) {
    return std::max({v[0], v[1], v[2]}) < vertices.size();
  };
  if (triangle >= view.triangles().size() || !exist(view.triangles()[triangle].vertices) || !exist(hit.face))
    return location;

  const std::array<Index, 3>& face = hit.face;
  std::array<Vec3d, 3> corners, points;
  for (std::size_t k = 0; k < 3; ++k) {
    corners[k] = to_vec3d(vertices[view.triangles()[triangle].vertices[k]]);
    points[k] = to_vec3d(vertices[face[k]]);
  }
  Vec3d point{};
  for (std::size_t k = 0; k < 3; ++k)
    point[k] = (1 - hit.side_u - hit.side_v) * corners[0][k] + hit.side_u * corners[1][k] +
               hit.side_v * corners[2][k];
  location.position = inside_face(points, point);
  if (tet == kNone) {
    location.state = Location::State::absent;
    return location;
  }
  if (tet >= view.tet_count()) return location;
  with_cells(view, [&](const auto& cells) {
    const Index apex = cells.vertex_xor(tet) ^ face[0] ^ face[1] ^ face[2];
    if (apex >= vertices.size()) return;
    const std::size_t apex_rank = rank(apex, face[0], face[1], face[2]);
    location.cell = {tet, insert_apex(face, apex, apex_rank),
                     cells.neighbors(tet, side_ref(side), apex_rank)};
    location.positive = is_positive(view, location.cell);
    location.face = static_cast<std::uint8_t>(apex_rank);
    location.state = Location::State::inside;
  });
  return location;
}

}  // namespace

Location near_side(const FileView& view, const Hit& hit) {
  return on_side(view, hit, hit.side);
}
Location far_side(const FileView& view, const Hit& hit) {
  return on_side(view, hit, twin(hit.side));
}

}  // namespace tetfmt
