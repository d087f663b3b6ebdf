// SPDX-License-Identifier: AGPL-3.0-or-later
// `tet query`: rays in, first hits out.
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <iostream>
#include <memory>

#include "common/failure.hpp"
#include "common/output.hpp"
#include "common/same_file.hpp"
#include "common/terminal_progress.hpp"
#include "common/tet_file.hpp"
#include "common/threads.hpp"
#include "tet/command.hpp"
#include "tet/hit_file.hpp"
#include "tet/ray_file.hpp"
#include "tetfmt/traverse.hpp"

namespace tetprep {
namespace {

struct QueryOptions {
  std::string file, rays, hits;
  int threads = 0;
  bool model_space = true;
  tetfmt::Kernel kernel = tetfmt::Kernel::exact;
};

/// Rays are answered in blocks of this many. Within a block each walk to a ray's origin starts from the one
/// before; the first starts from the source tet. Which of several tetrahedra a boundary point is given to can
/// depend on where the walk came from, so blocks, not threads, decide it: the answer is the same for any
/// number of threads.
constexpr std::size_t kBlock = 4096;
/// Blocks between two writes: bounds the memory that results wait in.
constexpr std::size_t kBatch = 64;

/// How many rays share some trait, and the first of them.
struct Tally {
  std::size_t count = 0, first = SIZE_MAX;
  void add(std::size_t ray) {
    ++count;
    first = std::min(first, ray);
  }
  void add(const Tally& more) {
    count += more.count;
    first = std::min(first, more.first);
  }
};

struct Block {
  std::string formatted;
  std::size_t corrupt = SIZE_MAX;     ///< the first ray whose walk met bytes that are no mesh
  std::size_t unstorable = SIZE_MAX;  ///< the first ray that float32 cannot hold at all
  std::size_t rounded = 0;            ///< numbers that local space had to round
  Tally directionless;                ///< rays whose direction is zero in float32
  Tally lost;                         ///< rays that only the float kernel could not answer
  Tally absent;                       ///< rays that start in space that the file leaves out
};

/// Model space is shifted in double and rounded once; local space should not need rounding, so it is counted.
tetfmt::Ray local_ray(const std::array<double, 6>& row, const std::array<double, 3>& origin, bool model_space,
                      Block& block) {
  std::array<float, 6> local{};
  for (std::size_t i = 0; i < 6; ++i) {
    const double exact = model_space && i < 3 ? row[i] - origin[i] : row[i];
    local[i] = static_cast<float>(exact);
    if (!model_space && static_cast<double>(local[i]) != exact) ++block.rounded;
  }
  return {{local[0], local[1], local[2]}, {local[3], local[4], local[5]}};
}

bool storable(const tetfmt::Ray& ray) {
  const auto finite = [](const tetfmt::Vec3f& v) {
    return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
  };
  return finite(ray.origin) && finite(ray.direction);
}

Block answer(const QueryOptions& options, const tetfmt::FileView& view, const RayFile& rays,
             const HitFile& out, std::size_t begin) {
  Block block;
  const std::size_t end = std::min(begin + kBlock, rays.size());
  std::vector<tetfmt::Hit> hits(end - begin);
  std::optional<tetfmt::Cell> near;
  std::optional<tetfmt::Vec3f> located;
  tetfmt::Location location;
  for (std::size_t i = begin; i < end; ++i) {
    const tetfmt::Ray ray = local_ray(rays[i], view.header().origin, options.model_space, block);
    if (!storable(ray)) {
      block.unstorable = i;
      return block;
    }
    if (ray.direction == tetfmt::Vec3f{}) block.directionless.add(i);
    if (located != ray.origin) {
      location = tetfmt::locate(view, ray.origin, near ? &*near : nullptr);
      located = ray.origin;
      if (location.state == tetfmt::Location::State::inside) near = location.cell;
    }
    tetfmt::Hit& hit = hits[i - begin];
    hit = tetfmt::first_hit(view, location, ray.direction, {}, options.kernel);
    // Float signs can go in circles on a sound mesh: only the exact walk may blame the file.
    if (hit.outcome == tetfmt::Outcome::corrupt && options.kernel != tetfmt::Kernel::exact &&
        tetfmt::first_hit(view, location, ray.direction).outcome != tetfmt::Outcome::corrupt) {
      hit = {};
      block.lost.add(i);
    }
    if (hit.outcome == tetfmt::Outcome::corrupt || location.state == tetfmt::Location::State::corrupt) {
      block.corrupt = i;
      return block;
    }
    if (hit.outcome == tetfmt::Outcome::absent) block.absent.add(i);
  }
  block.formatted = out.format(hits);
  return block;
}

void warn(const std::string& message) {
  std::cerr << "tet query: warning: " << one_line(message) << '\n';
}

std::string rays_text(const Tally& rays) {
  return std::to_string(rays.count) + (rays.count == 1 ? " ray" : " rays");
}

int run_query(const QueryOptions& options) {
  table_format(options.rays, "--rays");  // both names before any reading, which may take long
  table_format(options.hits, "--hits");
  refuse_same_file(options.file, options.hits);
  refuse_same_file(options.rays, options.hits);
  const TetFile file(options.file);
  const RayFile rays(options.rays);
  HitFile out(options.hits, rays.size());

  std::size_t rounded = 0;
  Tally directionless, lost, absent;
  TerminalProgress progress(options.hits != "-");
  progress.stage("query");
  with_threads(options.threads, [&] {
    for (std::size_t begin = 0; begin < rays.size(); begin += kBlock * kBatch) {
      const std::size_t count = std::min(kBatch, (rays.size() - begin + kBlock - 1) / kBlock);
      std::vector<Block> blocks(count);
      tbb::parallel_for(std::size_t{0}, count, [&](std::size_t b) {
        blocks[b] = answer(options, file.view(), rays, out, begin + b * kBlock);
      });
      for (const Block& block : blocks) {
        if (block.unstorable != SIZE_MAX) {
          throw Failure(
              ExitCode::invalid,
              rays.place(block.unstorable) + ": too large for float32 once the file's origin is subtracted");
        }
        if (block.corrupt != SIZE_MAX) {
          throw Failure(ExitCode::invalid,
                        options.file + ": the ray at " + rays.place(block.corrupt) +
                            " ran into bytes that are no mesh; run `tet validate` on the file");
        }
        out.write(block.formatted);
        rounded += block.rounded;
        directionless.add(block.directionless);
        lost.add(block.lost);
        absent.add(block.absent);
      }
      progress.fraction(static_cast<double>(begin) / static_cast<double>(rays.size()));
    }
  });
  out.commit();
  const std::string rays_name = options.rays == "-" ? "standard input" : options.rays;
  if (rounded > 0) {
    warn(std::to_string(rounded) + (rounded == 1 ? " number of " : " numbers of ") + rays_name +
         (rounded == 1 ? " is no float32 and was rounded" : " are no float32 and were rounded") +
         "; local space promises exactness only for float32");
  }
  if (directionless.count > 0) {
    warn(rays_text(directionless) + " of " + rays_name + (directionless.count == 1 ? " has" : " have") +
         " direction zero in float32 and " + (directionless.count == 1 ? "hits" : "hit") +
         " nothing, first ray " + std::to_string(directionless.first));
  }
  if (absent.count > 0) {
    warn(rays_text(absent) + " of " + rays_name + (absent.count == 1 ? " starts" : " start") +
         " in space that " + options.file + " leaves out, first ray " + std::to_string(absent.first) +
         "; convert with --keep all to have it");
  }
  if (lost.count > 0) {
    warn("float kernel lost " + rays_text(lost) + " of " + rays_name + ", first ray " +
         std::to_string(lost.first) + "; use --kernel exact");
  }
  return 0;
}

}  // namespace

void add_query_command(CLI::App& app, std::function<int()>& run) {
  const auto options = std::make_shared<QueryOptions>();
  CLI::App* verb = app.add_subcommand(
      "query", "Answer rays: the first triangle of the input surface that each one meets.");
  verb->add_option("FILE", options->file, "A tet file")->required();
  verb->add_option("--rays", options->rays,
                   "Origins and directions. NAME.npy: an array of shape (n, 6), float32 or float64. "
                   "NAME.csv: six columns\n"
                   "ox,oy,oz,dx,dy,dz, a header line and # comments allowed. -: CSV on standard input")
      ->required()
      ->type_name("RAYS");
  verb->add_option("--hits", options->hits,
                   "Where the answers go, in the order of the rays. NAME.npy: a structured array. NAME.csv: "
                   "a header line\n"
                   "and a line a ray. -: CSV on standard output")
      ->required()
      ->type_name("HITS");
  verb->add_option_function<std::string>(
          "--space", [options](const std::string& name) { options->model_space = name == "model"; },
          "model: rays in the input mesh's coordinates; the file's origin is subtracted in double, then "
          "rounded to\n"
          "float32. local: in the file's own float32 coordinates (model minus origin), where nothing is "
          "rounded [model]")
      ->check(one_of({"model", "local"}))
      ->type_name("SPACE");
  verb->add_option_function<std::string>(
          "--kernel",
          [options](const std::string& name) {
            options->kernel = name == "exact" ? tetfmt::Kernel::exact : tetfmt::Kernel::float_only;
          },
          "exact: the walk's signs are certified. float: plain float signs, which can err where rays meet "
          "edges and\n"
          "vertices, and lose a ray (a miss, with a warning); for comparison [exact]")
      ->check(one_of({"exact", "float"}))
      ->type_name("KERNEL");
  verb->add_option("--threads", options->threads,
                   "Threads to use [all]; the answers are the same for any number")
      ->check(CLI::Range(1, kMaxThreads))
      ->type_name("N");
  verb->footer(
      "Fields of an answer:\n"
      "  triangle  int32    number of the input triangle, in input order from 0; -1: a miss; -2: the ray "
      "starts "
      "in space\n"
      "                     that the file leaves out (tet convert --keep), so that nothing is known of it\n"
      "  t         float64  where: origin + t * direction, in units of the given direction; inf for a miss, "
      "nan "
      "with -2\n"
      "  u, v      float64  barycentric weights of the triangle's 2nd and 3rd corner\n"
      "  side      int32    0: met from the front, where (b - a) x (c - a) points; 1: from the back; -1: no "
      "hit\n"
      "  tet       int32    the tetrahedron that the ray came through; -1: no hit\n"
      "  neighbor  int32    the tetrahedron beyond the triangle; -1: no hit, or the file leaves out what is "
      "there\n"
      "Directions need not be of unit length. A direction that is zero in float32 hits nothing, with a "
      "warning that\n"
      "counts rays from 0; rays from left-out space are told likewise. Numbers that "
      "are not\n"
      "finite are errors.\n"
      "\n"
      "Exit codes: 0 done; 1 usage; 2 a file cannot be read or written; 3 malformed rays or a broken tet "
      "file;\n"
      "5 a kind of file that this version does not know. On failure nothing is left at HITS.\n"
      "\n"
      "Examples:\n"
      "  tet query bunny.tet --rays rays.npy --hits hits.npy\n"
      "  echo 0,0,10,0,0,-1 | tet query bunny.tet --rays - --hits -\n"
      "  python3 -c \"import numpy; print(numpy.load('hits.npy')['triangle'])\"");
  verb->callback([options, &run] { run = [options] { return run_query(*options); }; });
}

}  // namespace tetprep
