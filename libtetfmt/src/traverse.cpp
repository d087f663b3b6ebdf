// SPDX-License-Identifier: MIT
#include "tetfmt/traverse.hpp"

#include "intersect.hpp"
#include "walk.hpp"

namespace tetfmt {
namespace {

using namespace detail;

/// False if the line certainly misses the box. Errs on the side of true: the hull's faces decide.
bool may_meet(const Bounds& bounds, const Line& line) {
  const Vec3d lower = to_vec3d(bounds.lower), upper = to_vec3d(bounds.upper);
  double first = 0, last = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < 3; ++i) {
    if (line.direction[i] == 0) {
      if (line.origin[i] < lower[i] || line.origin[i] > upper[i]) return false;
      continue;
    }
    double near = (lower[i] - line.origin[i]) / line.direction[i];
    double far = (upper[i] - line.origin[i]) / line.direction[i];
    if (near > far) std::swap(near, far);
    first = std::max(first, near);
    last = std::min(last, far);
  }
  return first * (1 - 0x1p-50) <= last * (1 + 0x1p-50);  // three roundings each
}

/// The hull face by which the line comes in from outside and ahead of its origin: of the faces that see the
/// origin, the one that the line crosses inwards.
template <class Cells>
std::optional<Passage> enter_hull(const FileView& view, const Cells& cells, const ExactSigns& signs,
                                  const Line& line, const Location& start) {
  if (!may_meet(view.bounds(), line)) return std::nullopt;
  const auto points = view.vertices();
  const auto enter = [&](const HullFace& face, bool inwards) -> std::optional<Passage> {
    std::array<Index, 3> v = face.vertices;
    if (face.tet >= view.tet_count() || std::max({v[0], v[1], v[2]}) >= points.size()) return std::nullopt;
    const std::array<Point2<double>, 3> p = {signs.project(points[v[0]]), signs.project(points[v[1]]),
                                             signs.project(points[v[2]])};
    // Counter-clockwise about the line, a face's normal points onwards.
    if (signs.left(p[0], v[0], p[1], v[1]) != inwards) return std::nullopt;
    if (signs.left(p[1], v[1], p[2], v[2]) != inwards) return std::nullopt;
    if (signs.left(p[2], v[2], p[0], v[0]) != inwards) return std::nullopt;
    if (!inwards) std::swap(v[1], v[2]);
    return Passage{kNone, v, face.tet};
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

Hit corrupt_hit() {
  Hit hit;
  hit.outcome = Outcome::corrupt;
  return hit;
}

/// The hit on the constrained face that `ref` names, reached from tetrahedron `tet`.
Hit hit_on(const FileView& view, const Ray& ray, Index tet, Ref ref, std::uint32_t steps) {
  Hit hit;
  hit.steps = steps;
  if (ref == kHull) return hit;
  hit.side = side_index(ref);
  if (hit.side >= view.sides().size() || twin(hit.side) >= view.sides().size()) return corrupt_hit();
  const Index triangle = view.sides()[hit.side].triangle;
  if (triangle >= view.triangles().size()) return corrupt_hit();
  const auto& corner = view.triangles()[triangle].vertices;
  if (std::max({corner[0], corner[1], corner[2]}) >= view.vertices().size()) return corrupt_hit();

  hit.outcome = Outcome::hit;
  hit.back = hit.side % 2 == 1;
  hit.tet = tet;
  hit.neighbor = view.sides()[twin(hit.side)].tet;
  const auto points = view.vertices();
  TrianglePoint at =
      intersect(ray.origin, ray.direction, points[corner[0]], points[corner[1]], points[corner[2]]);
  hit.triangle = triangle;
  if (!view.origins().empty()) {
    if (triangle >= view.origins().size()) return corrupt_hit();
    hit.triangle = view.origins()[triangle];
    if (hit.triangle >= view.input_triangles().size()) return corrupt_hit();
    const auto& whole = view.input_triangles()[hit.triangle].vertices;
    if (std::max({whole[0], whole[1], whole[2]}) >= points.size()) {
      at.u = at.v = std::numeric_limits<double>::quiet_NaN();  // its corners are not all in the file
    } else if (whole != corner) {
      at = from_piece(at, {points[corner[0]], points[corner[1]], points[corner[2]]},
                      {points[whole[0]], points[whole[1]], points[whole[2]]});
    }
  }
  hit.t = at.t;
  hit.u = at.u;
  hit.v = at.v;
  return hit;
}

template <bool kChecked, class Signs, class Cells>
Hit trace(const FileView& view, const Cells& cells, const Ray& ray, const Line& line, const Location& start) {
  // The first face is always found exactly: only then does a walk by float signs begin inside the line's
  // path.
  const ExactSigns exact(line, view.bounds(), view.vertices());
  std::optional<Passage> passage;
  if (start.state == Location::State::inside) {
    if (!in_range(view, start.cell)) return corrupt_hit();
    passage = exit_of(view, exact, start.cell, start.positive);
    if (!passage) return corrupt_hit();  // the cell does not hold the origin
  } else {
    passage = enter_hull(view, cells, exact, line, start);
    if (!passage) return {};
  }
  std::uint32_t steps = passage->from == kNone ? 0 : 1;
  if (!is_tet(passage->ref)) return hit_on(view, ray, passage->from, passage->ref, steps);

  Index last = kNone;
  Ref ref = kHull;
  const auto go_on = [&](const Leaving& leaving) {
    if (is_tet(leaving.ref)) return Continue{leaving.ref, leaving.tet};
    last = leaving.tet;
    ref = leaving.ref;
    return Continue{};
  };
  const auto& signs = Signs::of(exact);
  const auto walked = walk<kChecked>(view, cells, signs, passage->ref, passage->from, passage->ids, go_on);
  if (!walked) return corrupt_hit();
  return hit_on(view, ray, last, ref, steps + *walked);
}

template <bool kChecked>
Hit first_hit_in(const FileView& view, const Ray& ray, const Location& start, Kernel kernel) {
  if (start.state == Location::State::corrupt) return corrupt_hit();
  if (start.state == Location::State::absent) {
    Hit hit;
    hit.outcome = Outcome::absent;
    return hit;
  }
  Line line;
  line.origin = to_vec3d(ray.origin);
  line.direction = to_vec3d(ray.direction);
  const auto finite = [](const Vec3d& v) {
    return std::isfinite(v[0]) && std::isfinite(v[1]) && std::isfinite(v[2]);
  };
  if (!finite(line.origin) || !finite(line.direction) || line.direction == Vec3d{}) return {};
  return with_cells(view, [&](const auto& cells) {
    return kernel == Kernel::exact ? trace<kChecked, ExactSigns>(view, cells, ray, line, start)
                                   : trace<kChecked, FloatSigns>(view, cells, ray, line, start);
  });
}

}  // namespace

Hit first_hit(const FileView& view, const Ray& ray, const Location& start, Kernel kernel) {
  return first_hit_in<true>(view, ray, start, kernel);
}
Hit first_hit(const TrustedView& view, const Ray& ray, const Location& start, Kernel kernel) {
  return first_hit_in<false>(view.view(), ray, start, kernel);
}

}  // namespace tetfmt
