// SPDX-License-Identifier: MIT
#include <cmath>
#include <queue>
#include <unordered_set>

#include "tetfmt/traverse.hpp"
#include "walk.hpp"

namespace tetfmt {
namespace {

using namespace detail;

Cell source_cell(const FileView& view) {
  const SourceTet& source = view.sources()[0];
  return {source.tet, source.vertices, source.neighbors};
}

Location located(const Cell& cell) {
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
    for (std::size_t i = 0; i < 3; ++i)
      line.origin.point[i] += p[i] / 4;  // exact: grid coordinates have 25 bits
  }
  line.toward.point = point;
  line.through_point = true;
  for (std::size_t i = 0; i < 3; ++i) line.direction[i] = point[i] - line.origin.point[i];
  if (line.direction == Vec3d{}) return located(from);

  const Signs signs(line, view.bounds(), vertices, {});
  const std::optional<Passage> exit = exit_of(view, signs, from, is_positive(view, from));
  if (!exit) return {};  // the centroid lies outside: not a mesh
  const auto before = [&](const std::array<Index, 3>& f) {
    return behind({vertices[f[0]], f[0]}, {vertices[f[1]], f[1]}, {vertices[f[2]], f[2]}, Place{point, {}});
  };
  if (before(exit->ids)) return located(from);

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
    if (sides[beyond].tet == kNone) result.state = Location::State::absent;  // as far as this walk can tell
    return {sides[beyond].tet, side_ref(beyond)};
  };
  const Continue start = go_on(from.tet, exit->ref);
  if (start.tet == kNone) return result;
  const auto steps =
      walk<kChecked>(view, cells, signs, start.tet, start.previous, exit->ids, [&](const Leaving& leaving) {
        if (before(leaving.ids)) {
          result = located(full_cell(cells, leaving));
          return Continue{};
        }
        return go_on(leaving.tet, leaving.ref);
      });
  return steps ? result : Location{};
}

bool in_bounds(const Bounds& bounds, const Vec3f& p) {
  return p.x >= bounds.lower.x && p.x <= bounds.upper.x && p.y >= bounds.lower.y && p.y <= bounds.upper.y &&
         p.z >= bounds.lower.z && p.z <= bounds.upper.z;
}

/// Whether the perturbed tetrahedron contains the point.
bool contains(const FileView& view, const Cell& cell, const Vec3d& point) {
  const auto corner = [&](std::size_t k) {
    return Corner{view.vertices()[cell.vertices[k]], cell.vertices[k]};
  };
  const bool positive = is_positive(view, cell);
  return std::all_of(kOutwardFaces.begin(), kOutwardFaces.end(), [&](const auto& f) {
    return behind(corner(f[0]), corner(f[1]), corner(f[2]), Place{point, {}}) == positive;
  });
}

/// Where a straight walk is stopped by left-out space: a search around it, tetrahedra nearest to the point
/// first. What the file does not hold is only known after looking at all of it.
template <class Cells>
Location search(const FileView& view, const Cells& cells, const Cell& from, const Vec3d& point) {
  struct Candidate {
    double distance;
    Cell cell;
    bool operator<(const Candidate& other) const { return distance > other.distance; }
  };
  std::priority_queue<Candidate> queue;
  std::unordered_set<Index> reached;
  bool sound = true;
  const auto reach = [&](const Cell& cell) {
    if (!in_range(view, cell)) {
      sound = false;
    } else if (reached.insert(cell.tet).second) {
      double distance = 0;
      for (std::size_t i = 0; i < 3; ++i) {
        double middle = 0;
        for (const Index id : cell.vertices) middle += to_vec3d(view.vertices()[id])[i] / 4;
        distance += (middle - point[i]) * (middle - point[i]);
      }
      queue.push({distance, cell});
    }
  };
  reach(from);
  for (const SourceTet& source : view.sources()) reach({source.tet, source.vertices, source.neighbors});

  while (!queue.empty()) {
    const Cell cell = queue.top().cell;
    queue.pop();
    if (contains(view, cell, point)) return located(cell);
    for (std::size_t k = 0; k < 4; ++k) {
      const Ref ref = cell.neighbors[k];
      Index next = ref;
      Ref previous = cell.tet;
      if (ref == kHull) continue;
      if (is_side(ref)) {
        const Index beyond = twin(side_index(ref));
        if (beyond >= view.sides().size()) return {};
        next = view.sides()[beyond].tet;
        previous = side_ref(beyond);
        if (next == kNone) continue;
      }
      if (next >= view.tet_count()) return {};
      if (reached.contains(next)) continue;
      const auto face = face_opposite(cell.vertices, k);
      const Index apex = cells.vertex_xor(next) ^ face[0] ^ face[1] ^ face[2];
      const std::size_t apex_rank = rank(apex, face[0], face[1], face[2]);
      reach({next, insert_apex(face, apex, apex_rank), cells.neighbors(next, previous, apex_rank)});
    }
  }
  Location location;
  if (sound) location.state = Location::State::absent;
  return location;
}

template <class Cells>
void find_entrances(const FileView& view, const Cells& cells, const Vec3d& point, Location& location) {
  for (std::size_t i = 0; i < view.hull().size(); ++i) {
    const std::optional<bool> inwards = seen_from(view, cells, view.hull()[i], {point, {}});
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
  const Vec3d position = location.position = to_vec3d(point);
  if (!(std::isfinite(point.x) && std::isfinite(point.y) && std::isfinite(point.z))) return location;
  const Cell start = from ? *from : source_cell(view);
  if (!in_range(view, start)) return {};
  with_cells(view, [&](const auto& cells) {
    location = walk_to<kChecked>(view, cells, start, position);
    using enum Location::State;
    if (location.state == absent && in_bounds(view.bounds(), point))
      location = search(view, cells, start, position);
    if (location.state == inside) location.positive = is_positive(view, location.cell);
    if (location.state == outside || location.state == absent)
      find_entrances(view, cells, position, location);
    location.position = position;
    // Whoever is in no tetrahedron and sees the hull is outside, not in left-out space.
    if (location.state == absent && location.entrance_count > 0) location.state = outside;
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
