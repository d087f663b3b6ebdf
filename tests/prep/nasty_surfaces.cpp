// SPDX-License-Identifier: AGPL-3.0-or-later
#include "prep/nasty_surfaces.hpp"

#include <cmath>
#include <numbers>
#include <random>

namespace tetprep_test {
namespace {

/// Standard distributions differ between libraries; this does not.
class Random {
 public:
  explicit Random(std::uint64_t seed) : engine_(seed) {}
  /// In [low, high).
  double operator()(double low, double high) {
    return low + (high - low) * std::ldexp(static_cast<double>(engine_() >> 11), -53);
  }

 private:
  std::mt19937_64 engine_;
};

void add_triangle(TriangleSoup& soup, const std::array<tetprep::Point, 3>& corners) {
  const auto first = static_cast<Index>(soup.points.size());
  soup.points.insert(soup.points.end(), corners.begin(), corners.end());
  soup.triangles.push_back({first, first + 1, first + 2});
}

TriangleSoup scaled(TriangleSoup soup, double by) {
  for (auto& point : soup.points)
    for (double& x : point) x *= by;
  return soup;
}

}  // namespace

TriangleSoup random_triangles(int count, double reach, std::uint64_t seed) {
  Random random(seed);
  TriangleSoup soup;
  for (int i = 0; i < count; ++i) {
    tetprep::Point low{};
    for (double& x : low) x = random(0, 1 - reach);
    std::array<tetprep::Point, 3> corners{};
    for (auto& corner : corners)
      for (std::size_t k = 0; k < 3; ++k) corner[k] = low[k] + random(0, reach);
    add_triangle(soup, corners);
  }
  return soup;
}

TriangleSoup coplanar_triangles(int count, double reach, std::uint64_t seed) {
  constexpr double kExtent = 1 << 16;
  TriangleSoup soup = random_triangles(count, reach, seed);
  for (auto& [x, y, z] : soup.points) {
    x = std::floor(x * kExtent);
    y = std::floor(y * kExtent);
    z = 2 * x - 3 * y;
  }
  return soup;
}

TriangleSoup needle_fans(double least_angle) {
  TriangleSoup soup;
  const auto rim = [](double angle, double height) {
    return tetprep::Point{std::cos(angle), std::sin(angle), height};
  };
  double at = 0;
  for (double width = 1; width >= least_angle; width /= 2) {
    const double far = at + width;
    add_triangle(soup, {{{0, 0, 0}, rim(at, 0), rim(far, width)}});
    add_triangle(soup, {{{0, 0, 0}, rim(at, width / 3), rim(far, 0)}});
    at = far;
  }
  return soup;
}

TriangleSoup nested_spheres(int count, int n) {
  TriangleSoup soup;
  for (int i = 1; i <= count; ++i)
    soup = join(std::move(soup), scaled(ball(n), static_cast<double>(i) / count));
  return soup;
}

TriangleSoup touching_spheres(int count, int n) {
  TriangleSoup soup;
  const TriangleSoup sphere = ball(n);
  double right = 0;  // how far the sphere reaches to the right
  for (const auto& point : sphere.points) right = std::max(right, point[0]);
  const double aside = n % 2 == 0 ? 0 : 0.3 / n;
  for (int i = 0; i < count; ++i)
    soup = join(std::move(soup), moved(sphere, {2 * right * i, aside * (i % 2), 0}));
  return soup;
}

TriangleSoup doubled(const TriangleSoup& soup, const std::array<double, 3>& steps) {
  // The copy may widen the extent so much that the grid becomes coarser.
  for (int exponent = tetprep::snap(soup).grid_exponent;;) {
    const double step = std::ldexp(1.0, exponent);
    TriangleSoup both = join(soup, moved(soup, {steps[0] * step, steps[1] * step, steps[2] * step}));
    const int found = tetprep::snap(both).grid_exponent;
    if (found == exponent) return both;
    exponent = found;
  }
}

TriangleSoup sheets(int count, bool crossed) {
  TriangleSoup soup;
  soup.points = {{0, 0, -1}, {0, 0, 1}};
  for (int i = 0; i < count; ++i) {
    const double angle = 2 * std::numbers::pi * i / count;
    soup.points.push_back({std::cos(angle), std::sin(angle), 0.1 * std::sin(7.0 * i)});
    soup.triangles.push_back({0, 1, static_cast<Index>(soup.points.size() - 1)});
  }
  if (crossed) {
    add_triangle(soup, {{{-2, -2, 0.11}, {2, -2, 0.13}, {0, 3, 0.17}}});
    add_triangle(soup, {{{-2, 2, -0.2}, {2, 2, 0.4}, {0, -3, 0.3}}});
  }
  return soup;
}

TriangleSoup tiny_components(int count, bool overlapping, std::uint64_t seed) {
  Random random(seed);
  const auto side = static_cast<int>(std::ceil(std::cbrt(count)));
  const double size = overlapping ? 1.5 : 0.1;
  TriangleSoup soup;
  soup.points.reserve(4 * static_cast<std::size_t>(count));
  soup.triangles.reserve(4 * static_cast<std::size_t>(count));
  for (int i = 0; i < count; ++i) {
    const tetprep::Point low{static_cast<double>(i % side), static_cast<double>(i / side % side),
                             static_cast<double>(i / side / side)};
    const auto first = static_cast<Index>(soup.points.size());
    for (std::size_t corner = 0; corner < 4; ++corner) {
      // Near 0, x, y and z, so that none is flat or inside out.
      tetprep::Point p = low;
      for (std::size_t k = 0; k < 3; ++k) p[k] += size * ((corner == k + 1 ? 0.7 : 0) + random(0, 0.3));
      soup.points.push_back(p);
    }
    for (const auto& [a, b, c] :
         {std::array<Index, 3>{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, std::array<Index, 3>{1, 2, 3}})
      soup.triangles.push_back({first + a, first + b, first + c});
  }
  return soup;
}

}  // namespace tetprep_test
