// SPDX-License-Identifier: AGPL-3.0-or-later
// The common part of two convex sets in different planes is an interval of the planes' common line. Each of
// its ends is where that line enters or leaves one of the triangles: a corner in the other's plane, or an
// edge that passes through it. So it is enough to look at every corner and every edge of one against the
// whole other.
#include "prep/contact.hpp"

#include <cstdlib>

namespace tetprep {
namespace {

using Corners = std::array<Index, 3>;

/// Six times the volume of (a, b, c, d), signed as tetfmt::orientation; below 2^79 in size.
Wide volume(const GridPoint& a, const GridPoint& b, const GridPoint& c, const GridPoint& d) {
  std::array<std::int64_t, 3> u{}, v{}, w{};
  for (std::size_t k = 0; k < 3; ++k) {
    u[k] = std::int64_t{b[k]} - a[k];
    v[k] = std::int64_t{c[k]} - a[k];
    w[k] = std::int64_t{d[k]} - a[k];
  }
  return Wide{u[1] * v[2] - u[2] * v[1]} * w[0] + Wide{u[2] * v[0] - u[0] * v[2]} * w[1] +
         Wide{u[0] * v[1] - u[1] * v[0]} * w[2];
}

/// Whether p, a point in the triangle's plane, is in the triangle.
bool contains(const GridPoint& a, const GridPoint& b, const GridPoint& c, const GridPoint& p) {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const std::int64_t area = tetfmt::doubled_area(a, b, c, axis);
    if (area == 0) continue;  // the plane is seen from its edge
    const std::int64_t sign = area > 0 ? 1 : -1;
    return tetfmt::doubled_area(a, b, p, axis) * sign >= 0 &&
           tetfmt::doubled_area(b, c, p, axis) * sign >= 0 && tetfmt::doubled_area(c, a, p, axis) * sign >= 0;
  }
  return false;
}

/// Whether the line through p and q, which crosses the triangle's plane, passes through the triangle.
bool passes_through(const GridPoint& p, const GridPoint& q, const GridPoint& a, const GridPoint& b,
                    const GridPoint& c) {
  const int ab = tetfmt::orientation(p, q, a, b), bc = tetfmt::orientation(p, q, b, c);
  if (ab * bc < 0) return false;
  const int ca = tetfmt::orientation(p, q, c, a);
  return ab * ca >= 0 && bc * ca >= 0;
}

/// Corners of `a` that lie in `b`, and points where edges of `a` pass through it. `side`: of each corner of
/// `a`, which side of the plane of `b` it is on.
void add_points(const std::vector<GridPoint>& points, const Corners& a, const Corners& b,
                const std::array<int, 3>& side, Contact& contact) {
  const GridPoint &b0 = points[b[0]], &b1 = points[b[1]], &b2 = points[b[2]];
  for (std::size_t i = 0; i < 3; ++i) {
    const std::size_t j = (i + 1) % 3;
    const GridPoint &p = points[a[i]], &q = points[a[j]];
    if (side[i] == 0) {
      if (contains(b0, b1, b2, p)) contact.points[contact.count++] = {a[i]};
    } else if (side[i] * side[j] < 0 && passes_through(p, q, b0, b1, b2)) {
      const Wide from_p = volume(b0, b1, b2, p), from_q = volume(b0, b1, b2, q);
      contact.points[contact.count++] = {a[i], a[j], from_p, from_p - from_q};
    }
  }
}

std::array<int, 3> sides(const std::vector<GridPoint>& points, const Corners& of, const Corners& plane) {
  std::array<int, 3> side{};
  for (std::size_t i = 0; i < 3; ++i)
    side[i] = tetfmt::orientation(points[plane[0]], points[plane[1]], points[plane[2]], points[of[i]]);
  return side;
}

}  // namespace

std::size_t widest_axis(const GridPoint& a, const GridPoint& b, const GridPoint& c) {
  std::size_t widest = 0;
  for (std::size_t axis = 1; axis < 3; ++axis)
    if (std::abs(tetfmt::doubled_area(a, b, c, axis)) > std::abs(tetfmt::doubled_area(a, b, c, widest)))
      widest = axis;
  return widest;
}

bool strictly_inside(const GridPoint& a, const GridPoint& b, const GridPoint& c, const GridPoint& p,
                     std::size_t axis) {
  const std::int64_t sign = tetfmt::doubled_area(a, b, c, axis) > 0 ? 1 : -1;
  return tetfmt::doubled_area(a, b, p, axis) * sign > 0 && tetfmt::doubled_area(b, c, p, axis) * sign > 0 &&
         tetfmt::doubled_area(c, a, p, axis) * sign > 0;
}

bool in_one_plane(const std::vector<GridPoint>& points, const Corners& a, const Corners& b) {
  return sides(points, a, b) == std::array<int, 3>{};
}

Contact find_contact(const std::vector<GridPoint>& points, const Corners& a, const Corners& b) {
  Contact contact;
  add_points(points, a, b, sides(points, a, b), contact);
  add_points(points, b, a, sides(points, b, a), contact);
  return contact;
}

}  // namespace tetprep
