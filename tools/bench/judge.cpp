// SPDX-License-Identifier: AGPL-3.0-or-later
#include "bench/judge.hpp"

#include <algorithm>
#include <cmath>

#include "common/parse.hpp"

namespace tetbench {

using tetfmt::Hit;
using tetfmt::Index;
using tetfmt::Location;
using tetfmt::Outcome;
using tetprep::number;

namespace {

constexpr double kMostUlps = 4;
constexpr double kOneDegree = 0.0174524064372835;  // its sine

Vec3d wide(const tetfmt::Vec3f& v) {
  return {static_cast<double>(v.x), static_cast<double>(v.y), static_cast<double>(v.z)};
}

std::string name(const Crossing& crossing) {
  return "side " + std::to_string(crossing.side()) + " at t = " + number(crossing.low);
}
std::string name(const Hit& hit) {
  return "side " + std::to_string(hit.side) + " at t = " + number(hit.t);
}

}  // namespace

Judge::Judge(const Scene& scene) : scene_(scene) {
  const tetfmt::Mesh& mesh = scene.mesh();
  const Surface& surface = scene.surface();
  for (const tetfmt::FullTet& tet : mesh.tets)
    for (std::size_t k = 0; k < 4; ++k) {
      if (tet.neighbors[k] != tetfmt::kHull) continue;
      const auto& v = tet.vertices;
      Face face = {v[k == 0 ? 1 : 0], v[k <= 1 ? 2 : 1], v[k <= 2 ? 3 : 2]};
      // The apex is behind: its own determinant is then positive.
      const Place apex{wide(mesh.vertices[v[k]]), {}};
      if (ExactLine(surface, apex, Vec3d{}).height(face) < 0) std::swap(face[1], face[2]);
      hull_.push_back(face);
    }
  faces_of_.resize(scene.view(0).view().input_triangles().size());
  for (std::uint32_t face = 0; face < surface.faces.size(); ++face)
    faces_of_.at(input_triangle(face)).push_back(face);
}

Index Judge::input_triangle(std::uint32_t face) const {
  const Index triangle = scene_.mesh().sides[2 * face].triangle;
  const auto origins = scene_.view(0).view().origins();
  return origins.empty() ? triangle : origins[triangle];
}

Start Judge::start(const Location& location, const tetfmt::Vec3f& point) const {
  return {location, {wide(point), {}}, tetfmt::kNone};
}

Start Judge::start_on_side(const Location& location, Index side) const {
  const GridPoint n = scene_.surface().normal(scene_.surface().faces[side / 2]);
  std::size_t axis = 0;
  for (std::size_t k = 1; k < 3; ++k)
    if (std::abs(n[k]) > std::abs(n[axis])) axis = k;
  Place place{location.position, {}};
  place.off[axis] = (n[axis] > 0) == (side % 2 == 0) ? 1 : -1;
  return {location, place, side};
}

std::optional<Finding> Judge::location(const Start& start) const {
  const Location& at = start.location;
  const auto finding = [&](const std::string& text) { return Finding{Fault::started, text}; };
  if (at.state == Location::State::corrupt) return Finding{Fault::hung, "locate found no place"};
  if (at.state == Location::State::absent)
    return finding("locate: absent, in a file that leaves nothing out");
  if (at.position != start.place.position) return finding("locate: the position is not the point");
  const ExactLine line(scene_.surface(), start.place, Vec3d{});
  if (at.state == Location::State::outside) {
    for (const Face& face : hull_)
      if (line.height(face) < 0) return std::nullopt;
    return finding("locate: outside, though no face of the hull sees the point");
  }
  const tetfmt::Cell& cell = at.cell;
  if (cell.tet >= scene_.mesh().tets.size()) return finding("locate: no such tetrahedron");
  const tetfmt::FullTet& tet = scene_.mesh().tets[cell.tet];
  if (cell.vertices != tet.vertices || cell.neighbors != tet.neighbors)
    return finding("locate: the cell is not tetrahedron " + std::to_string(cell.tet));
  if (!line.starts_in(tet.vertices))
    return finding("locate: tetrahedron " + std::to_string(cell.tet) + " does not contain the point");
  return std::nullopt;
}

std::optional<Finding> Judge::side_location(const Start& start, const Hit& hit) const {
  const Location& at = start.location;
  const auto finding = [&](const std::string& text) {
    return Finding{Fault::started, "side " + std::to_string(start.side) + ": " + text};
  };
  const tetfmt::Mesh& mesh = scene_.mesh();
  const Surface& surface = scene_.surface();
  const Face& face = surface.faces[start.side / 2];
  if (at.state != Location::State::inside) return finding("no tetrahedron");
  if (at.cell.tet != mesh.sides[start.side].tet) return finding("not the side's tetrahedron");
  const tetfmt::FullTet& tet = mesh.tets[at.cell.tet];
  if (at.cell.vertices != tet.vertices || at.cell.neighbors != tet.neighbors)
    return finding("the cell is not that tetrahedron");
  if (at.face >= 4 || std::find(face.begin(), face.end(), tet.vertices[at.face]) != face.end())
    return finding("another face");
  const Place exact{at.position, {}};
  const GridPoint n = surface.normal(face);
  const ExactLine along(
      surface, exact, Vec3d{static_cast<double>(n[0]), static_cast<double>(n[1]), static_cast<double>(n[2])});
  if (!along.starts_inside(face)) return finding("not in the plane and between the edges of the face");
  // A position has weights of 26 bits in the face, so it is off the hit's own by a little. The bound is for
  // gross errors.
  double extent = 0, off = 0;
  const auto& corners = mesh.triangles[mesh.sides[start.side].triangle].vertices;
  const Vec3d a = wide(mesh.vertices[corners[0]]), b = wide(mesh.vertices[corners[1]]),
              c = wide(mesh.vertices[corners[2]]);
  for (std::size_t k = 0; k < 3; ++k) {
    extent = std::max({extent, std::abs(b[k] - a[k]), std::abs(c[k] - a[k])});
    off = std::max(off,
                   std::abs(a[k] + hit.side_u * (b[k] - a[k]) + hit.side_v * (c[k] - a[k]) - at.position[k]));
  }
  if (!(off <= 1e-6 * extent)) return finding("the position is " + number(off) + " off the hit's point");
  return std::nullopt;
}

std::optional<Finding> Judge::first_hit(const ExactLine& line, const Start& start,
                                        const tetfmt::Interval& interval, std::span<const Crossing> truth,
                                        const Hit& hit, Tally& tally) const {
  if (hit.outcome == Outcome::corrupt) return Finding{Fault::hung, "first_hit: the walk was cut short"};
  if (hit.steps > scene_.mesh().tets.size() + 1)
    return Finding{Fault::hung, "first_hit: " + std::to_string(hit.steps) + " steps"};
  if (hit.outcome == Outcome::absent)
    return Finding{Fault::wrong, "first_hit: absent, in a file that leaves nothing out"};
  const bool own = start.side != tetfmt::kNone && hit.side / 2 == start.side / 2;
  if (hit.outcome == Outcome::miss) {
    if (truth.empty()) return std::nullopt;
    return Finding{Fault::missed, "first_hit missed " + name(truth[0])};
  }
  if (truth.empty())
    return Finding{own ? Fault::self_hit : Fault::false_hit,
                   "first_hit reports " + name(hit) + ", there is none"};
  if (hit.side != truth[0].side())
    return Finding{own ? Fault::self_hit : Fault::wrong,
                   "first_hit reports " + name(hit) + " instead of " + name(truth[0])};
  return this->hit(line, interval, truth[0], hit, tally);
}

std::optional<Finding> Judge::hit(const ExactLine& line, const tetfmt::Interval& interval,
                                  const Crossing& truth, const Hit& hit, Tally& tally) const {
  const auto finding = [&](const std::string& text) {
    return Finding{Fault::wrong, "side " + std::to_string(hit.side) + ": " + text};
  };
  const tetfmt::Mesh& mesh = scene_.mesh();
  const Face& face = scene_.surface().faces[truth.face];
  if (hit.back != truth.back) return finding("back is wrong");
  if (hit.triangle != input_triangle(truth.face)) return finding("triangle " + std::to_string(hit.triangle));
  if (hit.tet != mesh.sides[hit.side].tet) return finding("tet " + std::to_string(hit.tet));
  if (hit.neighbor != mesh.sides[tetfmt::twin(hit.side)].tet)
    return finding("neighbor " + std::to_string(hit.neighbor));
  Face ascending = face;
  std::sort(ascending.begin(), ascending.end());
  if (hit.face != ascending) return finding("face has other corners");
  if (!(hit.t >= interval.t_min && hit.t >= 0 && hit.t <= interval.t_max))
    return finding("t = " + number(hit.t) + " is not in the interval");

  const double sine = line.sine(face);
  if (sine > 0) {
    const double ulps = line.ulps_off(face, hit.t);
    (sine > kOneDegree ? tally.steep : tally.shallow).add(ulps);
    if (sine > kOneDegree && ulps > kMostUlps)
      return finding("t = " + number(hit.t) + " is " + number(ulps) + " ulp off");
  }
  const std::string problem = weights(line, face, hit);
  if (!problem.empty()) return finding(problem);
  return std::nullopt;
}

std::string Judge::weights(const ExactLine& line, const Face& face, const Hit& hit) const {
  const tetfmt::Mesh& mesh = scene_.mesh();
  const auto inside = [](double u, double v) { return u >= 0 && v >= 0 && u + v <= 1 + 0x1p-50; };
  const auto point = [&](const tetfmt::Triangle& triangle, double u, double v) {
    Vec3d p{};
    for (std::size_t k = 0; k < 3; ++k) {
      const auto at = [&](std::size_t c) { return wide(mesh.vertices[triangle.vertices[c]])[k]; };
      p[k] = at(0) + u * (at(1) - at(0)) + v * (at(2) - at(0));
    }
    return p;
  };
  // The point on the ray and the one in the triangle, apart from what one evaluation in double loses; along a
  // ray that is almost in the plane both may be off, but not from each other.
  const auto& triangle = mesh.triangles[mesh.sides[hit.side].triangle];
  const Vec3d in_triangle = point(triangle, hit.side_u, hit.side_v);
  double apart = 0, reach = 0;
  for (std::size_t k = 0; k < 3; ++k) {
    apart = std::max(apart, std::abs(in_triangle[k] - (line.origin()[k] + hit.t * line.direction()[k])));
    for (const Index v : face)
      reach = std::max(reach, std::abs(wide(mesh.vertices[v])[k] - line.origin()[k]));
    for (const Index v : triangle.vertices)
      reach = std::max(reach, std::abs(wide(mesh.vertices[v])[k] - line.origin()[k]));
  }
  const std::string text = "u, v = " + number(hit.side_u) + ", " + number(hit.side_v);
  if (!inside(hit.side_u, hit.side_v)) return text + " are not in the triangle";
  // Nearly in the plane, one evaluation of the weights in double precision may be off by this share of it.
  const double sine = std::max(line.sine(face), 1e-6);
  if (!(apart <= 1e-12 * reach / sine))
    return text + " and t = " + number(hit.t) + " are " + number(apart) + " apart";
  if (std::isnan(hit.u)) return scene_.view(0).view().partial() ? "" : "u is not a number";
  if (!inside(hit.u, hit.v))
    return "u, v = " + number(hit.u) + ", " + number(hit.v) + " are not in the triangle";
  const tetfmt::FileView& view = scene_.view(0).view();
  if (view.origins().empty())
    return hit.u == hit.side_u && hit.v == hit.side_v ? "" : text + " are not those of the side";
  const Vec3d in_input = point(view.input_triangles()[hit.triangle], hit.u, hit.v);
  double moved = 0;
  for (std::size_t k = 0; k < 3; ++k) moved = std::max(moved, std::abs(in_input[k] - in_triangle[k]));
  // Pieces have corners on the grid, a rounding off the triangle that they are of.
  return moved <= 8 * std::ldexp(1.0, scene_.surface().grid_exponent) + 1e-9 * reach
             ? ""
             : "u, v = " + number(hit.u) + ", " + number(hit.v) + " are another point";
}

std::optional<Finding> Judge::all_hits(const ExactLine& line, const Start& start,
                                       const tetfmt::Interval& interval, std::span<const Crossing> truth,
                                       Outcome outcome, std::span<const Hit> hits, Tally& tally) const {
  if (outcome == Outcome::corrupt) return Finding{Fault::hung, "all_hits: the walk was cut short"};
  if (outcome != Outcome::miss) return Finding{Fault::wrong, "all_hits did not end in a miss"};
  const bool right = std::equal(hits.begin(), hits.end(), truth.begin(), truth.end(),
                                [](const Hit& h, const Crossing& c) { return h.side == c.side(); });
  if (!right) {
    std::vector<Index> found, wanted;
    for (const Hit& h : hits) found.push_back(h.side);
    for (const Crossing& c : truth) wanted.push_back(c.side());
    std::string text = "all_hits reports sides";
    for (const Index side : found) text += " " + std::to_string(side);
    text += " instead of";
    for (const Index side : wanted) text += " " + std::to_string(side);
    std::sort(found.begin(), found.end());
    std::sort(wanted.begin(), wanted.end());
    const bool twice = std::adjacent_find(found.begin(), found.end()) != found.end();
    if (twice || found == wanted) return Finding{Fault::doubled, text};
    const auto own = [&](Index side) { return start.side != tetfmt::kNone && side / 2 == start.side / 2; };
    if (std::any_of(found.begin(), found.end(), own) && std::none_of(wanted.begin(), wanted.end(), own))
      return Finding{Fault::self_hit, text};
    return Finding{found.size() < wanted.size()   ? Fault::missed
                   : found.size() > wanted.size() ? Fault::false_hit
                                                  : Fault::wrong,
                   text};
  }
  for (std::size_t i = 0; i < hits.size(); ++i)
    if (auto finding = hit(line, interval, truth[i], hits[i], tally)) {
      finding->text = "all_hits: " + finding->text;
      return finding;
    }
  return std::nullopt;
}

void Judge::peer(const ExactLine& line, std::span<const Crossing> all, Index triangle,
                 PeerTally& tally) const {
  ++tally.rays;
  const Surface& surface = scene_.surface();
  if (triangle == tetfmt::kNone) {
    if (all.empty()) return;
    const bool inside_of_closed = surface.closed && all.size() % 2 == 1;
    if (inside_of_closed || line.crosses_inside(surface.faces[all[0].face])) ++tally.missed;
    return;
  }
  if (!all.empty() && input_triangle(all[0].face) == triangle) return;
  for (const std::uint32_t face : faces_of_[triangle]) {
    if (!line.touches(surface.faces[face])) continue;
    if (all.empty() || line.parameter(surface.faces[face]).low <= all[0].high) return;
  }
  ++tally.wrong;
}

}  // namespace tetbench
