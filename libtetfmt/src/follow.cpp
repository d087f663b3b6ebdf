// SPDX-License-Identifier: MIT
#include "follow.hpp"

#include <algorithm>

#include "intersect.hpp"

namespace tetfmt::detail {

bool may_meet(const Bounds& bounds, const Line& line) {
  const Vec3d lower = to_vec3d(bounds.lower), upper = to_vec3d(bounds.upper), &origin = line.origin.point;
  double first = 0, last = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < 3; ++i) {
    if (line.direction[i] == 0) {
      if (origin[i] < lower[i] || origin[i] > upper[i]) return false;
      continue;
    }
    double near = (lower[i] - origin[i]) / line.direction[i];
    double far = (upper[i] - origin[i]) / line.direction[i];
    if (near > far) std::swap(near, far);
    first = std::max(first, near);
    last = std::min(last, far);
  }
  return first * (1 - 0x1p-50) <= last * (1 + 0x1p-50);  // three roundings each
}

Vec3d lift_of(const FileView& view, const Location& from) {
  Vec3d lift{};
  if (from.state != Location::State::inside || from.face >= kOutwardFaces.size()) return lift;
  if (!in_range(view, from.cell)) return lift;
  auto f = kOutwardFaces[from.face];
  if (from.positive) std::swap(f[1], f[2]);  // turned inwards
  std::array<Vec3d, 3> p;
  for (std::size_t k = 0; k < 3; ++k) p[k] = to_vec3d(view.vertices()[from.cell.vertices[f[k]]]);
  Vec3d normal{};
  for (std::size_t k = 0; k < 3; ++k) {
    const std::size_t i = (k + 1) % 3, j = (k + 2) % 3;
    normal[k] = (p[1][i] - p[0][i]) * (p[2][j] - p[0][j]) - (p[1][j] - p[0][j]) * (p[2][i] - p[0][i]);
  }
  const std::size_t axis = Axes(normal).largest;
  lift[axis] = std::copysign(1.0, normal[axis]);
  return lift;
}

void describe_hit(const FileView& view, const Line& line, const Leaving& leaving, Hit& hit) {
  hit.outcome = Outcome::corrupt;
  const auto sides = view.sides();
  const Index side = side_index(leaving.ref);
  if (side >= sides.size() || twin(side) >= sides.size()) return;
  const Index piece = sides[side].triangle;
  if (piece >= view.triangles().size()) return;
  const auto& corner = view.triangles()[piece].vertices;
  const auto points = view.vertices();
  if (std::max({corner[0], corner[1], corner[2]}) >= points.size()) return;

  TrianglePoint at =
      intersect(line.origin.point, line.direction, points[corner[0]], points[corner[1]], points[corner[2]]);
  hit.side_u = at.u;
  hit.side_v = at.v;
  hit.triangle = piece;
  if (!view.origins().empty()) {
    if (piece >= view.origins().size()) return;
    hit.triangle = view.origins()[piece];
    if (hit.triangle >= view.input_triangles().size()) return;
    const auto& whole = view.input_triangles()[hit.triangle].vertices;
    if (std::max({whole[0], whole[1], whole[2]}) >= points.size()) {
      at.u = at.v = std::numeric_limits<double>::quiet_NaN();  // its corners are not all in the file
    } else if (whole != corner) {
      at = from_piece(at, {points[corner[0]], points[corner[1]], points[corner[2]]},
                      {points[whole[0]], points[whole[1]], points[whole[2]]});
    }
  }
  hit.outcome = Outcome::hit;
  hit.back = side % 2 == 1;
  hit.t = at.t;
  hit.u = at.u;
  hit.v = at.v;
  hit.side = side;
  hit.tet = leaving.tet;
  hit.neighbor = sides[twin(side)].tet;
  hit.face = leaving.ids;
}

}  // namespace tetfmt::detail
