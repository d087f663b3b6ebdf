// SPDX-License-Identifier: AGPL-3.0-or-later
#include "sample/hostile.hpp"

#include <algorithm>
#include <cmath>

#include "sample/turn.hpp"

namespace tetprep {
namespace {

using Vertex = std::uint32_t;

double real(std::uint64_t count) {
  return static_cast<double>(count);
}

/// How many parts of `size` triangles make about `triangles`.
std::uint64_t parts(std::uint64_t triangles, std::uint64_t size) {
  return std::max<std::uint64_t>(1, (triangles + size / 2) / size);
}

/// The least n with n^power at least `count`.
std::uint64_t root(std::uint64_t count, int power) {
  std::uint64_t n = 1;
  while (std::pow(real(n), power) < real(count)) ++n;
  return n;
}

Vertex add_point(Surface& surface, double x, double y, double z) {
  surface.points.push_back({static_cast<float>(x), static_cast<float>(y), static_cast<float>(z)});
  return static_cast<Vertex>(surface.points.size() - 1);
}

}  // namespace

Surface make_needles(std::uint64_t triangles, std::uint64_t seed) {
  const std::uint64_t count = parts(triangles, kNeedleTriangles), edge = root(count, 2);
  Surface surface;
  Random random(seed);
  for (std::uint64_t i = 0; i < count; ++i) {
    const double cell = 1 / real(edge), width = 0.00025;
    const double x = (real(i % edge) + 0.3 + 0.4 * random.uniform()) * cell;
    const double y = (real(i / edge) + 0.3 + 0.4 * random.uniform()) * cell;
    const double low = 0.1 * random.uniform(), around = random.uniform();
    std::array<Vertex, 3> base{};
    for (std::uint64_t k = 0; k < 3; ++k) {
      const CosSin at = turn(around + real(k) / 3);
      // Narrower than the cell, however many there are.
      const double radius = std::min(width, 0.1 * cell);
      base[k] = add_point(surface, x + radius * at.cos, y + radius * at.sin, low);
    }
    const double lean = 0.25 * cell;
    const double tip_x = x + lean * (2 * random.uniform() - 1), tip_y = y + lean * (2 * random.uniform() - 1);
    const Vertex tip = add_point(surface, tip_x, tip_y, low + 1);
    surface.triangles.push_back({base[0], base[2], base[1]});
    for (std::size_t k = 0; k < 3; ++k) surface.triangles.push_back({base[k], base[(k + 1) % 3], tip});
  }
  return surface;
}

Surface make_slivers(std::uint64_t triangles, std::uint64_t seed) {
  // In piles: float32 cannot tell any number of them apart in one.
  constexpr std::uint64_t kPile = 1000;
  const std::uint64_t count = parts(triangles, kLensTriangles), corners = kLensTriangles / 2;
  const std::uint64_t edge = root((count + kPile - 1) / kPile, 2);
  Surface surface;
  Random random(seed);
  for (std::uint64_t i = 0; i < count; ++i) {
    const double middle = real(i % kPile) / real(kPile), half = 5e-6, around = random.uniform();
    const double x = 2 * real(i / kPile % edge), y = 2 * real(i / kPile / edge);
    const auto first = static_cast<Vertex>(surface.points.size());
    for (std::uint64_t k = 0; k < corners; ++k) {
      const CosSin at = turn(around + real(k) / real(corners));
      add_point(surface, x + 0.5 * at.cos, y + 0.5 * at.sin, middle);
    }
    const Vertex top = add_point(surface, x, y, middle + half),
                 bottom = add_point(surface, x, y, middle - half);
    for (std::uint64_t k = 0; k < corners; ++k) {
      const auto a = static_cast<Vertex>(first + k), b = static_cast<Vertex>(first + (k + 1) % corners);
      surface.triangles.push_back({a, b, top});
      surface.triangles.push_back({b, a, bottom});
    }
  }
  return surface;
}

Surface make_lattice(std::uint64_t triangles, std::uint64_t seed) {
  const std::uint64_t count = parts(triangles, kCubeTriangles), edge = root(count, 3);
  Surface surface;
  Random random(seed);
  for (std::uint64_t i = 0; i < count; ++i) {
    // A cube of edge 1, 2 or 3 in a cell of edge 4, from the cell's low corner.
    const std::array<std::uint64_t, 3> low = {4 * (i % edge), 4 * (i / edge % edge), 4 * (i / edge / edge)};
    const std::uint64_t size = 1 + random.next() % 3;
    const auto first = static_cast<Vertex>(surface.points.size());
    for (std::uint64_t corner = 0; corner < 8; ++corner)
      add_point(surface, real(low[0] + size * (corner & 1U)), real(low[1] + size * (corner >> 1U & 1U)),
                real(low[2] + size * (corner >> 2U)));
    constexpr std::array<std::array<Vertex, 4>, 6> kSquares = {
        {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}}};
    for (const auto& [a, b, c, d] : kSquares) {
      surface.triangles.push_back({first + a, first + b, first + c});
      surface.triangles.push_back({first + a, first + c, first + d});
    }
  }
  return surface;
}

}  // namespace tetprep
