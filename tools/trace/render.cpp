// SPDX-License-Identifier: AGPL-3.0-or-later
#include "trace/render.hpp"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <span>
#include <vector>

#include "common/threads.hpp"
#include "trace/integrate.hpp"

namespace tetprep {
namespace {

constexpr int kTile = 32;  ///< pixels along the edge of a tile, which is one thread's
/// Samples along the edges of squares, which are walked together, and of the squares that these are made of:
/// the order that suits tetfmt::first_hits, and tetfmt::occlusions from a light.
constexpr std::size_t kSquare = 32, kQuarter = 16, kBlock = 4;

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

/// Where a column (row) of samples is in the picture, as if samples were smaller pixels.
struct SampleLine {
  double place;     ///< 0 to 1
  int pixel;        ///< its column (row) of pixels
  int line_within;  ///< of that
};

/// Those of the pixels from `begin` up to `end`, of `edge` in all.
std::vector<SampleLine> sample_lines(int begin, int end, int lines_a_pixel, int edge) {
  std::vector<SampleLine> lines;
  for (int x = begin; x < end; ++x) {
    for (int i = 0; i < lines_a_pixel; ++i) lines.push_back({(x + (i + 0.5) / lines_a_pixel) / edge, x, i});
  }
  return lines;
}

/// Calls `use(columns, rows)` with squares of `edge` x `edge`, row by row; the last may be smaller.
template <class Use>
void for_each_square(std::span<const SampleLine> columns, std::span<const SampleLine> rows, std::size_t edge,
                     Use use) {
  const auto piece = [edge](std::span<const SampleLine> lines, std::size_t begin) {
    return lines.subspan(begin, std::min(edge, lines.size() - begin));
  };
  for (std::size_t y = 0; y < rows.size(); y += edge) {
    for (std::size_t x = 0; x < columns.size(); x += edge) use(piece(columns, x), piece(rows, y));
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
    const RenderOptions& options = picture_.options;
    for_each_square(sample_lines(x0, x1, picture_.grid.columns, options.width),
                    sample_lines(y0, y1, picture_.grid.rows, options.height), kSquare,
                    [&](auto columns, auto rows) { trace_square(columns, rows); });
  }
  const RayCounts& counts() const { return rays_.counts(); }

 private:
  void trace_square(std::span<const SampleLine> columns, std::span<const SampleLine> rows) {
    directions_.clear(), origins_.clear();
    for_each_square(columns, rows, kQuarter, [&](auto quarter_columns, auto quarter_rows) {
      for_each_square(quarter_columns, quarter_rows, kBlock, [&](auto block_columns, auto block_rows) {
        for (const SampleLine& row : block_rows) {
          for (const SampleLine& column : block_columns) add_ray(column, row);
        }
      });
    });
    hits_.resize(directions_.size());
    rays_.first_hits(picture_.eye, directions_, hits_);
    if (picture_.options.shade == Shade::scene) {
      add_light();
    } else {
      for (std::size_t k = 0; k < hits_.size(); ++k) {
        gather(picture_.pixels[origins_[k].pixel], picture_.options.shade,
               picture_.scene.parts[hits_[k].part]->view(), picture_.camera, vec3(directions_[k]),
               hits_[k].hit);
      }
    }
  }

  void add_ray(const SampleLine& column, const SampleLine& row) {
    directions_.push_back(rounded(picture_.camera.direction(column.place, row.place)));
    origins_.push_back(
        {picture_.number(column.pixel, row.pixel),
         static_cast<std::size_t>(row.line_within * picture_.grid.columns + column.line_within)});
  }

  void add_light() {
    samples_.clear();
    for (std::size_t k = 0; k < hits_.size(); ++k)
      samples_.push_back({directions_[k], hits_[k], Dice(origins_[k].pixel, origins_[k].sample), {}});
    integrator_.add_light(samples_);
    for (std::size_t k = 0; k < samples_.size(); ++k) {
      Pixel& pixel = picture_.pixels[origins_[k].pixel];
      pixel.colour = pixel.colour + samples_[k].light;
      ++pixel.rays;
    }
  }

  /// A sample's pixel, and its number among those of the pixel.
  struct Origin {
    std::size_t pixel, sample;
  };
  Picture& picture_;
  Rays rays_;
  Integrator integrator_;
  std::vector<tetfmt::Vec3f> directions_;  // of a square
  std::vector<Origin> origins_;
  std::vector<SceneHit> hits_;
  std::vector<Sample> samples_;
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
