// SPDX-License-Identifier: MIT
#include "tetfmt/traverse.hpp"

#include "walk.hpp"

namespace tetfmt {
namespace {

using namespace detail;

Cell source_cell(const FileView& view) {
  const SourceTet& source = view.sources()[0];
  return {source.tet, source.vertices, source.neighbors};
}

/// The tetrahedron that a walk is leaving, in full.
template <class Cells>
Cell full_cell(const Cells& cells, const Leaving& leaving) {
  std::array<Index, 4> vertices = {leaving.ids[0], leaving.ids[1], leaving.ids[2], leaving.left_behind};
  std::sort(vertices.begin(), vertices.end());
  const auto rank = std::find(vertices.begin(), vertices.end(), leaving.apex) - vertices.begin();
  return {leaving.tet, vertices,
          cells.neighbors(leaving.tet, leaving.previous, static_cast<std::size_t>(rank))};
}

/// A straight walk from the centroid of `from` to the point: through constrained faces by their twins, until
/// the point lies before the exit face. Both ends are the perturbed mesh's, so a point on a face, an edge or
/// a vertex belongs to exactly one tetrahedron, whichever way the walk came.
template <bool kChecked, class Cells>
Location walk_to(const FileView& view, const Cells& cells, const Cell& from, const Vec3d& point) {
  Line line;
  const auto vertices = view.vertices();
  for (const Index id : from.vertices) {
    const Vec3d p = to_vec3d(vertices[id]);
    for (std::size_t i = 0; i < 3; ++i) line.origin[i] += p[i] / 4;  // exact: grid coordinates have 25 bits
  }
  line.toward = point;
  line.through_point = true;
  for (std::size_t i = 0; i < 3; ++i) line.direction[i] = point[i] - line.origin[i];
  if (line.direction == Vec3d{}) return {Location::State::inside, from};

  const ExactSigns signs(line, view.bounds(), vertices);
  const std::optional<Passage> exit = exit_of(view, signs, from);
  if (!exit) return {};  // the centroid lies outside: not a mesh
  const auto before = [&](const std::array<Index, 3>& f) {
    return behind({vertices[f[0]], f[0]}, {vertices[f[1]], f[1]}, {vertices[f[2]], f[2]}, point);
  };
  if (before(exit->ids)) return {Location::State::inside, from};

  const auto sides = view.sides();
  Location result;
  const auto go_on = [&](Index tet, Ref ref) -> Continue {
    if (is_tet(ref)) return {ref, tet};
    if (ref == kHull) {
      result.state = Location::State::outside;
      return {};
    }
    const Index beyond = twin(side_index(ref));
    if (beyond >= sides.size()) return {};
    return {sides[beyond].tet, side_ref(beyond)};
  };
  const Continue start = go_on(from.tet, exit->ref);
  if (start.tet == kNone) return result;
  const auto steps =
      walk<kChecked>(view, cells, signs, start.tet, start.previous, exit->ids, [&](const Leaving& leaving) {
        if (before(leaving.ids)) {
          result = {Location::State::inside, full_cell(cells, leaving)};
          return Continue{};
        }
        return go_on(leaving.tet, leaving.ref);
      });
  return steps ? result : Location{};
}

template <bool kChecked>
Location locate_in(const FileView& view, Vec3f point, const Cell* from) {
  if (!(std::isfinite(point.x) && std::isfinite(point.y) && std::isfinite(point.z)))
    return {Location::State::outside, {}};
  const Cell start = from ? *from : source_cell(view);
  if (!in_range(view, start)) return {};
  return with_cells(
      view, [&](const auto& cells) { return walk_to<kChecked>(view, cells, start, to_vec3d(point)); });
}

}  // namespace

Location locate(const FileView& view, Vec3f point, const Cell* from) {
  return locate_in<true>(view, point, from);
}
Location locate(const TrustedView& view, Vec3f point, const Cell* from) {
  return locate_in<false>(view.view(), point, from);
}

}  // namespace tetfmt
