// SPDX-License-Identifier: AGPL-3.0-or-later
#include "trace/render.hpp"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <atomic>
#include <chrono>

#include "common/failure.hpp"
#include "common/parse.hpp"
#include "common/threads.hpp"

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
  const tetfmt::FileView& view;
  const Camera& camera;
  const RenderOptions& options;
  tetfmt::Vec3f eye;
  tetfmt::Location start;
  SampleGrid grid;
  std::vector<Pixel> pixels;

  Pixel& pixel(int x, int y) {
    return pixels[static_cast<std::size_t>(y) * static_cast<std::size_t>(options.width) +
                  static_cast<std::size_t>(x)];
  }
};

/// Traces the rays of one pixel. False if one met bytes that are no mesh.
bool trace_pixel(Picture& picture, int x, int y, RenderStatistics& statistics) {
  Pixel pixel;  // local, so that neighbouring threads do not share its cache line
  for (int j = 0; j < picture.grid.rows; ++j) {
    for (int i = 0; i < picture.grid.columns; ++i) {
      const tetfmt::Vec3f direction =
          rounded(picture.camera.direction((x + (i + 0.5) / picture.grid.columns) / picture.options.width,
                                           (y + (j + 0.5) / picture.grid.rows) / picture.options.height));
      const tetfmt::Hit hit = tetfmt::first_hit(picture.view, picture.start, direction);
      if (hit.outcome == tetfmt::Outcome::corrupt) return false;
      ++statistics.rays;
      statistics.hits += hit.outcome == tetfmt::Outcome::hit;
      statistics.steps += hit.steps;
      statistics.most_steps = std::max(statistics.most_steps, hit.steps);
      gather(pixel, picture.options.shade, picture.view, picture.camera, vec3(direction), hit);
    }
  }
  picture.pixel(x, y) = pixel;
  return true;
}

RenderStatistics trace_tiles(Picture& picture, Progress& progress) {
  const int width = picture.options.width, height = picture.options.height;
  const int columns = (width + kTile - 1) / kTile, rows = (height + kTile - 1) / kTile;
  std::vector<RenderStatistics> parts(static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows));
  std::atomic<std::size_t> done{0};
  std::atomic<bool> corrupt{false};
  tbb::parallel_for(std::size_t{0}, parts.size(), [&](std::size_t tile) {
    const int x0 = static_cast<int>(tile % static_cast<std::size_t>(columns)) * kTile;
    const int y0 = static_cast<int>(tile / static_cast<std::size_t>(columns)) * kTile;
    for (int y = y0; y < std::min(y0 + kTile, height) && !corrupt; ++y) {
      for (int x = x0; x < std::min(x0 + kTile, width); ++x) {
        if (!trace_pixel(picture, x, y, parts[tile])) corrupt = true;
      }
    }
    progress.fraction(static_cast<double>(++done) / static_cast<double>(parts.size()));
  });
  if (corrupt) {
    throw Failure(ExitCode::invalid,
                  "a camera ray ran into bytes that are no mesh; run `tet validate` on the file");
  }
  RenderStatistics sum;
  for (const RenderStatistics& part : parts) {
    sum.rays += part.rays;
    sum.hits += part.hits;
    sum.steps += part.steps;
    sum.most_steps = std::max(sum.most_steps, part.most_steps);
  }
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

Rendering render(const tetfmt::FileView& view, const Camera& camera, const RenderOptions& options,
                 Progress& progress) {
  const auto pixel_count = static_cast<std::size_t>(options.width) * static_cast<std::size_t>(options.height);
  Picture picture{view, camera, options, rounded(camera.eye), {}, SampleGrid(options.samples), {}};
  picture.pixels.resize(pixel_count);
  picture.start = tetfmt::locate(view, picture.eye);
  if (picture.start.state == tetfmt::Location::State::corrupt) {
    throw Failure(ExitCode::invalid, "the camera cannot be located in this file; run `tet validate` on it");
  }

  if (picture.start.state == tetfmt::Location::State::absent) {
    const Vec3 eye = camera.eye;
    const auto& origin = view.header().origin;
    throw Failure(
        ExitCode::usage,
        "the camera at " + number(eye.x + origin[0]) + "," + number(eye.y + origin[1]) + "," +
            number(eye.z + origin[2]) +
            " is in space that the file leaves out; place it elsewhere with --eye (`tet info` lists "
            "the regions that are there), or convert with --keep all");
  }

  RenderStatistics statistics;
  progress.stage("trace");
  const auto begin = std::chrono::steady_clock::now();
  with_threads(options.threads, [&] { statistics = trace_tiles(picture, progress); });
  statistics.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  statistics.threads = thread_count(options.threads);

  progress.stage("develop");
  Image image(options.width, options.height);
  const Range range = quantity_range(picture.pixels, options.shade);
  for (int y = 0; y < options.height; ++y) {
    const double height = (y + 0.5) / options.height;
    for (int x = 0; x < options.width; ++x) {
      image.set(x, y, develop(picture.pixel(x, y), options.shade, range, height));
    }
  }
  return {std::move(image), statistics};
}

}  // namespace tetprep
