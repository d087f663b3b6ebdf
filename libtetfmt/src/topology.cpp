// SPDX-License-Identifier: MIT
#include "topology.hpp"

#include <algorithm>
#include <string>

#include "cells.hpp"
#include "report.hpp"

namespace tetfmt::detail {
namespace {

std::string ids(std::span<const Index> values) {
  std::string text = "(";
  for (const Index value : values) text += (text.size() > 1 ? " " : "") + str(value);
  return text + ")";
}

/// "tet 5", "side 7 (tet 3)" or "the hull", for messages.
std::string ref_text(Ref ref) {
  if (ref == kHull) return "the hull";
  return is_tet(ref) ? "tet " + str(ref) : "side " + str(side_index(ref));
}

template <class Cells>
class Walk {
 public:
  Walk(const FileView& view, const Cells& cells, Report& report)
      : view_(view),
        cells_(cells),
        report_(report),
        vertex_count_(static_cast<Index>(view.vertices().size())) {}

  Topology run() {
    const Index tet_count = view_.tet_count();
    topology_.tets.resize(tet_count);
    topology_.side_rank.resize(view_.sides().size());
    topology_.orientation.resize(tet_count);
    verified_.resize(tet_count);
    side_uses_.resize(view_.sides().size());
    hull_seen_.resize(view_.hull().size());
    topology_.order.reserve(tet_count);

    for (std::size_t i = 0; i < view_.sources().size(); ++i) {
      start_from(i);
      // Everything that this source reaches, before the next one starts: orientations are relative to it.
      if (visited_ < topology_.order.size()) topology_.components.push_back(visited_);
      for (; visited_ < topology_.order.size(); ++visited_) visit(topology_.order[visited_]);
    }
    check_tables();
    if (report_.valid()) check_reached();  // after any other problem these would only repeat it
    return std::move(topology_);
  }

 private:
  template <class MakeText>
  void add(Code code, std::uint64_t where, MakeText&& make_text) {
    add_issue(report_, code, where, std::forward<MakeText>(make_text));
  }

  /// Source tet `i` against its cell; it seeds the walk if it is sound and new.
  void start_from(std::size_t i) {
    const SourceTet& source = view_.sources()[i];
    const auto& v = source.vertices;
    const auto mismatch = [&](const char* what) {
      add(Code::source_mismatch, i, [&] { return "source tet " + str(i) + ": " + what; });
    };
    if (source.reserved != 0) mismatch("the reserved word is not zero");
    if (source.tet >= view_.tet_count()) {
      mismatch("names a tet that does not exist");
    } else if (!(v[0] < v[1] && v[1] < v[2] && v[2] < v[3] && v[3] < vertex_count_)) {
      mismatch("vertex ids do not ascend, or leave the vertex array");
    } else if (cells_.vertex_xor(source.tet) != (v[0] ^ v[1] ^ v[2] ^ v[3])) {
      mismatch("the vertex ids do not give the cell's xor");
    } else if (cells_.neighbors(source.tet, source.neighbors[3], 3) != source.neighbors) {
      mismatch("the neighbours are not the cell's");
    } else if (!reached(source.tet)) {
      reach(source.tet, {v, source.neighbors}, 1);
    } else if (topology_.tets[source.tet] != FullTet{v, source.neighbors}) {
      mismatch("contradicts another source tet");
    }
  }

  bool reached(Index t) const { return topology_.orientation[t] != 0; }

  void reach(Index t, const FullTet& tet, int orientation) {
    topology_.tets[t] = tet;
    topology_.orientation[t] = static_cast<std::int8_t>(orientation);
    topology_.order.push_back(t);
  }

  void visit(Index t) {
    const FullTet tet = topology_.tets[t];
    for (std::size_t k = 0; k < 4; ++k) {
      if (verified_[t] >> k & 1u) continue;  // looked at from both ends when the neighbour was visited
      const Ref ref = tet.neighbors[k];
      const auto face = face_opposite(tet.vertices, k);
      if (ref == kHull) {
        leave_hull(t, face);
      } else if (is_side(ref)) {
        cross_side(t, face, k, side_index(ref));
      } else if (ref >= view_.tet_count()) {
        add(Code::reference_range, t, [&] { return "tet " + str(t) + " refers to " + ref_text(ref); });
      } else {
        enter_from({t, k}, ref, face, t);
      }
    }
  }

  void leave_hull(Index t, const std::array<Index, 3>& face) {
    const auto hull = view_.hull();
    const HullFace wanted = {t, face};
    const auto found = std::lower_bound(hull.begin(), hull.end(), wanted);
    const auto i = static_cast<std::size_t>(found - hull.begin());
    if (found == hull.end() || *found != wanted) {
      add(Code::hull_mismatch, t,
          [&] { return "hull face " + ids(face) + " of tet " + str(t) + " is not listed"; });
    } else {
      hull_seen_[i] = 1;
    }
  }

  void cross_side(Index t, const std::array<Index, 3>& face, std::size_t k, Index side) {
    const auto sides = view_.sides();
    if (side >= sides.size()) {
      add(Code::reference_range, t, [&] { return "tet " + str(t) + " refers to side " + str(side); });
      return;
    }
    if (side_uses_[side] < 2) ++side_uses_[side];
    topology_.side_rank[side] = static_cast<std::uint8_t>(k);
    if (sides[side].tet != t) {
      add(Code::side_tet, side, [&] {
        return "side " + str(side) + " names tet " + str(sides[side].tet) + ", tet " + str(t) +
               " refers to it";
      });
    }
    const Index beyond = sides[twin(side)].tet;
    if (beyond == kNone && view_.partial()) return;  // check_tables() looks at those
    if (beyond >= view_.tet_count()) {
      add(Code::reference_range, twin(side),
          [&] { return "side " + str(twin(side)) + " names tet " + str(beyond) + ", which does not exist"; });
      return;
    }
    enter_from({t, k}, beyond, face, side_ref(twin(side)));
  }

  /// One end of a link between tetrahedra: `tet`, across the face opposite its vertex of this rank.
  struct End {
    Index tet;
    std::size_t rank;
  };

  /// What lies across a face is another tetrahedron, and no other face leads there.
  void enter_from(End origin, Index beyond, const std::array<Index, 3>& face, Ref previous) {
    const Index t = origin.tet;
    if (beyond == t) {
      add(Code::self_neighbor, t, [&] { return "tet " + str(t) + " refers to itself"; });
      return;
    }
    const auto& neighbors = topology_.tets[t].neighbors;
    for (std::size_t k = origin.rank + 1; k < 4; ++k) {
      if (tet_behind(neighbors[k]) != beyond) continue;
      add(Code::duplicate_neighbor, t,
          [&] { return "tet " + str(t) + " borders on tet " + str(beyond) + " across two faces"; });
    }
    enter(beyond, face, previous, origin);
  }

  /// The tetrahedron that a reference leads to, through a constrained face too; kNone if there is none.
  Index tet_behind(Ref ref) const {
    if (is_tet(ref)) return ref;
    if (ref == kHull || side_index(ref) >= view_.sides().size()) return kNone;
    return view_.sides()[twin(side_index(ref))].tet;
  }

  /// Tetrahedron `t` is entered across `face`, behind which it must refer to `previous`, from `origin`.
  void enter(Index t, const std::array<Index, 3>& face, Ref previous, End origin) {
    const Index apex = cells_.vertex_xor(t) ^ face[0] ^ face[1] ^ face[2];
    const std::size_t apex_rank = rank(apex, face[0], face[1], face[2]);
    // The apexes lie on opposite sides of the face. An apex of odd rank lies where the face's ascending order
    // points in a positive tetrahedron, one of even rank in a negative one.
    const int sign = topology_.orientation[origin.tet] * ((origin.rank ^ apex_rank) % 2 == 1 ? 1 : -1);
    if (!reached(t)) {
      if (apex >= vertex_count_) {
        add(Code::vertex_range, t, [&] {
          return "tet " + str(t) + ", entered across face " + ids(face) + ", would have vertex " + str(apex);
        });
        return;
      }
      if (apex == face[0] || apex == face[1] || apex == face[2]) {
        add(Code::repeated_vertex, t, [&] {
          return "tet " + str(t) + ", entered across face " + ids(face) + ", would have vertex " + str(apex) +
                 " twice";
        });
        return;
      }
      reach(t, {insert_apex(face, apex, apex_rank), cells_.neighbors(t, previous, apex_rank)}, sign);
    } else if (!same(topology_.tets[t].vertices, insert_apex(face, apex, apex_rank))) {
      add(Code::face_mismatch, t, [&] {
        return "tet " + str(t) + " " + ids(topology_.tets[t].vertices) + " has no face " + ids(face) +
               ", across which " + ref_text(previous) + " leads to it";
      });
      return;
    }
    if (topology_.tets[t].neighbors[apex_rank] != previous) {
      asymmetric(t, topology_.tets[t].neighbors[apex_rank], previous);
      return;
    }
    if (topology_.orientation[t] != sign) topology_.twisted.push_back({origin.tet, t});
    // A side's own entry in the table is looked at only from its own tetrahedron.
    if (is_tet(previous)) verified_[t] |= static_cast<std::uint8_t>(1u << apex_rank);
  }

  /// Written out: a library call would cost more than the comparison.
  static bool same(const std::array<Index, 4>& a, const std::array<Index, 4>& b) {
    return ((a[0] ^ b[0]) | (a[1] ^ b[1]) | (a[2] ^ b[2]) | (a[3] ^ b[3])) == 0;
  }

  void asymmetric(Index t, Ref found, Ref expected) {
    add(Code::asymmetric, t, [&] {
      return "tet " + str(t) + " refers to " + ref_text(found) + " across the face where " +
             ref_text(expected) + " leads to it";
    });
  }

  void check_tables() {
    const auto triangles = view_.triangles();
    for (std::size_t i = 0; i < triangles.size(); ++i) {
      const auto& v = triangles[i].vertices;
      const bool none = v[0] == kNone && v[1] == kNone && v[2] == kNone;
      const bool whole =
          std::max({v[0], v[1], v[2]}) < vertex_count_ && v[0] != v[1] && v[1] != v[2] && v[2] != v[0];
      if (!none && !whole) {
        add(Code::triangle_corner, i, [&] { return "triangle " + str(i) + " has corners " + ids(v); });
      }
    }
    const auto sides = view_.sides();
    std::size_t absent = 0;
    for (Index i = 0; i < sides.size(); ++i) {
      const Side& side = sides[i];
      if (side.triangle >= triangles.size() || triangles[side.triangle].dropped()) {
        add(Code::triangle_range, i, [&] {
          return "side " + str(i) + " names triangle " + str(side.triangle) + ", absent or dropped";
        });
      }
      if (side.material >= view_.material_count()) {
        add(Code::material_range, i, [&] {
          return "side " + str(i) + " names material " + str(side.material) + " of " +
                 str(view_.material_count());
        });
      }
      const Side& other = sides[twin(i)];
      if (i % 2 == 0 && (side.triangle != other.triangle || side.material != other.material)) {
        add(Code::twin_mismatch, i, [&] {
          return "sides " + str(i) + " and " + str(i + 1) + " name triangles " + str(side.triangle) +
                 " and " + str(other.triangle) + ", materials " + str(side.material) + " and " +
                 str(other.material);
        });
      }
      if (side.tet == kNone && view_.partial()) {
        ++absent;
        if (i % 2 == 1 && other.tet == kNone) {
          add(Code::partial_mismatch, i,
              [&] { return "sides " + str(twin(i)) + " and " + str(i) + " both have no tetrahedron"; });
        }
        if (side_uses_[i] == 0) continue;
      }
      if (side_uses_[i] != 1) {
        add(Code::side_unreferenced, i, [&] {
          return "side " + str(i) + " is referred to by " +
                 (side_uses_[i] ? "several faces" : "no tetrahedron");
        });
      }
    }
    if (view_.partial() && absent == 0) {
      add(Code::partial_mismatch, 92, [&] {
        return std::string("the header says that tetrahedra were left out, but every side has one");
      });
    }
    for (std::size_t i = 0; i < hull_seen_.size(); ++i) {
      if (hull_seen_[i]) continue;
      add(Code::hull_mismatch, i, [&] {
        const HullFace& face = view_.hull()[i];
        return "hull face " + str(i) + ": tet " + str(face.tet) + " with " + ids(face.vertices) +
               " is no hull face";
      });
    }
  }

  void check_reached() {
    std::vector<std::uint8_t> used(vertex_count_);
    for (Index t = 0; t < view_.tet_count(); ++t) {
      if (reached(t)) {
        for (const Index id : topology_.tets[t].vertices) used[id] = 1;
      } else {
        add(Code::unreachable, t, [&] { return "no source tet leads to tet " + str(t); });
      }
    }
    if (view_.partial() && view_.find(kInputTriangles)) {  // they keep their corners in left-out space
      for (const Triangle& triangle : view_.input_triangles())
        for (const Index id : triangle.vertices)
          if (id < vertex_count_) used[id] = 1;
    }
    for (Index id = 0; id < vertex_count_; ++id)
      if (!used[id])
        add(Code::orphan_vertex, id, [&] { return "vertex " + str(id) + " belongs to no tetrahedron"; });
  }

  const FileView& view_;
  const Cells cells_;
  Report& report_;
  const Index vertex_count_;
  Topology topology_;
  std::vector<std::uint8_t> verified_;  ///< of each tetrahedron, a bit a face
  std::vector<std::uint8_t> side_uses_, hull_seen_;
  std::size_t visited_ = 0;  ///< how many of topology_.order have been visited
};

}  // namespace

Topology check_topology(const FileView& view, Report& report) {
  return with_cells(view, [&](const auto& cells) { return Walk(view, cells, report).run(); });
}

}  // namespace tetfmt::detail
