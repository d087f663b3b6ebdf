// SPDX-License-Identifier: AGPL-3.0-or-later
#include "bench/rays.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string_view>

namespace tetbench {
namespace {

using tetfmt::Index;
using tetfmt::Vec3f;

constexpr std::array<RaySet, 21> kSets = {{
    {"outside", "from a sphere around the box towards points in it", Flow::rays, 2},
    {"inside", "from points in the box in any direction", Flow::rays, 2},
    {"vertices", "exactly at vertices of the surface"},
    {"edges", "exactly at midpoints of the surface's edges"},
    {"along-edges", "along the line of an edge, from before it, its end or inside of it"},
    {"in-planes", "in the plane of a face, through points and along directions of its lattice"},
    {"axis", "along an axis from lattice points, many through vertices and edges"},
    {"from-vertices", "from vertices (of surface, box and space) in any direction and at others"},
    {"from-edges", "from points of the surface's edges"},
    {"from-faces", "from points of the surface's faces"},
    {"from-tet-edges", "from midpoints of edges of tetrahedra that are not the surface's"},
    {"from-hull", "from points of the hull, inwards and outwards"},
    {"far-1e4", "from 10^4 sizes away"},
    {"far-1e6", "from 10^6 sizes away"},
    {"zeros", "one or two components of the direction are zero"},
    {"denormals", "components of the direction are denormal float32 numbers"},
    {"intervals", "t_min and t_max exactly on a face, and anywhere"},
    {"parity", "from outside, all crossings: an even number where the surface is closed", Flow::crossings},
    {"shared", "many rays from one place, together: tiles of a camera, scattered, at vertices", Flow::shared,
     2},
    {"bounces", "three bounces from the sides of first hits: diffuse, mirror, refracted", Flow::bounces, 3},
    {"segments", "between places: inside, outside, on vertices, edges, faces and sides", Flow::segments, 2},
}};

Vec3f rounded(const Vec3d& p) {
  return {static_cast<float>(p[0]), static_cast<float>(p[1]), static_cast<float>(p[2])};
}

template <class T>
std::array<T, 3> between(const std::array<T, 3>& a, const std::array<T, 3>& b) {
  return {b[0] - a[0], b[1] - a[1], b[2] - a[2]};
}

}  // namespace

std::span<const RaySet> ray_sets() {
  return kSets;
}

RayMaker::RayMaker(const tetfmt::Mesh& mesh, const Surface& surface) : mesh_(mesh), surface_(surface) {
  low_.fill(std::numeric_limits<double>::infinity());
  high_.fill(-std::numeric_limits<double>::infinity());
  for (const Vec3f& v : mesh.vertices) {
    const Vec3d p = {v.x, v.y, v.z};
    for (std::size_t k = 0; k < 3; ++k) {
      low_[k] = std::min(low_[k], p[k]);
      high_[k] = std::max(high_[k], p[k]);
    }
  }
  size_ = std::hypot(high_[0] - low_[0], high_[1] - low_[1], high_[2] - low_[2]);
  quarter_ = std::ldexp(0.25, surface.grid_exponent);
  for (const Face& f : surface.faces)
    for (std::size_t k = 0; k < 3; ++k)
      edges_.push_back({std::min(f[k], f[(k + 1) % 3]), std::max(f[k], f[(k + 1) % 3])});
  std::sort(edges_.begin(), edges_.end());
  edges_.erase(std::unique(edges_.begin(), edges_.end()), edges_.end());
  for (const tetfmt::FullTet& tet : mesh.tets)
    for (std::size_t k = 0; k < 4; ++k)
      if (tet.neighbors[k] == tetfmt::kHull)
        hull_.push_back(
            {tet.vertices[k == 0 ? 1 : 0], tet.vertices[k <= 1 ? 2 : 1], tet.vertices[k <= 2 ? 3 : 2]});
}

Shot RayMaker::make(const RaySet& set, Dice& dice) const {
  for (int tries = 0; tries < 64; ++tries)
    if (const auto shot = try_make(set.name, dice)) return *shot;
  return outside(dice);
}

std::optional<Shot> RayMaker::try_make(std::string_view set, Dice& dice) const {
  if (set == "inside") return inside(dice);
  if (set == "vertices") return aimed(near_point(dice), &RayMaker::surface_vertex, dice);
  if (set == "edges") return aimed(near_point(dice), &RayMaker::edge_point, dice);
  if (set == "along-edges") return along_edge(dice);
  if (set == "in-planes") return in_plane(dice);
  if (set == "axis") return axis(dice);
  if (set == "from-vertices") return from(vertex(dice), dice);
  if (set == "from-edges") return from(edge_point(dice), dice);
  if (set == "from-faces") return from(face_point(dice), dice);
  if (set == "from-tet-edges") return from(tet_edge_midpoint(dice), dice);
  if (set == "from-hull") return from(hull_point(dice), dice);
  if (set == "far-1e4") return far(dice, 1e4);
  if (set == "far-1e6") return far(dice, 1e6);
  if (set == "zeros") return zero_components(dice);
  if (set == "denormals") return denormal_components(dice);
  if (set == "intervals") return with_interval(dice);
  if (set == "parity") {
    switch (dice.below(4)) {
      case 0:
        return aimed(outside_point(dice), &RayMaker::surface_vertex, dice);
      case 1:
        return aimed(outside_point(dice), &RayMaker::edge_point, dice);
      case 2:
        return aimed(outside_point(dice), &RayMaker::face_point, dice);
      default:
        break;
    }
  }
  if (set == "bounces" && dice.below(2) == 0) return inside(dice);
  return outside(dice);
}

Shot RayMaker::outside(Dice& dice) const {
  const Vec3d d = dice.direction();
  Vec3d start{}, towards{};
  for (std::size_t k = 0; k < 3; ++k) {
    start[k] = (low_[k] + high_[k]) / 2 + 1.5 * size_ * d[k];
    towards[k] = dice.between(low_[k], high_[k]) - start[k];
  }
  return {rounded(start), rounded(towards), {}};
}

Shot RayMaker::inside(Dice& dice) const {
  Vec3d start{}, d = dice.direction();
  const double length = std::exp2(dice.between(-4, 4));
  for (std::size_t k = 0; k < 3; ++k) {
    start[k] = dice.between(low_[k], high_[k]);
    d[k] *= length;
  }
  return {rounded(start), rounded(d), {}};
}

std::optional<Shot> RayMaker::far(Dice& dice, double sizes) const {
  const Vec3d d = dice.direction();
  Vec3d start{}, towards{};
  for (std::size_t k = 0; k < 3; ++k) {
    start[k] = (low_[k] + high_[k]) / 2 + sizes * size_ * d[k];
    towards[k] = dice.between(low_[k], high_[k]) - static_cast<double>(static_cast<float>(start[k]));
  }
  const Shot shot{rounded(start), rounded(towards), {}};
  if (!std::isfinite(shot.origin.x + shot.origin.y + shot.origin.z)) return std::nullopt;
  return shot;
}

std::optional<Shot> RayMaker::axis(Dice& dice) const {
  const auto along = static_cast<std::size_t>(dice.below(3));
  const Lattice random = near_point(dice), aligned = surface_vertex(dice);
  const std::uint64_t exact = dice.below(4);
  Lattice start = random;
  if (exact & 1U) start[(along + 1) % 3] = aligned[(along + 1) % 3];
  if (exact & 2U) start[(along + 2) % 3] = aligned[(along + 2) % 3];
  const auto origin = point(start);
  if (!origin) return std::nullopt;
  Vec3d d{};
  d[along] = dice.below(2) == 0 ? 1 : -1;
  return Shot{*origin, rounded(d), {}};
}

std::optional<Shot> RayMaker::along_edge(Dice& dice) const {
  const auto& ends = edges_[dice.below(edges_.size())];
  Lattice a = lattice(ends[0]), b = lattice(ends[1]);
  if (dice.below(2) == 0) std::swap(a, b);
  const Lattice d = between(a, b);
  // From two edge lengths before its beginning to half of one after.
  const auto quarters = static_cast<std::int64_t>(dice.below(6)) * 2 - 8;
  Lattice start{};
  for (std::size_t k = 0; k < 3; ++k) start[k] = a[k] + quarters * (d[k] / 4);  // exact: d is whole steps
  const auto origin = point(start), direction = point(d);
  if (!origin || !direction) return std::nullopt;
  return Shot{*origin, *direction, {}};
}

std::optional<Shot> RayMaker::in_plane(Dice& dice) const {
  const Face& f = face(dice);
  const Lattice a = lattice(f[0]), u = between(a, lattice(f[1])), v = between(a, lattice(f[2]));
  const auto weight = [&](std::uint64_t n) { return static_cast<std::int64_t>(dice.below(n)); };
  const std::int64_t i = weight(5), j = weight(5), p = weight(7) - 3, q = weight(7) - 3, back = weight(3);
  if (p == 0 && q == 0) return std::nullopt;
  Lattice start{}, d{};
  for (std::size_t k = 0; k < 3; ++k) {
    d[k] = p * u[k] + q * v[k];
    start[k] = a[k] + i * (u[k] / 4) + j * (v[k] / 4) - back * d[k];
  }
  const auto origin = point(start), direction = point(d);
  if (!origin || !direction) return std::nullopt;
  return Shot{*origin, *direction, {}};
}

std::optional<Shot> RayMaker::with_interval(Dice& dice) const {
  // The face is met at exactly t = 2^scale.
  const Lattice target = face_point(dice);
  const auto reach = static_cast<std::int64_t>(dice.between(1, size_ / quarter_ / 2));
  Lattice start{}, d{};
  for (std::size_t k = 0; k < 3; ++k) {
    d[k] = static_cast<std::int64_t>(dice.below(2 * static_cast<std::uint64_t>(reach) + 1)) - reach;
    start[k] = target[k] - d[k];
  }
  const auto origin = point(start), direction = point(d);
  if (!origin || !direction || d == Lattice{}) return std::nullopt;
  const int scale = static_cast<int>(dice.below(7)) - 3;
  const auto scaled = [&](float x) { return std::ldexp(x, -scale); };
  const double t = std::ldexp(1.0, scale), infinity = std::numeric_limits<double>::infinity();
  Shot shot{*origin, {scaled(direction->x), scaled(direction->y), scaled(direction->z)}, {}};
  switch (dice.below(10)) {
    case 0:
      shot.interval = {0, t};
      break;
    case 1:
      shot.interval = {t, infinity};
      break;
    case 2:
      shot.interval = {t, t};
      break;
    case 3:
      shot.interval = {t / 2, t};
      break;
    case 4:
      shot.interval = {t, 2 * t};
      break;
    case 5:
      shot.interval = {std::nextafter(t, 0), std::nextafter(t, infinity)};
      break;
    case 6:
      shot.interval = {std::nextafter(t, infinity), infinity};
      break;
    case 7:
      shot.interval = {-1, std::nextafter(t, 0)};
      break;
    case 8:
      shot.interval = {t * dice.unit(), t * (1 + dice.unit())};
      break;
    default:
      shot.interval = {t * dice.between(0, 4), t * dice.between(0, 4)};  // half of them empty
      break;
  }
  return shot;
}

Shot RayMaker::zero_components(Dice& dice) const {
  Shot shot = dice.below(2) == 0 ? inside(dice) : outside(dice);
  std::array<float*, 3> d = {&shot.direction.x, &shot.direction.y, &shot.direction.z};
  std::rotate(d.begin(), d.begin() + static_cast<std::ptrdiff_t>(dice.below(3)), d.end());
  *d[0] = dice.below(2) == 0 ? 0.0F : -0.0F;
  if (dice.below(2) == 0) *d[1] = 0;
  if (*d[1] == 0 && *d[2] == 0) *d[2] = 1;
  return shot;
}

Shot RayMaker::denormal_components(Dice& dice) const {
  Shot shot = dice.below(2) == 0 ? inside(dice) : outside(dice);
  const auto denormal = [&] {
    const float value = std::ldexp(static_cast<float>(1 + dice.below((1U << 22U) - 1)), -149);
    return dice.below(2) == 0 ? value : -value;
  };
  std::array<float*, 3> d = {&shot.direction.x, &shot.direction.y, &shot.direction.z};
  std::rotate(d.begin(), d.begin() + static_cast<std::ptrdiff_t>(dice.below(3)), d.end());
  const std::uint64_t count = 1 + dice.below(3);
  for (std::size_t k = 0; k < count; ++k) *d[k] = denormal();
  return shot;
}

std::optional<Shot> RayMaker::from(const Lattice& start, Dice& dice) const {
  switch (dice.below(6)) {
    case 0:
      return aimed(start, &RayMaker::surface_vertex, dice);
    case 1:
      return aimed(start, &RayMaker::edge_point, dice);
    case 2:
      return aimed(start, &RayMaker::vertex, dice);
    case 3: {
      Vec3d d{};
      d[dice.below(3)] = dice.below(2) == 0 ? 1 : -1;
      const auto origin = point(start);
      if (!origin) return std::nullopt;
      return Shot{*origin, rounded(d), {}};
    }
    default: {
      const auto origin = point(start);
      if (!origin) return std::nullopt;
      return Shot{*origin, rounded(dice.direction()), {}};
    }
  }
}

/// `start` is drawn before the target, whatever order a compiler evaluates arguments in.
std::optional<Shot> RayMaker::aimed(const Lattice& start, Lattice (RayMaker::*target)(Dice&) const,
                                    Dice& dice) const {
  return through(start, (this->*target)(dice));
}

std::optional<Shot> RayMaker::through(const Lattice& start, const Lattice& target) const {
  const auto origin = point(start), direction = point(between(start, target));
  if (!origin || !direction || start == target) return std::nullopt;
  return Shot{*origin, *direction, {}};
}

Vec3f RayMaker::end_point(Dice& dice) const {
  const auto or_else = [&](const Lattice& p) { return point(p).value_or(surface_.vertices[face(dice)[0]]); };
  switch (dice.below(8)) {
    case 0:
      return or_else(vertex(dice));
    case 1:
      return or_else(surface_vertex(dice));
    case 2:
      return or_else(edge_point(dice));
    case 3:
      return or_else(face_point(dice));
    case 4:
      return or_else(outside_point(dice));
    default:
      return inside(dice).origin;
  }
}

RayMaker::Lattice RayMaker::lattice(Index vertex) const {
  const GridPoint& p = surface_.grid[vertex];
  return {4 * p[0], 4 * p[1], 4 * p[2]};
}

const Face& RayMaker::face(Dice& dice) const {
  return surface_.faces[dice.below(surface_.faces.size())];
}

RayMaker::Lattice RayMaker::vertex(Dice& dice) const {
  return lattice(static_cast<Index>(dice.below(mesh_.vertices.size())));
}

RayMaker::Lattice RayMaker::surface_vertex(Dice& dice) const {
  return lattice(face(dice)[dice.below(3)]);
}

RayMaker::Lattice RayMaker::edge_point(Dice& dice) const {
  const auto& ends = edges_[dice.below(edges_.size())];
  const Lattice a = lattice(ends[0]), d = between(a, lattice(ends[1]));
  const std::int64_t quarters = dice.below(2) == 0 ? 2 : 1;
  return {a[0] + quarters * (d[0] / 4), a[1] + quarters * (d[1] / 4), a[2] + quarters * (d[2] / 4)};
}

RayMaker::Lattice RayMaker::face_point(Dice& dice) const {
  const Face& f = face(dice);
  const auto turn = static_cast<std::size_t>(dice.below(3));
  const Lattice a = lattice(f[turn]), b = lattice(f[(turn + 1) % 3]), c = lattice(f[(turn + 2) % 3]);
  return {(2 * a[0] + b[0] + c[0]) / 4, (2 * a[1] + b[1] + c[1]) / 4, (2 * a[2] + b[2] + c[2]) / 4};
}

RayMaker::Lattice RayMaker::tet_edge_midpoint(Dice& dice) const {
  std::array<Index, 2> ends{};
  for (int tries = 0; tries < 32; ++tries) {
    const auto& ids = mesh_.tets[dice.below(mesh_.tets.size())].vertices;
    const auto first = static_cast<std::size_t>(dice.below(3));
    ends = {ids[first], ids[first + 1 + dice.below(3 - first)]};
    if (!std::binary_search(edges_.begin(), edges_.end(), ends)) break;
  }
  const Lattice a = lattice(ends[0]), b = lattice(ends[1]);
  return {(a[0] + b[0]) / 2, (a[1] + b[1]) / 2, (a[2] + b[2]) / 2};
}

RayMaker::Lattice RayMaker::hull_point(Dice& dice) const {
  if (hull_.empty()) return vertex(dice);
  const auto& f = hull_[dice.below(hull_.size())];
  const Lattice a = lattice(f[0]), b = lattice(f[1]), c = lattice(f[2]);
  switch (dice.below(3)) {
    case 0:
      return a;
    case 1:
      return {(a[0] + b[0]) / 2, (a[1] + b[1]) / 2, (a[2] + b[2]) / 2};
    default:
      return {(2 * a[0] + b[0] + c[0]) / 4, (2 * a[1] + b[1] + c[1]) / 4, (2 * a[2] + b[2] + c[2]) / 4};
  }
}

/// A whole grid point, half of the time in the box and half within half a box's size of it.
RayMaker::Lattice RayMaker::near_point(Dice& dice) const {
  const double margin = dice.below(2) == 0 ? 0 : 0.5;
  Lattice p{};
  for (std::size_t k = 0; k < 3; ++k) {
    const double wide = margin * (high_[k] - low_[k]);
    p[k] = 4 * std::llround(dice.between(low_[k] - wide, high_[k] + wide) / (4 * quarter_));
  }
  return p;
}

RayMaker::Lattice RayMaker::outside_point(Dice& dice) const {
  Lattice p = near_point(dice);
  const auto axis = static_cast<std::size_t>(dice.below(3));
  const double edge = dice.below(2) == 0 ? low_[axis] : high_[axis];
  const double away = (edge == low_[axis] ? -1 : 1) * dice.between(0.01, 0.5) * (high_[axis] - low_[axis]);
  p[axis] = 4 * std::llround((edge + away) / (4 * quarter_));
  return p;
}

/// The float32 point, if there is one.
std::optional<Vec3f> RayMaker::point(const Lattice& p) const {
  Vec3d values{};
  for (std::size_t k = 0; k < 3; ++k) {
    values[k] = static_cast<double>(p[k]) * quarter_;
    if (static_cast<double>(static_cast<float>(values[k])) != values[k]) return std::nullopt;
  }
  return rounded(values);
}

}  // namespace tetbench
