// SPDX-License-Identifier: AGPL-3.0-or-later
// CGAL's constrained Delaunay triangulation of the plane, with exact constructions. Seen along the axis that
// keeps most of the area; a point's third coordinate follows from the plane's equation. The numbers are lazy
// ones, and every call makes its own from integers: none is ever seen by two threads.
#include "prep/cut_triangles.hpp"

#include <CGAL/Constrained_Delaunay_triangulation_2.h>
#include <CGAL/Constrained_triangulation_plus_2.h>
#include <CGAL/Exact_predicates_exact_constructions_kernel.h>
#include <CGAL/Triangulation_face_base_with_info_2.h>
#include <CGAL/Triangulation_vertex_base_with_info_2.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "prep/contact.hpp"

namespace tetprep {
namespace {

using Kernel = CGAL::Exact_predicates_exact_constructions_kernel;
using Number = Kernel::FT;

struct VertexNote {
  Index id = kNone;  ///< as in CutPiece::corners; kNone: not known yet
};
struct FaceNote {
  Index number = kNone;
  Index owner = kNone;
};
using VertexBase = CGAL::Triangulation_vertex_base_with_info_2<VertexNote, Kernel>;
using FaceBase =
    CGAL::Triangulation_face_base_with_info_2<FaceNote, Kernel,
                                              CGAL::Constrained_triangulation_face_base_2<Kernel>>;
using Cdt = CGAL::Constrained_Delaunay_triangulation_2<
    Kernel, CGAL::Triangulation_data_structure_2<VertexBase, FaceBase>, CGAL::Exact_intersections_tag>;
// With the constraints' own ends at hand, crossings are built from those, however often a constraint is cut.
using Arrangement = CGAL::Constrained_triangulation_plus_2<Cdt>;
using Vertex = Arrangement::Vertex_handle;
using Face = Arrangement::Face_handle;

Number exact_number(Wide value) {
  constexpr int kBits = 40;  // both parts are exact doubles: the value is below 2^80
  const Wide high = value >> kBits;
  const auto low = static_cast<double>(static_cast<std::int64_t>(value - (high << kBits)));
  return Number(std::ldexp(static_cast<double>(static_cast<std::int64_t>(high)), kBits)) + Number(low);
}

/// The nearest integer, halves upwards. floor() and the difference are exact, or err on the same side.
double round_half_up(double value) {
  const double floor = std::floor(value);
  return value - floor >= 0.5 ? floor + 1 : floor;
}

std::int32_t round_exactly(const Number& value) {
  auto [low, high] = CGAL::to_interval(value);
  double rounded = round_half_up(high);
  if (round_half_up(low) != rounded) {  // too wide, or a half lies within
    value.exact();
    std::tie(low, high) = CGAL::to_interval(value);
    rounded = round_half_up(high);
    if (round_half_up(low) != rounded && value < Number(rounded - 0.5)) --rounded;
  }
  return static_cast<std::int32_t>(rounded);
}

class Cutter {
 public:
  Cutter(const std::vector<GridPoint>& points, const std::vector<std::array<Index, 3>>& triangles,
         const CutTask& task, std::size_t most_pieces)
      : points_(points), triangles_(triangles), task_(task), most_pieces_(most_pieces) {
    choose_plane(triangles[task.members.front()]);
  }

  CutResult run() {
    for (const Index member : task_.members)
      for (const Index corner : triangles_[member]) vertex_of(corner);
    if (task_.members.size() > 1)
      for (const Index member : task_.members) insert_outline(member);
    for (const auto& [p, q, through] : task_.edge_bends) bend_edge(p, q, through);
    for (const auto& [member, through] : task_.inner_bends) bend(at(points_[through]), through);
    for (const auto& [member, other] : task_.contacts) {
      insert_contact(member, other);
      result_.too_many = arrangement_.number_of_faces() > most_pieces_;
      if (result_.too_many) return std::move(result_);
    }
    find_owners();
    collect();
    return std::move(result_);
  }

 private:
  void choose_plane(const std::array<Index, 3>& t) {
    const GridPoint &a = points_[t[0]], &b = points_[t[1]], &c = points_[t[2]];
    for (std::size_t k = 0; k < 3; ++k) normal_[k] = tetfmt::doubled_area(a, b, c, k);
    axis_ = widest_axis(a, b, c);
    base_ = a;
  }

  std::size_t first_axis() const { return (axis_ + 1) % 3; }
  std::size_t second_axis() const { return (axis_ + 2) % 3; }

  /// The point as it is seen.
  Kernel::Point_2 at(const GridPoint& p) const { return {Number(p[first_axis()]), Number(p[second_axis()])}; }

  /// The vertex at a point of the surface that lies in the plane.
  Vertex vertex_of(Index id) {
    const auto [place, fresh] = by_id_.try_emplace(id);
    if (fresh) {
      const GridPoint& p = points_[id];
      place->second = insert(at(p));
      place->second->info().id = id;
    }
    return place->second;
  }

  Vertex vertex_of(const ContactPoint& contact) {
    if (contact.q == kNone) return vertex_of(contact.p);
    return insert(at(contact));
  }

  Kernel::Point_2 at(const ContactPoint& contact) const {
    const GridPoint &p = points_[contact.p], &q = points_[contact.q];
    const Number share = exact_number(contact.numerator) / exact_number(contact.denominator);
    const auto coordinate = [&](std::size_t k) { return Number(p[k]) + share * Number(q[k] - p[k]); };
    return {coordinate(first_axis()), coordinate(second_axis())};
  }

  Vertex insert(const Kernel::Point_2& place) {
    const Vertex vertex = arrangement_.insert(place, hint_);
    hint_ = vertex->face();
    return vertex;
  }

  /// What is `place` in the arrangement will be the point `through` in space.
  void bend(const Kernel::Point_2& place, Index through) {
    Index& id = insert(place)->info().id;
    if (id == kNone) id = through;
  }

  /// At the place on the edge that is nearest to the point: the same one for every triangle with this edge.
  void bend_edge(Index from, Index to, Index through) {
    const GridPoint &p = points_[from], &q = points_[to], &r = points_[through];
    std::int64_t position = 0, length = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      const std::int64_t along = std::int64_t{q[k]} - p[k];
      position += along * (std::int64_t{r[k]} - p[k]);
      length += along * along;
    }
    bend(at(ContactPoint{from, to, position, length}), through);
  }

  Arrangement::Constraint_id connect(Vertex from, Vertex to) {
    const auto constraint = arrangement_.insert_constraint(from, to);
    hint_ = from->face();  // the faces on the way are new ones
    return constraint;
  }

  void insert_outline(Index member) {
    const auto& t = triangles_[member];
    for (std::size_t i = 0; i < 3; ++i) {
      const std::array<Index, 2> edge{std::min(t[i], t[(i + 1) % 3]), std::max(t[i], t[(i + 1) % 3])};
      auto& [constraint, members] = outlines_[edge];
      if (members.empty()) constraint = connect(vertex_of(edge[0]), vertex_of(edge[1]));
      members.push_back(member);
    }
  }

  void insert_contact(Index member, Index other) {
    const Contact contact = find_contact(points_, triangles_[member], triangles_[other]);
    Vertex first, second;
    for (std::size_t i = 0; i < contact.count; ++i) {
      const Vertex vertex = vertex_of(contact.points[i]);
      if (first == Vertex()) first = vertex;
      if (vertex != first) second = vertex;
    }
    if (second != Vertex()) connect(first, second);
  }

  /// Walks through all faces, keeping track of the members that cover the present one: crossing an outline
  /// enters or leaves its triangle.
  void find_owners() {
    if (task_.members.size() == 1) {  // the arrangement is that triangle
      for (const Face face : arrangement_.finite_face_handles()) face->info().owner = task_.members.front();
      return;
    }
    Index count = 0;
    for (const Face face : arrangement_.all_face_handles()) face->info().number = count++;
    std::vector<std::pair<Index, Index>> crossings;  // 3 * face + edge, member
    for (const auto& [edge, outline] : outlines_) {
      auto at = arrangement_.vertices_in_constraint_begin(outline.first);
      const auto end = arrangement_.vertices_in_constraint_end(outline.first);
      for (auto next = std::next(at); next != end; at = next++) {
        Face face;
        int side = 0;
        arrangement_.is_edge(*at, *next, face, side);
        const Face twin = face->neighbor(side);
        for (const Index member : outline.second) {
          crossings.emplace_back(3 * face->info().number + static_cast<Index>(side), member);
          crossings.emplace_back(3 * twin->info().number + static_cast<Index>(twin->index(face)), member);
        }
      }
    }
    std::sort(crossings.begin(), crossings.end());

    std::set<Index> covering;
    const auto cross = [&](Face face, int side) {
      const Index key = 3 * face->info().number + static_cast<Index>(side);
      for (auto i = std::lower_bound(crossings.begin(), crossings.end(), std::pair<Index, Index>{key, 0});
           i != crossings.end() && i->first == key; ++i)
        if (const auto [place, fresh] = covering.insert(i->second); !fresh) covering.erase(place);
    };
    struct Step {
      Face face;
      int entry;  ///< the side that it was entered by
      int next = 0;
    };
    std::vector<bool> seen(count, false);
    const Face start = arrangement_.infinite_face();
    seen[start->info().number] = true;
    std::vector<Step> path{{start, -1}};
    while (!path.empty()) {
      Step& step = path.back();
      if (step.next == 3) {
        if (step.entry >= 0) cross(step.face, step.entry);  // undo
        path.pop_back();
        continue;
      }
      const int side = step.next++;
      const Face beyond = step.face->neighbor(side);
      if (seen[beyond->info().number]) continue;
      seen[beyond->info().number] = true;
      const int entry = beyond->index(step.face);
      cross(step.face, side);
      if (!covering.empty()) {
        beyond->info().owner = *covering.begin();
        result_.overlaps += covering.size() - 1;
      }
      path.push_back({beyond, entry});
    }
  }

  void collect() {
    const auto sign = [&](Index member) {
      const auto& t = triangles_[member];
      return tetfmt::doubled_area(points_[t[0]], points_[t[1]], points_[t[2]], axis_) > 0;
    };
    for (const Face face : arrangement_.finite_face_handles()) {
      const Index owner = face->info().owner;
      if (owner == kNone) continue;
      CutPiece piece{owner, {}};
      for (int i = 0; i < 3; ++i) piece.corners[static_cast<std::size_t>(i)] = id_of(face->vertex(i));
      if (!sign(owner)) std::swap(piece.corners[1], piece.corners[2]);
      result_.pieces.push_back(piece);
    }
    std::stable_sort(result_.pieces.begin(), result_.pieces.end(),
                     [](const CutPiece& a, const CutPiece& b) { return a.owner < b.owner; });
  }

  Index id_of(Vertex vertex) {
    Index& id = vertex->info().id;
    if (id != kNone) return id;
    id = static_cast<Index>(points_.size() + result_.new_points.size());
    const Number u = vertex->point().x(), v = vertex->point().y();
    const std::size_t i = first_axis(), j = second_axis();
    // normal * (p - base) = 0
    const Number rise = (exact_number(normal_[i]) * (u - Number(base_[i])) +
                         exact_number(normal_[j]) * (v - Number(base_[j]))) /
                        exact_number(-Wide{normal_[axis_]});
    std::array<Number, 3> exact;
    exact[i] = u;
    exact[j] = v;
    exact[axis_] = Number(base_[axis_]) + rise;
    GridPoint rounded{};
    for (std::size_t k = 0; k < 3; ++k) rounded[k] = round_exactly(exact[k]);
    result_.new_points.push_back(rounded);
    return id;
  }

  const std::vector<GridPoint>& points_;
  const std::vector<std::array<Index, 3>>& triangles_;
  const CutTask& task_;
  const std::size_t most_pieces_;
  std::array<std::int64_t, 3> normal_{};
  std::size_t axis_ = 0;  ///< the plane is seen from here
  GridPoint base_{};
  Arrangement arrangement_;
  Face hint_;
  std::map<Index, Vertex> by_id_;
  /// Edges of members (ends ascending), if there are several members, and whose edges they are.
  std::map<std::array<Index, 2>, std::pair<Arrangement::Constraint_id, std::vector<Index>>> outlines_;
  CutResult result_;
};

}  // namespace

CutResult cut_triangles(const std::vector<GridPoint>& points,
                        const std::vector<std::array<Index, 3>>& triangles, const CutTask& task,
                        std::size_t most_pieces) {
  return Cutter(points, triangles, task, most_pieces).run();
}

}  // namespace tetprep
