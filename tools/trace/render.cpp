// SPDX-License-Identifier: AGPL-3.0-or-later
#include "trace/render.hpp"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <atomic>
#include <chrono>

#include "common/threads.hpp"
#include "trace/integrate.hpp"

namespace tetprep {
namespace {

constexpr int kTile = 32;  ///< pixels along a tile's edge: rays of a tile visit much the same tetrahedra

/// Places of a pixel's rays: `columns` x `rows` = samples, as square as the number allows.
struct SampleGrid {
  int columns = 1, rows = 1;
  explicit SampleGrid(int samples) {
    for (int r = 1; r * r <= samples; ++r) {
      if (samples % r == 0) rows = r;
    }
    columns = samples / rows;
  }
};

struct Picture {
  const Scene& scene;
  const Camera& camera;
  const RenderOptions& options;
  Place eye;
  SampleGrid grid;
  std::vector<Pixel> pixels;

  std::size_t number(int x, int y) const {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(options.width) +
           static_cast<std::size_t>(x);
  }
};

void trace_pixel(Picture& picture, int x, int y, Rays& rays) {
  Pixel pixel;  // local, so that neighbouring threads do not share its cache line
  for (int j = 0; j < picture.grid.rows; ++j) {
    for (int i = 0; i < picture.grid.columns; ++i) {
      const tetfmt::Vec3f direction =
          rounded(picture.camera.direction((x + (i + 0.5) / picture.grid.columns) / picture.options.width,
                                           (y + (j + 0.5) / picture.grid.rows) / picture.options.height));
      if (picture.options.shade == Shade::scene) {
        const Dice dice(picture.number(x, y), static_cast<std::uint64_t>(pixel.rays));
        Integrator integrator(picture.scene, picture.camera, rays, dice);
        pixel.colour = pixel.colour + integrator.seen_from(picture.eye, direction);
        ++pixel.rays;
      } else {
        const SceneHit hit = rays.first_hit(RayKind::camera, picture.eye, direction);
        gather(pixel, picture.options.shade, picture.scene.parts[hit.part]->view(), picture.camera,
               vec3(direction), hit.hit);
      }
    }
  }
  picture.pixels[picture.number(x, y)] = pixel;
}

RayCounts trace_tiles(Picture& picture, Progress& progress) {
  const int width = picture.options.width, height = picture.options.height;
  const int columns = (width + kTile - 1) / kTile, rows = (height + kTile - 1) / kTile;
  std::vector<RayCounts> parts(static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows));
  std::atomic<std::size_t> done{0};
  tbb::parallel_for(std::size_t{0}, parts.size(), [&](std::size_t tile) {
    const int x0 = static_cast<int>(tile % static_cast<std::size_t>(columns)) * kTile;
    const int y0 = static_cast<int>(tile / static_cast<std::size_t>(columns)) * kTile;
    Rays rays(picture.scene, picture.options.kernel);
    for (int y = y0; y < std::min(y0 + kTile, height); ++y) {
      for (int x = x0; x < std::min(x0 + kTile, width); ++x) trace_pixel(picture, x, y, rays);
    }
    parts[tile] = rays.counts();
    progress.fraction(static_cast<double>(++done) / static_cast<double>(parts.size()));
  });
  RayCounts sum;
  for (const RayCounts& part : parts) sum.add(part);
  return sum;
}

Range quantity_range(const std::vector<Pixel>& pixels, Shade shade) {
  Range range;
  bool first = true;
  for (const Pixel& pixel : pixels) {
    if (shade == Shade::depth && pixel.hits == 0) continue;
    const double value = mean_quantity(pixel, shade);
    range.low = first ? value : std::min(range.low, value);
    range.high = first ? value : std::max(range.high, value);
    first = false;
  }
  return range;
}

}  // namespace

Rendering render(const Scene& scene, const Camera& camera, const RenderOptions& options, Progress& progress) {
  const auto pixel_count = static_cast<std::size_t>(options.width) * static_cast<std::size_t>(options.height);
  const auto eye = locate_everywhere(scene, camera.eye, "the camera", " with --eye");
  Picture picture{scene, camera, options, {camera.eye, eye, 0, {}}, SampleGrid(options.samples), {}};
  picture.pixels.resize(pixel_count);

  RenderStatistics statistics;
  progress.stage("trace");
  const auto begin = std::chrono::steady_clock::now();
  with_threads(options.threads, [&] { statistics.counts = trace_tiles(picture, progress); });
  statistics.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  statistics.threads = thread_count(options.threads);

  progress.stage("develop");
  Image image(options.width, options.height);
  const Range range = quantity_range(picture.pixels, options.shade);
  for (int y = 0; y < options.height; ++y) {
    const double height = (y + 0.5) / options.height;
    for (int x = 0; x < options.width; ++x)
      image.at(x, y) =
          develop(picture.pixels[picture.number(x, y)], options.shade, range, scene.background, height);
  }
  return {std::move(image), statistics};
}

}  // namespace tetprep
