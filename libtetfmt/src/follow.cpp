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
  const Vec3d normal = cross(minus(p[1], p[0]), minus(p[2], p[0]));
  const std::size_t axis = Axes(normal).largest;
  lift[axis] = std::copysign(1.0, normal[axis]);
  return lift;
}

FaceMet face_met(const FileView& view, const Leaving& leaving) {
  FaceMet face;
  const auto sides = view.sides();
  const Index side = side_index(leaving.ref);
  if (side >= sides.size() || twin(side) >= sides.size()) return face;
  const Index piece = sides[side].triangle;
  if (piece >= view.triangles().size()) return face;
  const auto exist = [count = view.vertices().size()](const Triangle& triangle) {
    const auto& v = triangle.vertices;
    return std::max({v[0], v[1], v[2]}) < count;
  };
  face.piece = face.whole = &view.triangles()[piece];
  face.triangle = piece;
  if (!exist(*face.piece)) return face;
  if (!view.origins().empty()) {
    if (piece >= view.origins().size()) return face;
    face.triangle = view.origins()[piece];
    if (face.triangle >= view.input_triangles().size()) return face;
    face.whole = &view.input_triangles()[face.triangle];
    if (!exist(*face.whole)) face.whole = nullptr;
  }
  face.side = side;
  face.neighbor = sides[twin(side)].tet;
  return face;
}

void describe_hit(const FileView& view, const FaceMet& face, const Leaving& leaving, const TrianglePoint& at,
                  Hit& hit) {
  hit.outcome = Outcome::hit;
  hit.back = face.side % 2 == 1;
  hit.triangle = face.triangle;
  hit.t = at.t;
  hit.u = hit.side_u = at.u;
  hit.v = hit.side_v = at.v;
  hit.side = face.side;
  hit.tet = leaving.tet;
  hit.neighbor = face.neighbor;
  hit.face = leaving.ids;
  std::sort(hit.face.begin(), hit.face.end());  // however the ray came
  if (face.whole == face.piece) return;
  if (!face.whole) {
    hit.u = hit.v = std::numeric_limits<double>::quiet_NaN();
  } else if (face.whole->vertices != face.piece->vertices) {
    const auto corners = [&](const Triangle& triangle) {
      const auto& v = triangle.vertices;
      return std::array{view.vertices()[v[0]], view.vertices()[v[1]], view.vertices()[v[2]]};
    };
    const TrianglePoint above = from_piece(at, corners(*face.piece), corners(*face.whole));
    hit.u = above.u;
    hit.v = above.v;
  }
}

void describe_hit(const FileView& view, const Line& line, const Leaving& leaving, Hit& hit) {
  const FaceMet face = face_met(view, leaving);
  if (face.side == kNone) {
    hit.outcome = Outcome::corrupt;
    return;
  }
  const auto points = view.vertices();
  const auto& v = face.piece->vertices;
  describe_hit(view, face, leaving,
               intersect(line.origin.point, line.direction, points[v[0]], points[v[1]], points[v[2]]), hit);
}

}  // namespace tetfmt::detail
