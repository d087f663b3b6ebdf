// SPDX-License-Identifier: AGPL-3.0-or-later
// `tet query`: rays in, answers out.
#include <tbb/parallel_pipeline.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <cmath>
#include <iostream>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "common/failure.hpp"
#include "common/output.hpp"
#include "common/same_file.hpp"
#include "common/terminal_progress.hpp"
#include "common/tet_file.hpp"
#include "common/threads.hpp"
#include "tet/answer_file.hpp"
#include "tet/command.hpp"
#include "tet/ray_answers.hpp"
#include "tet/ray_file.hpp"
#include "tetfmt/batch.hpp"
#include "tetfmt/traverse.hpp"

namespace tetprep {
namespace {

struct QueryOptions {
  std::string file, rays, hits;
  int threads = 0;
  bool model_space = true;
  Answer answer = Answer::first;
  tetfmt::Kernel kernel = tetfmt::Kernel::exact;
};

/// Rays are answered in blocks of this many. Within a block each walk to a ray's origin starts from the one
/// before; the first starts from the source tet. (A point is given to the same tetrahedron whichever way the
/// walk came, so this is a matter of speed only.)
constexpr std::size_t kBlock = 1024;
/// A block whose rows fill more bytes than this ends early, and is finished where it is written: so memory is
/// bounded however many crossings a ray has.
constexpr std::size_t kBlockBytes = std::size_t{4} << 20;
/// Blocks that may wait for each other, a thread.
constexpr std::size_t kBlocksPerThread = 4;

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

/// What there is to say of rays beyond their answers.
struct Remarks {
  std::size_t rounded = 0;  ///< numbers that local space had to round
  Tally directionless;      ///< rays whose direction is zero in float32
  Tally empty;              ///< rays whose t_max lies before t_min, or before 0
  Tally lost;               ///< rays that only the float kernel could not answer
  Tally absent;             ///< rays that start in space that the file leaves out
  void add(const Remarks& more) {
    rounded += more.rounded;
    directionless.add(more.directionless);
    empty.add(more.empty);
    lost.add(more.lost);
    absent.add(more.absent);
  }
};

/// The rays from `next` to `end`; those before are answered.
struct Block {
  std::size_t next = 0, end = 0;
  Rows rows;
  Remarks remarks;
  bool unstorable = false;  ///< the ray `next` is one that float32 cannot hold at all
  bool corrupt = false;     ///< the walk of the ray `next` met bytes that are no mesh
};

/// Model space is shifted in double and rounded once; local space should not need rounding, so it is counted.
tetfmt::Ray local_ray(const GivenRay& given, const std::array<double, 3>& origin, bool model_space,
                      Remarks& remarks) {
  std::array<float, 6> local{};
  for (std::size_t i = 0; i < 6; ++i) {
    const double number = i < 3 ? given.origin[i] : given.direction[i - 3];
    const double exact = model_space && i < 3 ? number - origin[i] : number;
    local[i] = static_cast<float>(exact);
    if (!model_space && static_cast<double>(local[i]) != exact) ++remarks.rounded;
  }
  return {{local[0], local[1], local[2]}, {local[3], local[4], local[5]}};
}

bool storable(const tetfmt::Ray& ray) {
  const auto finite = [](const tetfmt::Vec3f& v) {
    return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
  };
  return finite(ray.origin) && finite(ray.direction);
}

/// The rays of a block, one by one as the file gives them, with the places where they start.
class BlockRays {
 public:
  BlockRays(const QueryOptions& options, const tetfmt::FileView& view, const RayFile& rays)
      : options_(options), view_(view), rays_(rays) {}

  /// Takes the block's next ray; false if it cannot be answered (the block says why).
  bool take(std::size_t i, Block& block) {
    const GivenRay given = rays_[i];
    const tetfmt::Ray ray = local_ray(given, view_.header().origin, options_.model_space, block.remarks);
    block.unstorable = !storable(ray);
    if (block.unstorable) return false;
    if (ray.direction == tetfmt::Vec3f{}) block.remarks.directionless.add(i);
    if (given.interval.t_max < std::max(given.interval.t_min, 0.0)) block.remarks.empty.add(i);
    if (located_ != ray.origin) {
      location = tetfmt::locate(view_, ray.origin, near_ ? &*near_ : nullptr);
      located_ = ray.origin;
      ++places;
      if (location.state == tetfmt::Location::State::inside) near_ = location.cell;
    }
    direction = ray.direction;
    interval = given.interval;
    block.corrupt = location.state == tetfmt::Location::State::corrupt;
    return !block.corrupt;
  }

  // Of the ray taken last.
  tetfmt::Location location;
  std::size_t places = 0;  ///< how many there were, up to this one
  tetfmt::Vec3f direction;
  tetfmt::Interval interval;

 private:
  const QueryOptions& options_;
  const tetfmt::FileView& view_;
  const RayFile& rays_;
  std::optional<tetfmt::Cell> near_;
  std::optional<tetfmt::Vec3f> located_;
};

/// Notes how the ray `next` was answered, and goes on to the one after; false if it was not.
bool answered(Block& block, Answered how) {
  block.corrupt = how == Answered::corrupt;
  if (block.corrupt) return false;
  if (how == Answered::absent) block.remarks.absent.add(block.next);
  if (how == Answered::lost) block.remarks.lost.add(block.next);
  ++block.next;
  return true;
}

/// Answers rays of the block until it is done or full, or until something is wrong with one.
void answer_one_by_one(const QueryOptions& options, const tetfmt::FileView& view, const RayFile& rays,
                       Block& block) {
  BlockRays ray(options, view, rays);
  while (block.next < block.end && block.rows.bytes().size() < kBlockBytes && ray.take(block.next, block)) {
    const Asked asked{view,          ray.location, static_cast<std::int64_t>(block.next),
                      ray.direction, ray.interval, options.kernel};
    if (!answered(block, answer_ray(options.answer, asked, block.rows))) return;
  }
}

/// The same for answers of one row, by exact signs: all rays of the block together.
template <class Reply>
void answer_together(const QueryOptions& options, const tetfmt::FileView& view, const RayFile& rays,
                     Block& block,
                     void (*ask)(const tetfmt::FileView&, std::span<const tetfmt::Location>,
                                 std::span<const tetfmt::BatchRay>, std::span<Reply>)) {
  std::vector<tetfmt::Location> places;
  std::vector<tetfmt::BatchRay> batch;
  BlockRays ray(options, view, rays);
  while (block.next + batch.size() < block.end && ray.take(block.next + batch.size(), block)) {
    if (places.size() < ray.places) places.push_back(ray.location);
    batch.push_back({static_cast<std::uint32_t>(places.size() - 1), ray.direction, ray.interval});
  }
  std::vector<Reply> answers(batch.size());
  ask(view, places, batch, answers);
  const bool unstorable = std::exchange(block.unstorable, false), corrupt = block.corrupt;
  for (const Reply& answer : answers)
    if (!answered(block, add_row(answer, block.rows))) return;  // of two rays, the first one counts
  block.unstorable = unstorable;
  block.corrupt = corrupt;
}

void answer_block(const QueryOptions& options, const tetfmt::FileView& view, const RayFile& rays,
                  Block& block) {
  const bool together = options.kernel == tetfmt::Kernel::exact;
  if (together && options.answer == Answer::first)
    answer_together<tetfmt::Hit>(options, view, rays, block, tetfmt::trace_batch);
  else if (together && options.answer == Answer::any)
    answer_together<tetfmt::Outcome>(options, view, rays, block, tetfmt::occlude_batch);
  else
    answer_one_by_one(options, view, rays, block);
}

/// All blocks, several at a time; written in their order.
Remarks answer_all(const QueryOptions& options, const tetfmt::FileView& view, const RayFile& rays,
                   AnswerFile& out, Progress& progress) {
  Remarks remarks;
  const auto write = [&](const Block& block) {
    if (block.unstorable) {
      throw Failure(ExitCode::invalid,
                    rays.place(block.next) + ": too large for float32 once the file's origin is subtracted");
    }
    if (block.corrupt) {
      throw Failure(ExitCode::invalid,
                    options.file + ": the ray at " + rays.place(block.next) +
                        " ran into bytes that are no mesh; run `tet validate` on the file");
    }
    out.write(block.rows);
    remarks.add(block.remarks);
    progress.fraction(static_cast<double>(block.next) / static_cast<double>(rays.size()));
  };
  const auto started = [&](std::size_t begin, std::size_t end) {
    Block block;
    block.next = begin;
    block.end = end;
    block.rows = out.rows();
    return block;
  };
  std::size_t begin = 0;
  const auto take = [&](tbb::flow_control& flow) {
    if (begin == rays.size()) flow.stop();
    const std::size_t end = std::min(begin + kBlock, rays.size());
    return started(std::exchange(begin, end), end);
  };
  const auto answer = [&](Block block) {
    answer_block(options, view, rays, block);
    return block;
  };
  const auto finish = [&](Block block) {
    write(block);
    while (block.next < block.end) {
      block = answer(started(block.next, block.end));
      write(block);
    }
  };
  using tbb::filter_mode;
  tbb::parallel_pipeline(kBlocksPerThread * static_cast<std::size_t>(tbb::this_task_arena::max_concurrency()),
                         tbb::make_filter<void, Block>(filter_mode::serial_in_order, take) &
                             tbb::make_filter<Block, Block>(filter_mode::parallel, answer) &
                             tbb::make_filter<Block, void>(filter_mode::serial_in_order, finish));
  return remarks;
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
  if (options.answer != Answer::first && options.kernel != tetfmt::Kernel::exact)
    throw Failure(ExitCode::usage, "--kernel float answers `--answer first` only; leave one of them out");
  refuse_same_file(options.file, options.hits);
  refuse_same_file(options.rays, options.hits);
  const TetFile file(options.file);
  if (options.answer == Answer::paths && file.view().regions().empty()) {
    throw Failure(ExitCode::invalid, options.file + ": does not list its regions (section REGN), which " +
                                         "`--answer paths` needs; make it by `tet convert`");
  }
  const RayFile rays(options.rays);
  const bool counted = one_row_a_ray(options.answer);
  AnswerFile out(options.hits, columns_of(options.answer),
                 counted ? std::optional<std::uint64_t>(rays.size()) : std::nullopt);

  TerminalProgress progress(options.hits != "-");
  progress.stage("query");
  Remarks remarks;
  with_threads(options.threads, [&] { remarks = answer_all(options, file.view(), rays, out, progress); });
  out.commit();
  const std::string rays_name = options.rays == "-" ? "standard input" : options.rays;
  const auto& [rounded, directionless, empty, lost, absent] = remarks;
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
  if (empty.count > 0) {
    warn(rays_text(empty) + " of " + rays_name + (empty.count == 1 ? " has" : " have") +
         " t_max below t_min or 0 and " + (empty.count == 1 ? "hits" : "hit") + " nothing, first ray " +
         std::to_string(empty.first));
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
  CLI::App* verb = app.add_subcommand("query", "Answer rays: what of the input surface each one meets.");
  verb->add_option("FILE", options->file, "A tet file")->required();
  verb->add_option("--rays", options->rays,
                   "Origins and directions. NAME.npy: an array of shape (n, 6), float32 or float64. "
                   "NAME.csv: six columns\n"
                   "ox,oy,oz,dx,dy,dz, a header line and # comments allowed. -: CSV on standard input. With "
                   "two columns\n"
                   "more, t_min and t_max (which may be inf), only what lies between counts")
      ->required()
      ->type_name("RAYS");
  verb->add_option("--hits", options->hits,
                   "Where the answers go, in the order of the rays. NAME.npy: a structured array. NAME.csv: "
                   "a header line\n"
                   "and a line a row. -: CSV on standard output")
      ->required()
      ->type_name("HITS");
  add_choice<Answer>(
      *verb, "--answer", options->answer,
      {{"first", Answer::first}, {"any", Answer::any}, {"all", Answer::all}, {"paths", Answer::paths}},
      "first: the first triangle that each ray meets, a row a ray. any: whether there is one. "
      "all: every\n"
      "triangle, in order. paths: the length of each ray in every region [first]")
      ->type_name("ANSWER");
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
      "Fields of `--answer first`:\n"
      "  triangle  int32    number of the input triangle, in input order from 0; -1: a miss; -2: the ray "
      "starts in space\n"
      "                     that the file leaves out (tet convert --keep), so that nothing is known of it\n"
      "  t         float64  where: origin + t * direction, in units of the given direction; inf for a miss, "
      "nan with -2\n"
      "  u, v      float64  barycentric weights of the triangle's 2nd and 3rd corner\n"
      "  side      int32    0: met from the front, where (b - a) x (c - a) points; 1: from the back; -1: no "
      "hit\n"
      "  tet       int32    the tetrahedron that the ray came through; -1: no hit\n"
      "  neighbor  int32    the tetrahedron beyond the triangle; -1: no hit, or the file leaves out what is "
      "there\n"
      "Of `--answer any`:\n"
      "  blocked   int32    1: the ray meets something; 0: nothing; -2: as above\n"
      "Of `--answer all`, a row a crossing and none for a miss: the fields of `first` between\n"
      "  ray, hit  int64, int32  number of the ray, and of the crossing on it, both from 0\n"
      "and\n"
      "  region    int32    the region that the ray came through (tet info lists them; 0: around "
      "everything);\n"
      "                     -1: the file does not tell\n"
      "  beyond    int32    the region beyond; -1: likewise, or the file leaves it out\n"
      "  length    float64  in model units, from here to the next crossing or to t_max; inf: there is no "
      "end; nan: the\n"
      "                     ray is lost in space that the file leaves out\n"
      "Of `--answer paths`, a row for each region in which a ray has any length, in the regions' order:\n"
      "  ray       int64    number of the ray\n"
      "  region    int32    as above; -1, with length nan: space that the file leaves out, where the path "
      "ends\n"
      "  length    float64  in model units, of all stretches together; inf in region 0 where nothing ends "
      "the ray\n"
      "Only surfaces that close a space off make regions: crossing an open one changes nothing. Materials "
      "belong to\n"
      "surfaces; which region is of what is for you to say.\n"
      "\n"
      "Directions need not be of unit length. A direction that is zero in float32 hits nothing, with a "
      "warning that\n"
      "counts rays from 0; so does one whose t_max lies below t_min or 0. A t_min below 0 counts as 0. Rays "
      "from left-out space are told "
      "likewise.\n"
      "Numbers that are not finite are errors, but for t_max = inf. Where t_min or t_max lies exactly on a "
      "triangle, the\n"
      "triangle is in one of the intervals that end and begin there, never in both.\n"
      "\n"
      "Of FILE only the structure is checked, which takes no time; bytes that were damaged later can give "
      "wrong\n"
      "answers. `tet validate FILE` proves it, or `tet validate --level checksum FILE` that nothing was "
      "damaged.\n"
      "\n"
      "Exit codes: 0 done; 1 usage; 2 a file cannot be read or written; 3 malformed rays or a broken tet "
      "file;\n"
      "5 a kind of file that this version does not know. On failure nothing is left at HITS.\n"
      "\n"
      "Examples:\n"
      "  tet query bunny.tet --rays rays.npy --hits hits.npy\n"
      "  echo 0,0,10,0,0,-1 | tet query bunny.tet --rays - --hits -\n"
      "  echo 0,0,10,0,0,-1,0,9.5 | tet query bunny.tet --rays - --hits - --answer any\n"
      "  tet query engine.tet --rays xrays.npy --hits thickness.npy --answer paths\n"
      "  python3 -c \"import numpy; print(numpy.load('hits.npy')['triangle'])\"");
  verb->callback([options, &run] { run = [options] { return run_query(*options); }; });
}

}  // namespace tetprep
