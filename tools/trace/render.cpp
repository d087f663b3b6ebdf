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

constexpr int kTile = 32;    ///< pixels along the edge of a tile, which is one thread's
constexpr int kSquare = 16;  ///< samples along the edge of what is walked together...
constexpr int kBlock = 4;    ///< ...and of its blocks: the order that tetfmt::first_hits likes best
/// Samples whose light is asked for together, at least. More share more; fewer stay in a processor's cache.
constexpr std::size_t kBundle = 1024;

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
  std::vector<tetfmt::Location> eye;
  SampleGrid grid;
  std::vector<Pixel> pixels;

  std::size_t number(int x, int y) const {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(options.width) +
           static_cast<std::size_t>(x);
  }
};

/// Calls `use(i, j)` for x0 <= i < x1 and y0 <= j < y1, by squares of `edge` from the upper left corner.
template <class Use>
void for_each_square(int x0, int y0, int x1, int y1, int edge, Use use) {
  for (int y = y0; y < y1; y += edge) {
    for (int x = x0; x < x1; x += edge) use(x, y, std::min(x + edge, x1), std::min(y + edge, y1));
  }
}

/// One thread's work: the samples of a tile, square by square, so that rays which are walked together are
/// close.
class Tile {
 public:
  explicit Tile(Picture& picture)
      : picture_(picture),
        rays_(picture.scene, picture.options.walks),
        integrator_(picture.scene, picture.camera, rays_) {}

  /// Pixels from (x0, y0) up to (x1, y1), exclusive.
  void trace(int x0, int y0, int x1, int y1) {
    const auto [columns, rows] = picture_.grid;
    for_each_square(x0 * columns, y0 * rows, x1 * columns, y1 * rows, kSquare,
                    [&](int i0, int j0, int i1, int j1) { trace_square(i0, j0, i1, j1); });
    add_light();
  }
  const RayCounts& counts() const { return rays_.counts(); }

 private:
  /// A sample's pixel, and its number among those of the pixel.
  struct Origin {
    std::size_t pixel, sample;
  };

  /// Samples are counted over the whole picture, as if they were smaller pixels.
  void trace_square(int i0, int j0, int i1, int j1) {
    directions_.clear(), origins_.clear();
    for_each_square(i0, j0, i1, j1, kBlock, [&](int block_i0, int block_j0, int block_i1, int block_j1) {
      for_each_square(block_i0, block_j0, block_i1, block_j1, 1, [&](int i, int j, int, int) { add(i, j); });
    });
    hits_.resize(directions_.size());
    rays_.first_hits(picture_.eye, directions_, hits_);
    for (std::size_t k = 0; k < hits_.size(); ++k) {
      Pixel& pixel = picture_.pixels[origins_[k].pixel];
      if (picture_.options.shade == Shade::scene) {
        bundle_.push_back({directions_[k], hits_[k], Dice(origins_[k].pixel, origins_[k].sample), {}});
        targets_.push_back(&pixel);
      } else {
        gather(pixel, picture_.options.shade, picture_.scene.parts[hits_[k].part]->view(), picture_.camera,
               vec3(directions_[k]), hits_[k].hit);
      }
    }
    if (bundle_.size() >= kBundle) add_light();
  }

  void add(int i, int j) {
    const auto [columns, rows] = picture_.grid;
    const int x = i / columns, y = j / rows, column = i % columns, row = j % rows;
    directions_.push_back(
        rounded(picture_.camera.direction((x + (column + 0.5) / columns) / picture_.options.width,
                                          (y + (row + 0.5) / rows) / picture_.options.height)));
    origins_.push_back({picture_.number(x, y), static_cast<std::size_t>(row * columns + column)});
  }

  void add_light() {
    integrator_.add_light(bundle_);
    for (std::size_t k = 0; k < bundle_.size(); ++k) {
      targets_[k]->colour = targets_[k]->colour + bundle_[k].light;
      ++targets_[k]->rays;
    }
    bundle_.clear(), targets_.clear();
  }

  Picture& picture_;
  Rays rays_;
  Integrator integrator_;
  std::vector<tetfmt::Vec3f> directions_;  // of a square
  std::vector<Origin> origins_;
  std::vector<SceneHit> hits_;
  std::vector<Sample> bundle_;  // of Shade::scene: those whose light is still to be asked for
  std::vector<Pixel*> targets_;
};

RayCounts trace_tiles(Picture& picture, Progress& progress) {
  const int width = picture.options.width, height = picture.options.height;
  const int columns = (width + kTile - 1) / kTile, rows = (height + kTile - 1) / kTile;
  std::vector<RayCounts> parts(static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows));
  std::atomic<std::size_t> done{0};
  tbb::parallel_for(std::size_t{0}, parts.size(), [&](std::size_t tile) {
    const int x0 = static_cast<int>(tile % static_cast<std::size_t>(columns)) * kTile;
    const int y0 = static_cast<int>(tile / static_cast<std::size_t>(columns)) * kTile;
    Tile worker(picture);
    worker.trace(x0, y0, std::min(x0 + kTile, width), std::min(y0 + kTile, height));
    parts[tile] = worker.counts();
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
  Picture picture{scene,
                  camera,
                  options,
                  locate_everywhere(scene, camera.eye, "the camera", camera.where),
                  SampleGrid(options.samples),
                  {}};
  picture.pixels.resize(pixel_count);

  RenderStatistics statistics;
  progress.stage("trace");
  const auto begin = std::chrono::steady_clock::now();
  with_threads(options.threads, [&] { statistics.counts = trace_tiles(picture, progress); });
  statistics.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  statistics.threads = thread_count(options.threads);
  statistics.walks = options.walks;

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
