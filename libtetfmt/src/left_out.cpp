// SPDX-License-Identifier: MIT
#include "left_out.hpp"

#include <algorithm>
#include <numeric>
#include <string>

#include "box_tree.hpp"
#include "cells.hpp"
#include "report.hpp"

namespace tetfmt::detail {
namespace {

using Face = std::array<GridPoint, 3>;

/// Where a point lies relative to a directed edge, seen along an axis: -1, 0, 1.
int turn(const GridPoint& a, const GridPoint& b, const GridPoint& p, std::size_t axis) {
  const std::int64_t area = doubled_area(a, b, p, axis);
  return (area > 0) - (area < 0);
}

/// Closed segment and closed triangle in one plane, projected along an axis that keeps the triangle's area.
bool meets_in_plane(const GridPoint& p, const GridPoint& q, const Face& f, std::size_t axis) {
  const int whole = turn(f[0], f[1], f[2], axis);
  // Convex sets in a plane are apart exactly if a line along an edge of one of them separates them.
  for (std::size_t i = 0; i < 3; ++i) {
    const GridPoint &a = f[i], &b = f[(i + 1) % 3];
    if (whole * turn(a, b, p, axis) < 0 && whole * turn(a, b, q, axis) < 0) return false;
  }
  const int first = turn(p, q, f[0], axis), second = turn(p, q, f[1], axis), third = turn(p, q, f[2], axis);
  if (first != 0 || second != 0 || third != 0) return !(first * second > 0 && second * third > 0);
  return true;
}

/// Whether the closed segment and the closed triangle, which has an area, have a point in common.
bool meets(const GridPoint& p, const GridPoint& q, const Face& f) {
  const int of_p = orientation(f[0], f[1], f[2], p), of_q = orientation(f[0], f[1], f[2], q);
  if (of_p * of_q > 0) return false;
  if (of_p == 0 && of_q == 0) {
    std::size_t axis = 0;
    while (doubled_area(f[0], f[1], f[2], axis) == 0) ++axis;
    return meets_in_plane(p, q, f, axis);
  }
  const int a = orientation(p, q, f[0], f[1]), b = orientation(p, q, f[1], f[2]),
            c = orientation(p, q, f[2], f[0]);
  return (a >= 0 && b >= 0 && c >= 0) || (a <= 0 && b <= 0 && c <= 0);
}

class LeftOut {
 public:
  LeftOut(const FileView& view, const Topology& topology, const std::vector<GridPoint>& points,
          Report& report)
      : topology_(topology), points_(points), report_(report) {
    const auto sides = view.sides();
    for (Index side = 0; side < sides.size(); ++side) {
      if (sides[side].tet != kNone) continue;
      const Index t = sides[twin(side)].tet;
      sides_.push_back(twin(side));
      tets_.push_back(t);
      faces_.push_back(face_opposite(topology.tets[t].vertices, topology.side_rank[twin(side)]));
    }
  }

  void run() {
    check_crossings();
    check_sheets();
  }

 private:
  Face corners(std::size_t face) const {
    const auto& f = faces_[face];
    return {points_[f[0]], points_[f[1]], points_[f[2]]};
  }

  /// Ids of `a` that are corners of `b` too come first; returns how many.
  static std::size_t shared_first(std::array<Index, 3>& a, const std::array<Index, 3>& b) {
    const auto end = std::stable_partition(
        a.begin(), a.end(), [&](Index id) { return std::find(b.begin(), b.end(), id) != b.end(); });
    return static_cast<std::size_t>(end - a.begin());
  }

  bool cross(std::size_t first, std::size_t second) const {
    auto a = faces_[first], b = faces_[second];
    const std::size_t shared = shared_first(a, b);
    shared_first(b, a);
    const auto at = [&](Index id) { return points_[id]; };
    const Face whole_a = corners(first), whole_b = corners(second);
    if (shared == 3) return true;
    if (shared == 2) {  // beyond the edge they meet only if one is folded onto the other
      if (orientation(at(a[0]), at(a[1]), at(a[2]), at(b[2])) != 0) return false;
      std::size_t axis = 0;
      while (doubled_area(at(a[0]), at(a[1]), at(a[2]), axis) == 0) ++axis;
      return turn(at(a[0]), at(a[1]), at(a[2]), axis) == turn(at(a[0]), at(a[1]), at(b[2]), axis);
    }
    if (shared == 1) {
      // Convex, and both contain the corner: what they have in common beyond it reaches from there to the
      // opposite edge of one of them.
      return meets(at(a[1]), at(a[2]), whole_b) || meets(at(b[1]), at(b[2]), whole_a);
    }
    for (std::size_t i = 0; i < 3; ++i) {
      if (meets(whole_a[i], whole_a[(i + 1) % 3], whole_b) ||
          meets(whole_b[i], whole_b[(i + 1) % 3], whole_a))
        return true;
    }
    return false;
  }

  void check_crossings() {
    std::vector<GridBox> boxes(faces_.size());
    for (std::size_t i = 0; i < faces_.size(); ++i)
      for (const GridPoint& p : corners(i)) boxes[i].add(p);
    const BoxTree tree(boxes);
    for (std::size_t i = 0; i < faces_.size(); ++i) {
      tree.overlapping(boxes[i], [&](std::size_t j) {
        if (j <= i || !cross(i, j)) return;
        add_issue(report_, Code::crossing, sides_[i], [&] {
          return "the one-sided faces of sides " + str(sides_[i]) + " and " + str(sides_[j]) + " intersect";
        });
      });
    }
  }

  /// One face of each sheet: faces that are connected across edges with two of them, oriented alike.
  std::vector<std::size_t> samples() const {
    struct Use {
      std::array<Index, 2> edge;
      bool ascending;
      std::size_t face;
    };
    std::vector<Use> uses;
    for (std::size_t i = 0; i < faces_.size(); ++i) {
      const auto& f = faces_[i];
      const Index apex = topology_.tets[tets_[i]].vertices[topology_.side_rank[sides_[i]]];
      const bool inwards = orientation(points_[f[0]], points_[f[1]], points_[f[2]], points_[apex]) > 0;
      uses.push_back({{f[0], f[1]}, inwards, i});  // the ids of a face ascend
      uses.push_back({{f[1], f[2]}, inwards, i});
      uses.push_back({{f[0], f[2]}, !inwards, i});
    }
    std::sort(uses.begin(), uses.end(), [](const Use& a, const Use& b) {
      return a.edge != b.edge ? a.edge < b.edge : a.face < b.face;
    });
    std::vector<std::size_t> parent(faces_.size());
    std::iota(parent.begin(), parent.end(), std::size_t{0});
    const auto root = [&](std::size_t i) {
      while (parent[i] != i) i = parent[i] = parent[parent[i]];
      return i;
    };
    for (std::size_t i = 0; i < uses.size();) {
      std::size_t end = i;
      while (end < uses.size() && uses[end].edge == uses[i].edge) ++end;
      if (end == i + 2 && uses[i].ascending != uses[i + 1].ascending)
        parent[root(uses[i].face)] = root(uses[i + 1].face);
      i = end;
    }
    std::vector<std::size_t> chosen;
    for (std::size_t i = 0; i < parent.size(); ++i)
      if (parent[i] == i) chosen.push_back(i);
    return chosen;
  }

  void check_sheets() {
    constexpr std::int32_t kScale = 3;  // the centroid of a face has thirds
    const std::vector<std::size_t> chosen = samples();
    std::vector<GridBox> boxes(chosen.size());
    for (std::size_t i = 0; i < chosen.size(); ++i) {
      const Face f = corners(chosen[i]);
      GridPoint centroid{};
      for (std::size_t k = 0; k < 3; ++k) centroid[k] = f[0][k] + f[1][k] + f[2][k];
      boxes[i].add(centroid);
    }
    const BoxTree tree(boxes);
    for (Index t = 0; t < topology_.tets.size(); ++t) {
      const auto& v = topology_.tets[t].vertices;
      const std::array<GridPoint, 4> tet{points_[v[0]], points_[v[1]], points_[v[2]], points_[v[3]]};
      GridBox box;
      for (const GridPoint& p : tet) box.add(GridPoint{kScale * p[0], kScale * p[1], kScale * p[2]});
      tree.overlapping(box, [&](std::size_t i) {
        if (tets_[chosen[i]] == t || !contains(tet, boxes[i].lower, kScale)) return;
        add_issue(report_, Code::overlap, t, [&] {
          return "tet " + str(t) + " reaches into left-out space at the face of side " +
                 str(sides_[chosen[i]]);
        });
      });
    }
  }

  const Topology& topology_;
  const std::vector<GridPoint>& points_;
  Report& report_;
  // One-sided faces: the side that has a tetrahedron, that tetrahedron, the vertex ids.
  std::vector<Index> sides_, tets_;
  std::vector<std::array<Index, 3>> faces_;
};

}  // namespace

bool contains(const std::array<GridPoint, 4>& corners, const GridPoint& point, std::int32_t scale) {
  std::array<GridPoint, 4> p = corners;
  for (GridPoint& corner : p)
    for (std::int32_t& x : corner) x *= scale;
  for (std::size_t i = 0; i < 3; ++i) {  // most tetrahedra are far away
    const auto [low, high] = std::minmax({p[0][i], p[1][i], p[2][i], p[3][i]});
    if (point[i] < low || point[i] > high) return false;
  }
  const int whole = orientation(p[0], p[1], p[2], p[3]);
  return orientation(point, p[1], p[2], p[3]) != -whole && orientation(p[0], point, p[2], p[3]) != -whole &&
         orientation(p[0], p[1], point, p[3]) != -whole && orientation(p[0], p[1], p[2], point) != -whole;
}

void check_left_out(const FileView& view, const Topology& topology, const std::vector<GridPoint>& points,
                    Report& report) {
  LeftOut(view, topology, points, report).run();
}

}  // namespace tetfmt::detail
