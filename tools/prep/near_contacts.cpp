// SPDX-License-Identifier: AGPL-3.0-or-later
// The rounding of two triangles that are nearly parallel moves their intersection by far more than a step:
// cutting along it again and again makes ever more pieces of them, and no end. Snap rounding (Hobby 1999)
// ends because a segment that passes close to a point is led through it. The same here, for edges and
// triangles.
#include "prep/near_contacts.hpp"

#include <algorithm>
#include <bit>
#include <cmath>

#include "prep/box_tree.hpp"
#include "prep/contact.hpp"

namespace tetprep {
namespace {

using Corners = std::array<Index, 3>;
using Vector = std::array<double, 3>;

Vector difference(const GridPoint& to, const GridPoint& from) {
  return {static_cast<double>(to[0]) - from[0], static_cast<double>(to[1]) - from[1],
          static_cast<double>(to[2]) - from[2]};
}
double dot(const Vector& a, const Vector& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}
Vector cross(const Vector& a, const Vector& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

bool near_edge(const GridPoint& p, const GridPoint& q, const GridPoint& point, double reach) {
  const Vector along = difference(q, p), aside = difference(point, p);
  const double length = dot(along, along), position = dot(aside, along);
  if (position <= 0 || position >= length) return false;
  const Vector area = cross(along, aside);
  return dot(area, area) <= reach * reach * length;
}

bool near_inside(const GridPoint& a, const GridPoint& b, const GridPoint& c, const GridPoint& point,
                 double reach) {
  const Vector normal = cross(difference(b, a), difference(c, a));
  const double height = dot(normal, difference(point, a));
  return height * height <= reach * reach * dot(normal, normal) &&
         strictly_inside(a, b, c, point, widest_axis(a, b, c));
}

class Collector {
 public:
  Collector(const std::vector<GridPoint>& points, const std::vector<Corners>& triangles, std::int32_t reach)
      : points_(points), triangles_(triangles), reach_(reach) {}

  NearContacts run(const std::vector<Index>& which) {
    std::vector<Index> corners;
    for (const Index t : which) corners.insert(corners.end(), triangles_[t].begin(), triangles_[t].end());
    tidy(corners);
    const BoxTree tree(std::move(corners), [&](Index i) { return GridBox{points_[i], points_[i]}; });
    for (const Index t : which) look(t, tree);
    for (auto& [edge, list] : result_.of_edges) tidy(list);
    return std::move(result_);
  }

 private:
  static void tidy(std::vector<Index>& list) {
    std::sort(list.begin(), list.end());
    list.erase(std::unique(list.begin(), list.end()), list.end());
  }

  void look(Index triangle, const BoxTree& corners) {
    const Corners& t = triangles_[triangle];
    GridBox box = box_around(points_, t);
    for (std::size_t k = 0; k < 3; ++k) {
      box.low[k] -= reach_;
      box.high[k] += reach_;
    }
    corners.visit_leaves(box, 0, [&](std::size_t leaf) {
      for (unsigned near = corners.leaf(leaf).overlapping(box); near != 0; near &= near - 1)
        look_at_corner(triangle, corners.item(leaf, static_cast<std::size_t>(std::countr_zero(near))));
    });
    // Thinner than the reach itself: led through its own corner, it vanishes.
    for (std::size_t i = 0; i < 3; ++i) look_at_edge(t[i], t[(i + 1) % 3], t[(i + 2) % 3]);
  }

  void look_at_corner(Index triangle, Index corner) {
    const Corners& t = triangles_[triangle];
    if (std::find(t.begin(), t.end(), corner) != t.end()) return;
    bool at_edge = false;
    for (std::size_t i = 0; i < 3; ++i) at_edge |= look_at_edge(t[i], t[(i + 1) % 3], corner);
    if (!at_edge && near_inside(points_[t[0]], points_[t[1]], points_[t[2]], points_[corner], reach_))
      result_.of_triangles[triangle].push_back(corner);
  }

  bool look_at_edge(Index p, Index q, Index corner) {
    const std::array<Index, 2> edge{std::min(p, q), std::max(p, q)};
    if (!near_edge(points_[edge[0]], points_[edge[1]], points_[corner], reach_)) return false;
    result_.of_edges[edge].push_back(corner);
    return true;
  }

  const std::vector<GridPoint>& points_;
  const std::vector<Corners>& triangles_;
  const std::int32_t reach_;
  NearContacts result_;
};

}  // namespace

NearContacts find_near_contacts(const std::vector<GridPoint>& points, const std::vector<Corners>& triangles,
                                const std::vector<Index>& which, std::int32_t reach) {
  return Collector(points, triangles, reach).run(which);
}

}  // namespace tetprep
