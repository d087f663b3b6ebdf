// SPDX-License-Identifier: MIT
// One line from where it starts to where it ends, from constrained face to constrained face: what first hits,
// occlusion and lists of hits have in common.
#pragma once

#include <cmath>
#include <limits>

#include "intersect.hpp"
#include "tetfmt/traverse.hpp"
#include "walk.hpp"

namespace tetfmt::detail {

/// False if the line certainly misses the box. Errs on the side of true: the hull's faces decide.
bool may_meet(const Bounds& bounds, const Line& line);

/// An infinitesimal from the face that `from` is on into its cell; zero if it is on none.
Vec3d lift_of(const FileView& view, const Location& from);

/// A constrained face, and what it says of every hit on it.
struct FaceMet {
  Index side = kNone;  ///< kNone: an index does not exist
  Index neighbor = kNone, triangle = kNone;
  const Triangle* piece = nullptr;  ///< the side's own triangle
  const Triangle* whole = nullptr;  ///< the input triangle; null if the file does not hold all of its corners
};
FaceMet face_met(const FileView& view, const Leaving& leaving);

/// Fills in a hit, all but `steps`.
void describe_hit(const FileView& view, const FaceMet& face, const Leaving& leaving, const TrianglePoint& at,
                  Hit& hit);
/// The same for one ray: Outcome::corrupt if an index does not exist.
void describe_hit(const FileView& view, const Line& line, const Leaving& leaving, Hit& hit);

inline Line line_from(const FileView& view, const Location& from, const Vec3f& direction) {
  const Vec3d lift = from.face == Location::kNoFace ? Vec3d{} : lift_of(view, from);
  return {{from.position, lift}, to_vec3d(direction), {}, false};
}

/// False if the line has no place or no direction.
inline bool can_be_followed(const Line& line) {
  return is_finite(line.origin.point) && is_finite(line.direction) && line.direction != Vec3d{};
}

/// The hull face by which the line comes in from outside and ahead of its origin: of the faces that see the
/// origin, the one that the line crosses inwards.
template <class Cells, class Signs>
std::optional<Passage> enter_hull(const FileView& view, const Cells& cells, const Signs& signs,
                                  const Line& line, const Location& start) {
  if (!may_meet(view.surface_bounds(), line)) return std::nullopt;
  const auto points = view.vertices();
  const auto enter = [&](const HullFace& face, bool inwards) -> std::optional<Passage> {
    std::array<Index, 3> v = face.vertices;
    if (face.tet >= view.tet_count() || std::max({v[0], v[1], v[2]}) >= points.size()) return std::nullopt;
    const std::array<typename Signs::Point, 3> p = {signs.project(points[v[0]]), signs.project(points[v[1]]),
                                                    signs.project(points[v[2]])};
    // Counter-clockwise about the line, a face's normal points onwards.
    if (signs.left(p[0], v[0], p[1], v[1]) != inwards) return std::nullopt;
    if (signs.left(p[1], v[1], p[2], v[2]) != inwards) return std::nullopt;
    if (signs.left(p[2], v[2], p[0], v[0]) != inwards) return std::nullopt;
    if (!inwards) std::swap(v[1], v[2]);
    return Passage{kHull, v, face.tet, 0};
  };
  if (start.entrance_count <= start.entrances.size()) {
    for (std::size_t i = 0; i < start.entrance_count; ++i) {
      const Entrance entrance = unpack_entrance(start.entrances[i]);
      if (entrance.face >= view.hull().size()) continue;
      if (const auto passage = enter(view.hull()[entrance.face], entrance.inwards)) return passage;
    }
    return std::nullopt;
  }
  for (const HullFace& face : view.hull()) {
    const std::optional<bool> inwards = seen_from(view, cells, face, line.origin);
    if (!inwards) continue;
    if (const auto passage = enter(face, *inwards)) return passage;
  }
  return std::nullopt;
}

/// The face of a start on a face, if double precision can tell that the line goes from it into the cell. (If
/// not, the line may run along the face, or out of the cell by it, which exit_of finds as well.)
inline std::optional<Passage> leave_face(const FileView& view, const Line& line, const Location& start) {
  auto f = kOutwardFaces[start.face];
  if (start.positive) std::swap(f[1], f[2]);  // turned inwards
  const auto& v = start.cell.vertices;
  const auto at = [&](std::size_t k) { return to_vec3d(view.vertices()[v[f[k]]]); };
  const Vec3d a = at(0), b = at(1), c = at(2);
  if (certified_sign(line.direction, minus(b, a), minus(c, a)) <= 0) return std::nullopt;
  return Passage{start.cell.neighbors[start.face], {v[f[0]], v[f[1]], v[f[2]]}, start.cell.tet, 0};
}

/// The first face that the line goes through.
template <class Cells, class Signs>
std::optional<Passage> first_passage(const FileView& view, const Cells& cells, const Signs& signs,
                                     const Line& line, const Location& start) {
  if (start.state != Location::State::inside) return enter_hull(view, cells, signs, line, start);
  if (start.face < kOutwardFaces.size())
    if (const auto passage = leave_face(view, line, start)) return passage;
  return exit_of(view, signs, start.cell, start.positive);
}

struct Followed {
  Outcome outcome = Outcome::miss;
  std::uint32_t steps = 0;  ///< tetrahedra visited
};

/// Follows the line from `start` (not absent, not corrupt) to its end:
///   goal(leaving)     before each exit: true ends the walk, Outcome::miss
///   at_face(leaving)  at each constrained face: true ends the walk, Outcome::hit; false passes through
/// (of the start's own tetrahedron, `leaving` names no apex). Starts on a face may go out by it: then it is
/// met. Also ends at the hull (miss), in space that the file leaves out (absent), and where the bytes are no
/// mesh (corrupt). `first` finds the first face, exactly; only then does a walk by float signs begin inside
/// the line's path. `signs` steer the rest.
template <bool kChecked, class Cells, class First, class Signs, class Goal, class AtFace>
Followed follow(const FileView& view, const Cells& cells, const Line& line, const Location& start,
                const First& first, const Signs& signs, Goal&& goal, AtFace&& at_face) {
  const bool inside = start.state == Location::State::inside;
  if (inside && !in_range(view, start.cell)) return {Outcome::corrupt};
  const std::optional<Passage> passage = first_passage(view, cells, first, line, start);
  if (!passage)
    return {inside ? Outcome::corrupt : Outcome::miss};  // corrupt: the cell does not hold the origin

  Outcome outcome = Outcome::miss;
  const auto sides = view.sides();
  const auto go_on = [&](const Leaving& leaving) -> Continue {
    if (goal(leaving)) return {};
    if (is_tet(leaving.ref)) return {leaving.ref, leaving.tet};
    if (leaving.ref == kHull) return {};
    if (at_face(leaving)) {
      outcome = Outcome::hit;
      return {};
    }
    const Index beyond = twin(side_index(leaving.ref));
    if (beyond >= sides.size()) {
      outcome = Outcome::corrupt;
    } else if (sides[beyond].tet == kNone) {
      outcome = Outcome::absent;
    } else {
      return {sides[beyond].tet, side_ref(beyond)};
    }
    return {};
  };
  Continue next{passage->ref, passage->previous};
  if (passage->steps == 1) {
    next = go_on(Leaving{start.cell.tet, passage->previous, passage->ids, kNone, kNone, passage->ref, 1});
    if (next.tet == kNone) return {outcome, 1};
  }
  const auto steps =
      walk<kChecked>(view, cells, signs, next.tet, next.previous, passage->ids, [&](Leaving leaving) {
        leaving.steps += passage->steps;
        return go_on(leaving);
      });
  if (!steps) return {Outcome::corrupt};
  return {outcome, passage->steps + *steps};
}

}  // namespace tetfmt::detail
