// SPDX-License-Identifier: AGPL-3.0-or-later
// The variants of the walk beside each other: arithmetic and basis, on camera rays and on rays from the
// surface.
#include <algorithm>
#include <array>
#include <utility>

#include "bench/bench.hpp"
#include "bench/dice.hpp"
#include "bench/statistics.hpp"
#include "bench/text.hpp"
#include "common/output.hpp"
#include "tetfmt/kernels.hpp"

namespace tetbench {
namespace {

using tetfmt::Arithmetic;
using tetfmt::Basis;
using tetfmt::Hit;
using tetfmt::Location;
using tetfmt::Outcome;
using tetfmt::Vec3f;

struct Named {
  const char* name;
  tetfmt::Variant variant;
};
constexpr Named kVariants[] = {
    {"float, shear", {Arithmetic::float_only, Basis::shear}},
    {"exact, shear", {Arithmetic::exact, Basis::shear}},
    {"float first, shear", {Arithmetic::float_first, Basis::shear}},
    {"float, orthonormal", {Arithmetic::float_only, Basis::orthonormal}},
    {"exact, orthonormal", {Arithmetic::exact, Basis::orthonormal}},
    {"float, specialised", {Arithmetic::float_only, Basis::specialised}},
    {"exact, specialised", {Arithmetic::exact, Basis::specialised}},
};
constexpr std::size_t kExact = 1;  ///< the one whose answers the others are held against

struct RaysFrom {
  std::vector<Location> from;
  std::vector<Vec3f> directions;
  void add(const Location& location, Vec3f direction) {
    from.push_back(location);
    directions.push_back(direction);
  }
  std::size_t size() const { return directions.size(); }
};

RaysFrom shuffled(const RaysFrom& rays, Dice& dice) {
  RaysFrom result = rays;
  for (std::size_t i = result.size(); i > 1; --i) {
    const std::size_t j = dice.below(i);
    std::swap(result.from[i - 1], result.from[j]);
    std::swap(result.directions[i - 1], result.directions[j]);
  }
  return result;
}

/// From where each camera ray hits, into the half space above the triangle, evenly over the hemisphere.
RaysFrom from_surface(const tetfmt::TrustedView& view, const RaysFrom& camera, Dice& dice) {
  RaysFrom result;
  const auto vertices = view.view().vertices();
  for (std::size_t i = 0; i < camera.size(); ++i) {
    const Hit hit = tetfmt::first_hit(view, camera.from[i], camera.directions[i]);
    if (hit.outcome != Outcome::hit) continue;
    const auto& v = view.view().triangles()[view.view().sides()[hit.side].triangle].vertices;
    const auto edge = [&](std::size_t k) {
      const Vec3f &a = vertices[v[0]], &b = vertices[v[k]];
      return std::array{double{b.x} - double{a.x}, double{b.y} - double{a.y}, double{b.z} - double{a.z}};
    };
    const auto e = edge(1), f = edge(2);
    std::array<double, 3> d = dice.direction();
    double along = 0;
    for (std::size_t k = 0; k < 3; ++k)
      along += d[k] * (e[(k + 1) % 3] * f[(k + 2) % 3] - e[(k + 2) % 3] * f[(k + 1) % 3]);
    const double sign = (along > 0) != hit.back ? 1 : -1;
    result.add(
        tetfmt::near_side(view.view(), hit),
        {static_cast<float>(sign * d[0]), static_cast<float>(sign * d[1]), static_cast<float>(sign * d[2])});
  }
  return result;
}

/// Along lines through two vertices of the mesh, from the first: what float signs cannot tell.
RaysFrom between_vertices(const tetfmt::TrustedView& view, std::size_t count, Dice& dice) {
  RaysFrom result;
  const auto vertices = view.view().vertices();
  while (result.size() < count) {
    const Vec3f &a = vertices[dice.below(vertices.size())], &b = vertices[dice.below(vertices.size())];
    if (a != b) result.add(tetfmt::locate(view, a), {b.x - a.x, b.y - a.y, b.z - a.z});
  }
  return result;
}

void compare(const char* title, const tetfmt::TrustedView& view, const RaysFrom& rays, int repeats) {
  std::array<std::vector<double>, std::size(kVariants)> times;
  std::array<Answers, std::size(kVariants)> answers;
  for (int repeat = 0; repeat < repeats; ++repeat) {
    for (std::size_t i = 0; i < std::size(kVariants); ++i) {
      answers[i].resize(rays.size());
      times[i].push_back(
          seconds([&] {
            for (std::size_t k = 0; k < rays.size(); ++k)
              answers[i][k] =
                  tetfmt::first_hit(view, rays.from[k], rays.directions[k], kVariants[i].variant).side;
          }) *
          1e9 / static_cast<double>(rays.size()));
    }
  }
  const auto print = [](const std::string& text) { tetprep::Output::standard().write(text); };
  print(format("\n%s: %zu rays\n", title, rays.size()));
  for (std::size_t i = 0; i < std::size(kVariants); ++i) {
    std::size_t different = 0;
    tetfmt::SignCounts counts;
    for (std::size_t k = 0; k < rays.size(); ++k) {
      different += answers[i][k] != answers[kExact][k];
      tetfmt::first_hit(view, rays.from[k], rays.directions[k], kVariants[i].variant, &counts);
    }
    print(format(
        "  %-20s %-26s / float, shear %-22s other answers than exact: %zu; signs: %llu float, %llu double, "
        "%llu beyond\n",
        kVariants[i].name, text(summarize(times[i]), 0).c_str(), text(ratio(times[i], times[0]), 2).c_str(),
        different, static_cast<unsigned long long>(counts.in_float),
        static_cast<unsigned long long>(counts.in_double),
        static_cast<unsigned long long>(counts.in_double2 + counts.exact + counts.tied)));
  }
}

}  // namespace

void compare_variants(const tetfmt::TrustedView& view, const CameraSeries& options) {
  const std::vector<tetfmt::Ray> rays = camera_view(view.view(), 6.5f, options);
  const Location eye = tetfmt::locate(view, rays.front().origin);
  RaysFrom camera;
  for (const tetfmt::Ray& ray : rays) camera.add(eye, ray.direction);
  Dice dice({1});
  const RaysFrom surface = from_surface(view, camera, dice);
  compare("Camera rays, in the picture's order", view, camera, options.repeats);
  compare("Camera rays, shuffled", view, shuffled(camera, dice), options.repeats);
  compare("Rays from the surface, unbounded, in the picture's order", view, surface, options.repeats);
  compare("Rays from the surface, unbounded, shuffled", view, shuffled(surface, dice), options.repeats);
  // Few, for float signs send many of them in circles.
  const std::size_t few = std::min<std::size_t>(camera.size(), 10000);
  compare("Rays from vertex to vertex", view, between_vertices(view, few, dice), options.repeats);
}

}  // namespace tetbench
