// SPDX-License-Identifier: AGPL-3.0-or-later
#include "trace/shade.hpp"

#include <algorithm>
#include <array>

#include "trace/surface.hpp"

namespace tetprep {
namespace {

/// A model under the camera's own lights. `n` faces the camera.
Rgb clay(Vec3 n, const Camera& camera) {
  static const Rgb kClay = from_screen(228, 208, 186);
  return kClay * camera_light(n, camera);
}
/// Viridis (Smith and van der Walt 2015) by five of its colours, straight lines between them as screens show
/// them.
Rgb viridis(double t) {
  static constexpr std::array<std::array<double, 3>, 5> kPoints = {
      {{68, 1, 84}, {59, 82, 139}, {33, 145, 140}, {94, 201, 98}, {253, 231, 37}}};
  const double place = std::clamp(t, 0.0, 1.0) * (kPoints.size() - 1);
  const auto i = std::min(static_cast<std::size_t>(place), kPoints.size() - 2);
  const double f = place - static_cast<double>(i);
  const auto channel = [&](std::size_t c) { return (1 - f) * kPoints[i][c] + f * kPoints[i + 1][c]; };
  return from_screen(channel(0), channel(1), channel(2));
}

}  // namespace

Rgb camera_light(Vec3 n, const Camera& camera) {
  static const Rgb kKeyLight = from_screen(255, 249, 238), kHeadLight = from_screen(222, 232, 255);
  const Vec3 to_key = unit(-0.55 * camera.right + 0.70 * camera.up - 0.65 * camera.forward);
  const double key = std::max(0.0, dot(n, to_key));
  const double head = std::max(0.0, -dot(n, camera.forward));
  const double sky = 0.5 + 0.5 * dot(n, camera.up);
  return (0.72 * key) * kKeyLight + (0.32 * head + 0.09 * sky) * kHeadLight;
}

void gather(Pixel& pixel, Shade shade, const tetfmt::FileView& view, const Camera& camera, Vec3 direction,
            const tetfmt::Hit& hit) {
  ++pixel.rays;
  const bool met = hit.outcome == tetfmt::Outcome::hit;
  pixel.hits += met;
  if (shade == Shade::steps) pixel.quantity += hit.steps;
  if (!met || shade == Shade::steps) return;
  if (shade == Shade::depth) {
    pixel.quantity += hit.t * dot(direction, camera.forward);
    return;
  }
  const Vec3 n = triangle_normal(view, hit.triangle);
  if (shade == Shade::normal) {
    pixel.colour = pixel.colour + from_screen(127.5 * (n.x + 1), 127.5 * (n.y + 1), 127.5 * (n.z + 1));
  } else {
    pixel.colour = pixel.colour + clay(dot(n, direction) > 0 ? -n : n, camera);
  }
}

double mean_quantity(const Pixel& pixel, Shade shade) {
  return pixel.quantity / (shade == Shade::depth ? pixel.hits : pixel.rays);
}

Rgb develop(const Pixel& pixel, Shade shade, Range range, const Background& background, double height) {
  if (shade == Shade::scene) return (1.0 / pixel.rays) * pixel.colour;
  if (shade == Shade::steps) return viridis(mean_quantity(pixel, shade) / std::max(range.high, 1.0));
  const double covered = static_cast<double>(pixel.hits) / pixel.rays;
  if (shade == Shade::depth) {
    if (pixel.hits == 0) return {};
    const double span = range.high - range.low;
    const double nearness = span > 0 ? (range.high - mean_quantity(pixel, shade)) / span : 1;
    const double grey = 255 * (0.12 + 0.88 * nearness);  // the farthest point still stands out from black
    return covered * from_screen(grey, grey, grey);
  }
  return (1.0 / pixel.rays) * pixel.colour + (1 - covered) * mix(background.top, background.bottom, height);
}

}  // namespace tetprep
