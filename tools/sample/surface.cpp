// SPDX-License-Identifier: AGPL-3.0-or-later
#include "sample/surface.hpp"

#include <algorithm>
#include <cmath>

#include "sample/hostile.hpp"
#include "sample/turn.hpp"

namespace tetprep {
namespace {

using Vector = std::array<double, 3>;
using Vertex = std::uint32_t;

Vector operator+(const Vector& a, const Vector& b) {
  return {a[0] + b[0], a[1] + b[1], a[2] + b[2]};
}
Vector operator*(double s, const Vector& a) {
  return {s * a[0], s * a[1], s * a[2]};
}
double dot(const Vector& a, const Vector& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}
Vector cross(const Vector& a, const Vector& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
Vector unit(const Vector& a) {
  return 1 / std::sqrt(dot(a, a)) * a;
}

Vertex add_point(Surface& surface, const Vector& p) {
  surface.points.push_back({static_cast<float>(p[0]), static_cast<float>(p[1]), static_cast<float>(p[2])});
  return static_cast<Vertex>(surface.points.size() - 1);
}

std::uint64_t round_count(double value) {
  return static_cast<std::uint64_t>(std::floor(value + 0.5));
}
double real(std::uint64_t count) {
  return static_cast<double>(count);
}

// ---------------------------------------------------------------------------------------------------- sphere

/// Rings of latitude with vertices in proportion to their length, sewn to each other by going around both at
/// once. Two poles and rings of n1, n2, ... vertices make 2 * (n1 + n2 + ...) triangles, so every even count
/// can be had. All triangles face away from the centre, which makes the surface free of self-intersections.
Surface make_sphere(std::uint64_t triangles, std::uint64_t /*seed*/) {
  constexpr double kPi = 3.141592653589793;
  const double wanted = real(triangles) / 2;  // vertices on all rings
  const std::uint64_t bands = std::max<std::uint64_t>(2, round_count(std::sqrt(kPi / 4 * wanted)));
  double length = 0;  // of all rings, the equator's being 1
  for (std::uint64_t i = 1; i < bands; ++i) length += turn(0.5 * real(i) / real(bands)).sin;

  Surface surface;
  const Vertex north = add_point(surface, {0, 1, 0});
  Vertex above = north;
  std::uint64_t above_count = 1;
  double length_so_far = 0, placed = 0;
  for (std::uint64_t i = 1; i < bands; ++i) {
    const CosSin latitude = turn(0.5 * real(i) / real(bands));
    length_so_far += latitude.sin;
    const std::uint64_t count =
        std::max<std::uint64_t>(3, round_count(wanted * length_so_far / length - placed));
    placed += real(count);
    const auto ring = static_cast<Vertex>(surface.points.size());
    for (std::uint64_t j = 0; j < count; ++j) {
      const CosSin around = turn(real(j) / real(count));
      add_point(surface, {latitude.sin * around.sin, latitude.cos, latitude.sin * around.cos});
    }
    // Advance on the ring whose next vertex comes first; a pole is a ring that never advances.
    for (std::uint64_t a = 0, b = 0; b < count || (above_count > 1 && a < above_count);) {
      const auto upper = static_cast<Vertex>(above + a % above_count),
                 lower = static_cast<Vertex>(ring + b % count);
      const bool advance_lower = above_count == 1 || (b < count && (b + 1) * above_count <= (a + 1) * count);
      if (advance_lower) {
        surface.triangles.push_back({upper, lower, static_cast<Vertex>(ring + (b + 1) % count)});
        ++b;
      } else {
        surface.triangles.push_back({upper, lower, static_cast<Vertex>(above + (a + 1) % above_count)});
        ++a;
      }
    }
    above = ring;
    above_count = count;
  }
  const Vertex south = add_point(surface, {0, -1, 0});
  for (std::uint64_t a = 0; a < above_count; ++a) {
    surface.triangles.push_back(
        {static_cast<Vertex>(above + a), south, static_cast<Vertex>(above + (a + 1) % above_count)});
  }
  return surface;
}

// ----------------------------------------------------------------------------------------------- torus knots

/// A tube around the curve that winds `around` times around the z axis and `through` times through the hole
/// of a torus of radii 1 and `minor`. `tube` stays well below both the curve's least radius of curvature
/// (0.59 to 0.82 in this table) and half of the least distance between strands (0.32 to 0.40): what is left
/// is room for flat facets.
struct Knot {
  int around, through;
  double minor, tube, length;  ///< length of the curve
  double radius() const { return 1 + minor + tube; }
};
constexpr std::array<Knot, 4> kKnots = {{{2, 3, 0.40, 0.22, 14.78},
                                         {3, 2, 0.45, 0.20, 19.77},
                                         {2, 5, 0.40, 0.18, 17.95},
                                         {3, 4, 0.45, 0.18, 22.22}}};
constexpr std::uint64_t kLeastAlong = 48, kLeastAcross = 5;
constexpr std::uint64_t kKnotMinimum = 500;

/// A frame to place a knot in: columns of a rotation, times a scale, and a centre.
struct Placement {
  Vector x{1, 0, 0}, y{0, 1, 0}, z{0, 0, 1}, centre{};
  double scale = 1;
  Vector operator()(const Vector& p) const { return centre + scale * (p[0] * x + p[1] * y + p[2] * z); }
};

void add_knot(Surface& surface, const Knot& knot, std::uint64_t triangles, const Placement& placement) {
  constexpr double kTurn = 6.283185307179586;
  const double squares = real(triangles) / 2;
  const std::uint64_t across =
      std::max(kLeastAcross, round_count(std::sqrt(squares * kTurn * knot.tube / knot.length)));
  const std::uint64_t along = std::max(kLeastAlong, round_count(squares / real(across)));

  const auto first = static_cast<Vertex>(surface.points.size());
  for (std::uint64_t i = 0; i < along; ++i) {
    const CosSin major = turn(knot.around * real(i) / real(along));
    const CosSin minor = turn(knot.through * real(i) / real(along));
    const double distance = 1 + knot.minor * minor.cos;  // from the z axis
    const Vector centre{distance * major.cos, distance * major.sin, knot.minor * minor.sin};
    const Vector along_major{-major.sin, major.cos, 0};
    const Vector along_minor{-minor.sin * major.cos, -minor.sin * major.sin, minor.cos};
    const Vector tangent =
        unit(knot.around * distance * along_major + knot.through * knot.minor * along_minor);
    // The torus's own normal is orthogonal to the curve and comes back to itself, so the frame closes.
    const Vector normal{minor.cos * major.cos, minor.cos * major.sin, minor.sin};
    const Vector binormal = cross(tangent, normal);
    for (std::uint64_t j = 0; j < across; ++j) {
      const CosSin ring = turn(real(j) / real(across));
      add_point(surface, placement(centre + knot.tube * (ring.cos * normal + ring.sin * binormal)));
    }
  }
  const auto vertex = [&](std::uint64_t i, std::uint64_t j) {
    return static_cast<Vertex>(first + i % along * across + j % across);
  };
  for (std::uint64_t i = 0; i < along; ++i) {
    for (std::uint64_t j = 0; j < across; ++j) {
      surface.triangles.push_back({vertex(i, j), vertex(i + 1, j + 1), vertex(i + 1, j)});
      surface.triangles.push_back({vertex(i, j), vertex(i, j + 1), vertex(i + 1, j + 1)});
    }
  }
}

Surface make_torus_knot(std::uint64_t triangles, std::uint64_t /*seed*/) {
  Surface surface;
  add_knot(surface, kKnots[0], triangles, {});
  return surface;
}

/// A rotation drawn evenly: a unit quaternion from the four-dimensional ball (by rejection, so without libm).
Placement random_rotation(Random& random) {
  std::array<double, 4> q{};
  double norm = 0;
  do {
    norm = 0;
    for (double& component : q) {
      component = 2 * random.uniform() - 1;
      norm += component * component;
    }
  } while (norm > 1 || norm < 1e-3);
  const double s = 2 / norm;
  const auto [w, x, y, z] = q;
  Placement placement;
  placement.x = {1 - s * (y * y + z * z), s * (x * y + w * z), s * (x * z - w * y)};
  placement.y = {s * (x * y - w * z), 1 - s * (x * x + z * z), s * (y * z + w * x)};
  placement.z = {s * (x * z + w * y), s * (y * z - w * x), 1 - s * (x * x + y * y)};
  return placement;
}

/// One knot, turned at random, inside the sphere that each cell of a cubic lattice holds: so no two can
/// touch.
Surface make_knots(std::uint64_t triangles, std::uint64_t seed) {
  constexpr double kTrianglesAKnot = 4000, kSphere = 0.49;  // cells have size 1
  std::uint64_t edge = 2;  // cells along an edge of the box: the nearest to the cube root
  while ((real(edge) + 0.5) * (real(edge) + 0.5) * (real(edge) + 0.5) * kTrianglesAKnot < real(triangles))
    ++edge;
  const std::uint64_t cells = edge * edge * edge;
  Surface surface;
  Random random(seed);
  for (std::uint64_t cell = 0; cell < cells; ++cell) {
    const Knot& knot = kKnots[random.next() % kKnots.size()];
    Placement placement = random_rotation(random);
    const double size = 0.7 + 0.3 * random.uniform();
    placement.scale = size * kSphere / knot.radius();
    const double slack = (1 - size) * kSphere;
    const Vector corner{real(cell % edge), real(cell / edge % edge), real(cell / edge / edge)};
    for (std::size_t i = 0; i < 3; ++i) {
      placement.centre[i] = corner[i] + 0.5 + slack * (2 * random.uniform() - 1);
    }
    // What earlier knots had too much or too little is made up for here.
    const double due = real(triangles) * real(cell + 1) / real(cells) - real(surface.triangles.size());
    add_knot(surface, knot, std::max(kKnotMinimum, round_count(std::max(due, 0.0))), placement);
  }
  return surface;
}

// ------------------------------------------------------------------------------------------------ bumpy
// plane

/// Smooth noise in [-1, 1]: values drawn at the points of the integer lattice, blended by a quintic between
/// them.
double noise(double x, double z, std::uint64_t seed) {
  const double x0 = std::floor(x), z0 = std::floor(z);
  const auto value = [&](int dx, int dz) {
    const auto column = static_cast<std::int64_t>(x0) + dx, row = static_cast<std::int64_t>(z0) + dz;
    Random mixed(seed ^ static_cast<std::uint64_t>(column) * 0xD6E8FEB86659FD93u);
    Random again(mixed.next() ^ static_cast<std::uint64_t>(row) * 0xA0761D6478BD642Fu);
    return 2 * again.uniform() - 1;
  };
  const auto blend = [](double t) { return t * t * t * (t * (6 * t - 15) + 10); };
  const double bx = blend(x - x0), bz = blend(z - z0);
  const double low = value(0, 0) + bx * (value(1, 0) - value(0, 0));
  const double high = value(0, 1) + bx * (value(1, 1) - value(0, 1));
  return low + bz * (high - low);
}

/// A height field over [-1, 1]^2, y up: one height for each (x, z), so it cannot meet itself.
Surface make_bumpy_plane(std::uint64_t triangles, std::uint64_t seed) {
  const double squares = real(triangles) / 2;
  const std::uint64_t rows = std::max<std::uint64_t>(1, round_count(std::sqrt(squares)));
  const std::uint64_t columns = std::max<std::uint64_t>(1, round_count(squares / real(rows)));
  Surface surface;
  for (std::uint64_t i = 0; i <= rows; ++i) {
    for (std::uint64_t j = 0; j <= columns; ++j) {
      const double x = 2 * real(j) / real(columns) - 1, z = 2 * real(i) / real(rows) - 1;
      double height = 0, amplitude = 0.15, frequency = 2;
      for (std::uint64_t octave = 0; octave < 5; ++octave) {
        height += amplitude * noise(frequency * x, frequency * z, seed * 64 + octave);
        amplitude *= 0.45;
        frequency *= 2;
      }
      add_point(surface, {x, height, z});
    }
  }
  for (std::uint64_t i = 0; i < rows; ++i) {
    for (std::uint64_t j = 0; j < columns; ++j) {
      const auto corner = static_cast<Vertex>(i * (columns + 1) + j);
      const auto below = static_cast<Vertex>(corner + columns + 1);
      surface.triangles.push_back({corner, below, below + 1});
      surface.triangles.push_back({corner, below + 1, corner + 1});
    }
  }
  return surface;
}

constexpr std::array<SurfaceKind, 7> kKinds = {{
    {"sphere", "a sphere of radius 1; any even count", true, 8, make_sphere},
    {"torus-knot", "a tube along a trefoil, 3.2 wide", true, kKnotMinimum, make_torus_knot},
    {"bumpy-plane", "an open height field, y up, 2 wide", false, 2, make_bumpy_plane},
    {"knots", "a box of disjoint torus knots, one in each unit cell", true, 8 * kKnotMinimum, make_knots},
    {"needles", "tetrahedra 4000 times as long as wide", true, kNeedleTriangles, make_needles},
    {"slivers", "a pile of lenses, 10^5 times as wide as thick", true, kLensTriangles, make_slivers},
    {"lattice", "cubes on the integer lattice, corners in line", true, kCubeTriangles, make_lattice},
}};

}  // namespace

std::span<const SurfaceKind> surface_kinds() {
  return kKinds;
}

}  // namespace tetprep
