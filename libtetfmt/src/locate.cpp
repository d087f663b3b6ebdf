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

Location inside(const Cell& cell) {
  Location location;
  location.state = Location::State::inside;
  location.cell = cell;
  return location;
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
  if (line.direction == Vec3d{}) return inside(from);

  const ExactSigns signs(line, view.bounds(), vertices);
  const std::optional<Passage> exit = exit_of(view, signs, from, is_positive(view, from));
  if (!exit) return {};  // the centroid lies outside: not a mesh
  const auto before = [&](const std::array<Index, 3>& f) {
    return behind({vertices[f[0]], f[0]}, {vertices[f[1]], f[1]}, {vertices[f[2]], f[2]}, point);
  };
  if (before(exit->ids)) return inside(from);

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
          result = inside(full_cell(cells, leaving));
          return Continue{};
        }
        return go_on(leaving.tet, leaving.ref);
      });
  return steps ? result : Location{};
}

template <class Cells>
void find_entrances(const FileView& view, const Cells& cells, const Vec3d& point, Location& location) {
  for (std::size_t i = 0; i < view.hull().size(); ++i) {
    const std::optional<bool> inwards = seen_from(view, cells, view.hull()[i], point);
    if (!inwards) continue;
    if (location.entrance_count == location.entrances.size()) {
      location.entrance_count = Location::kManyEntrances;
      return;
    }
    location.entrances[location.entrance_count++] = pack_entrance({i, *inwards});
  }
}

template <bool kChecked>
Location locate_in(const FileView& view, Vec3f point, const Cell* from) {
  Location location;
  location.state = Location::State::outside;
  if (!(std::isfinite(point.x) && std::isfinite(point.y) && std::isfinite(point.z))) return location;
  const Cell start = from ? *from : source_cell(view);
  if (!in_range(view, start)) return {};
  with_cells(view, [&](const auto& cells) {
    location = walk_to<kChecked>(view, cells, start, to_vec3d(point));
    if (location.state == Location::State::inside) location.positive = is_positive(view, location.cell);
    if (location.state == Location::State::outside) find_entrances(view, cells, to_vec3d(point), location);
  });
  return location;
}

}  // namespace

Location locate(const FileView& view, Vec3f point, const Cell* from) {
  return locate_in<true>(view, point, from);
}
Location locate(const TrustedView& view, Vec3f point, const Cell* from) {
  return locate_in<false>(view.view(), point, from);
}

}  // namespace tetfmt
