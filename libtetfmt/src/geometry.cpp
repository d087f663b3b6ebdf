// SPDX-License-Identifier: MIT
// Why these checks prove that every interior point is covered exactly once (spec/format.md has the proof):
// no tetrahedron is flat and neighbours lie on opposite sides of each shared face, so the map from the glued
// complex to space preserves orientation, and how often a point is covered can only change where the boundary
// is. The boundary is the hull, whose faces all lie on the surface of a convex body; so the number is the
// same everywhere inside. No second tetrahedron meets the centroid of tetrahedron 0; so that number is one.
#include "geometry.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <numeric>
#include <string>

#include "cells.hpp"
#include "left_out.hpp"
#include "report.hpp"

namespace tetfmt::detail {
namespace {

class Geometry {
 public:
  Geometry(const FileView& view, const Topology& topology, Report& report)
      : view_(view),
        topology_(topology),
        tets_(topology.tets),
        side_rank_(topology.side_rank),
        report_(report) {}

  void run() {
    if (!to_grid()) return;
    if (!check_orientation()) return;
    check_hull();
    check_overlap();
    if (view_.partial()) check_left_out(view_, topology_, points_, report_);
    check_faces();
  }

 private:
  template <class MakeText>
  void add(Code code, std::uint64_t where, MakeText&& make_text) {
    add_issue(report_, code, where, std::forward<MakeText>(make_text));
  }

  std::array<GridPoint, 4> corners(const FullTet& tet) const {
    return {points_[tet.vertices[0]], points_[tet.vertices[1]], points_[tet.vertices[2]],
            points_[tet.vertices[3]]};
  }

  bool to_grid() {
    for (std::size_t i = 0; i < 3; ++i) {
      if (!std::isfinite(view_.header().origin[i])) {
        add(Code::non_finite, i, [&] { return "the origin's coordinate " + str(i) + " is not finite"; });
      }
    }
    const double per_unit = std::ldexp(1.0, -view_.header().grid_exponent);
    points_.resize(view_.vertices().size());
    std::uint32_t low_bits = 0;
    for (std::size_t id = 0; id < points_.size(); ++id) {
      const Vec3f& p = view_.vertices()[id];
      const double scaled[3] = {p.x * per_unit, p.y * per_unit, p.z * per_unit};  // exact: a power of two
      for (std::size_t i = 0; i < 3; ++i) {
        if (!std::isfinite(scaled[i])) {
          add(Code::non_finite, id, [&] { return "vertex " + str(id) + ": a coordinate is not finite"; });
        } else if (std::abs(scaled[i]) > static_cast<double>(kMaxGridCoordinate) ||
                   scaled[i] != std::rint(scaled[i])) {
          add(Code::off_grid, id, [&] {
            return "vertex " + str(id) + ": coordinate " + std::to_string(scaled[i]) +
                   " grid steps is not an integer of at most 2^24";
          });
        } else {
          points_[id][i] = static_cast<std::int32_t>(scaled[i]);
          low_bits |= static_cast<std::uint32_t>(points_[id][i]);
        }
      }
    }
    if (report_.valid() && low_bits % 2 == 0) {
      add(Code::grid_not_canonical, 88, [&] {
        return "all coordinates are even multiples of 2^" + std::to_string(view_.header().grid_exponent);
      });
    }
    return report_.valid();
  }

  /// No tetrahedron is flat, and each is oriented as the gluing demands. Sets orientation_.
  bool check_orientation() {
    std::vector<std::int8_t> found(tets_.size());
    std::size_t flat = 0;
    for (std::size_t t = 0; t < tets_.size(); ++t) {
      const auto [a, b, c, d] = corners(tets_[t]);
      found[t] = static_cast<std::int8_t>(orientation(a, b, c, d));
      if (found[t] != 0) continue;
      ++flat;
      add(Code::flat, t, [&] { return "the four vertices of tet " + str(t) + " lie in a plane"; });
    }
    if (flat > 0) return false;

    orientation_ = topology_.orientation;
    for (std::size_t i = 0; i < topology_.components.size(); ++i) {
      const std::size_t begin = topology_.components[i];
      const std::size_t end =
          i + 1 < topology_.components.size() ? topology_.components[i + 1] : topology_.order.size();
      const std::span<const Index> component = std::span(topology_.order).subspan(begin, end - begin);
      std::size_t positive = 0;
      for (const Index t : component) positive += found[t] == orientation_[t];
      const bool flip = 2 * positive < component.size();  // the few that differ are the wrong ones
      for (const Index t : component) {
        if (flip) orientation_[t] = static_cast<std::int8_t>(-orientation_[t]);
        if (found[t] == orientation_[t]) continue;
        add(Code::inverted, t,
            [&] { return "tet " + str(t) + " lies on the same side of a face as its neighbour"; });
      }
    }
    for (const std::array<Index, 2>& pair : topology_.twisted) {
      add(Code::inverted, pair[0], [&] {
        return "tets " + str(pair[0]) + " and " + str(pair[1]) + " lie on the same side of their shared face";
      });
    }
    return true;
  }

  /// Sign of the tetrahedron's vertices taken in ascending order.
  int orientation_of(Index t) const { return orientation_[t]; }

  /// Sign of (face opposite rank k, taken ascending; apex): the apex has to move past 3 - k ids.
  int apex_side(Index t, std::size_t k) const { return k % 2 == 1 ? orientation_of(t) : -orientation_of(t); }

  void check_hull() {
    std::vector<Index> hull_vertices;
    if (view_.partial()) {
      // A vertex beside left-out space need not be surrounded by tetrahedra: all have to be looked at.
      hull_vertices.resize(points_.size());
      std::iota(hull_vertices.begin(), hull_vertices.end(), Index{0});
    } else {
      for (const HullFace& face : view_.hull())
        hull_vertices.insert(hull_vertices.end(), face.vertices.begin(), face.vertices.end());
      std::sort(hull_vertices.begin(), hull_vertices.end());
      hull_vertices.erase(std::unique(hull_vertices.begin(), hull_vertices.end()), hull_vertices.end());
    }

    for (std::size_t i = 0; i < view_.hull().size(); ++i) {
      const HullFace& face = view_.hull()[i];
      const auto& vertices = tets_[face.tet].vertices;
      std::size_t k = 0;
      while (k < 3 && vertices[k] == face.vertices[k]) ++k;
      const int inside = apex_side(face.tet, k);
      for (const Index id : hull_vertices) {
        const auto& f = face.vertices;
        if (orientation(points_[f[0]], points_[f[1]], points_[f[2]], points_[id]) != -inside) continue;
        add(Code::hull_not_convex, i, [&] {
          return "vertex " + str(id) + " lies outside hull face " + str(i) + " of tet " + str(face.tet);
        });
        break;
      }
    }
  }

  void check_overlap() {
    // Four times the points, so that the centroid has integer coordinates too.
    GridPoint centroid{};
    for (const GridPoint& p : corners(tets_[0]))
      for (std::size_t i = 0; i < 3; ++i) centroid[i] += p[i];
    for (Index t = 1; t < tets_.size(); ++t) {
      if (!contains(corners(tets_[t]), centroid, 4)) continue;
      add(Code::overlap, t, [&] { return "tet " + str(t) + " covers the centroid of tet 0 too"; });
    }
  }

  /// Every face lies in its triangle with its front side in front, and together they cover it: faces of a
  /// tiling do not overlap, so it is enough that their areas add up.
  void check_faces() {
    remaining_.assign(view_.triangles().size(), kUntouched);
    for (Index side = 0; side < side_rank_.size(); side += 2) check_face(side);
    for (std::size_t i = 0; i < remaining_.size(); ++i) {
      if (remaining_[i] == 0 || view_.triangles()[i].dropped()) continue;
      add(Code::not_covered, i, [&] {
        return "triangle " + str(i) +
               (remaining_[i] == kUntouched ? " has no faces" : " is not covered exactly once by its faces");
      });
    }
  }

  void check_face(Index side) {
    const Index triangle = view_.sides()[side].triangle;
    const bool front = view_.sides()[side].tet != kNone;  // else what is in front was left out
    const Index seen = front ? side : twin(side);
    const Index t = view_.sides()[seen].tet;
    const std::size_t k = side_rank_[seen];
    std::array<Index, 3> face = face_opposite(tets_[t].vertices, k);
    if ((apex_side(t, k) < 0) == front) std::swap(face[1], face[2]);  // now its normal points to the front
    const auto& corner = view_.triangles()[triangle].vertices;
    std::int64_t& remaining = remaining_[triangle];

    const auto rotated = [&](std::size_t i, std::size_t j, std::size_t l) {
      return face[0] == corner[i] && face[1] == corner[j] && face[2] == corner[l];
    };
    if (rotated(0, 1, 2) || rotated(1, 2, 0) || rotated(2, 0, 1)) {  // the whole triangle, the usual case
      remaining = remaining == kUntouched ? 0 : kOvercovered;
      return;
    }
    const std::size_t axis = main_axis(corner);
    const std::int64_t area = projected(face, axis), whole = projected(corner, axis);
    if (whole == 0 || !inside_triangle(face, corner, axis)) {  // no face is part of a triangle without area
      add(Code::off_triangle, side,
          [&] { return "the face of side " + str(side) + " is not a part of triangle " + str(triangle); });
    } else if ((area > 0) != (whole > 0)) {
      add(Code::wrong_side, side, [&] {
        return "tet " + str(t) + " of side " + str(seen) + " lies on the other side of triangle " +
               str(triangle);
      });
    }
    if (remaining == kUntouched) remaining = std::abs(whole);
    remaining = remaining == kOvercovered ? kOvercovered : std::max(remaining - std::abs(area), kOvercovered);
  }

  bool inside_triangle(const std::array<Index, 3>& face, const std::array<Index, 3>& corner,
                       std::size_t axis) const {
    const GridPoint &a = points_[corner[0]], &b = points_[corner[1]], &c = points_[corner[2]];
    const std::int64_t whole = projected(corner, axis);
    return std::all_of(face.begin(), face.end(), [&](Index id) {
      if (std::find(corner.begin(), corner.end(), id) != corner.end()) return true;
      const GridPoint& p = points_[id];
      const auto within = [&](std::int64_t part) { return whole > 0 ? part >= 0 : part <= 0; };
      return orientation(a, b, c, p) == 0 && within(doubled_area(a, b, p, axis)) &&
             within(doubled_area(b, c, p, axis)) && within(doubled_area(c, a, p, axis));
    });
  }

  std::int64_t projected(const std::array<Index, 3>& v, std::size_t axis) const {
    return doubled_area(points_[v[0]], points_[v[1]], points_[v[2]], axis);
  }

  /// The axis along which the triangle's projection is largest: zero area there means no area at all.
  std::size_t main_axis(const std::array<Index, 3>& v) const {
    std::size_t best = 0;
    for (std::size_t axis = 1; axis < 3; ++axis)
      if (std::abs(projected(v, axis)) > std::abs(projected(v, best))) best = axis;
    return best;
  }

  const FileView& view_;
  const Topology& topology_;
  const std::vector<FullTet>& tets_;
  const std::vector<std::uint8_t>& side_rank_;
  Report& report_;
  std::vector<GridPoint> points_;
  std::vector<std::int8_t> orientation_;  ///< topology_.orientation, with each component's sign settled
  /// Of each triangle: the doubled area, projected along its main axis, that no face has covered yet.
  std::vector<std::int64_t> remaining_;
  static constexpr std::int64_t kUntouched = std::numeric_limits<std::int64_t>::max(), kOvercovered = -1;
};

}  // namespace

void check_geometry(const FileView& view, const Topology& topology, Report& report) {
  Geometry(view, topology, report).run();
}

}  // namespace tetfmt::detail
