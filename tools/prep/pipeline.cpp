// SPDX-License-Identifier: AGPL-3.0-or-later
// The converter from end to end, top down: convert() at the bottom calls the stages in order.
#include "prep/pipeline.hpp"

#include <tbb/global_control.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <new>
#include <optional>
#include <thread>

#include "common/atomic_file.hpp"
#include "common/parse.hpp"
#include "common/same_file.hpp"
#include "prep/box.hpp"
#include "prep/debug_mesh.hpp"
#include "prep/describe.hpp"
#include "prep/regions.hpp"
#include "tetfmt/encode.hpp"
#include "tetfmt/validate.hpp"
#include "tetfmt/view.hpp"

namespace tetprep {
namespace {

/// The second try, if TetGen finds nothing for the surface as it is: features smaller than extent / 2^17,
/// which are what it fails at, are then gone.
constexpr int kCoarserBits = 4;
/// resolve() leaves nothing that intersects; more rounds than one are for its errors, not for inputs.
constexpr int kMostResolutions = 3;

void refuse_same_files(const ConvertOptions& options) {
  const std::pair<const std::string*, const char*> outputs[] = {{&options.output, "the output"},
                                                                {&options.report, "the report"},
                                                                {&options.debug_mesh, "the debug mesh"}};
  for (std::size_t i = 0; i < std::size(outputs); ++i) {
    const auto& [path, what] = outputs[i];
    if (path->empty()) continue;
    for (const std::string& input : options.inputs)
      if (same_file(input, *path))
        throw Failure(ExitCode::usage, *path + ": is an input; name another file for " + what);
    for (std::size_t j = 0; j < i; ++j)
      if (same_file(*outputs[j].first, *path))
        throw Failure(ExitCode::usage,
                      *path + ": is " + outputs[j].second + " already; name another file for " + what);
  }
}

/// What the optional sections say of the mesh, in bytes.
std::uint64_t bytes_in(const std::vector<tetfmt::OptionalSection>& sections) {
  std::uint64_t sum = 0;
  for (const auto& section : sections) sum += section.bytes.size();
  return sum;
}

/// The proof that what we made is what we claim.
void prove(const std::vector<std::byte>& bytes) {
  const tetfmt::Report issues = tetfmt::validate(bytes, tetfmt::Level::geometry);
  if (!issues.valid())
    throw Failure(ExitCode::runtime, "the result failed its own validation, and was thrown away: " +
                                         tetfmt::to_string(issues.issues.begin()->second.examples.front()));
}

/// One conversion. Each member function is one step; `report_` learns what it did.
class Conversion {
 public:
  Conversion(const ConvertOptions& options, unsigned threads, Progress& progress, ConvertReport& report)
      : options_(options), threads_(threads), progress_(progress), report_(report), log_(progress) {}
  ~Conversion() {
    log_.end();
    report_.stages = log_.costs();
  }

  /// The file's bytes, proven.
  std::vector<std::byte> make() {
    std::vector<std::byte> bytes;
    {
      tetfmt::Mesh mesh;
      {
        TriangleSoup soup = read();
        CleanSurface surface;
        TetMesh tets = fill(soup, surface);
        soup = {{}, {}, std::move(soup.appearance), {}};
        log_.begin("sort");
        sort_tets(tets);
        if (options_.optimize != Optimize::none) {
          log_.begin("reduce crossings");
          find_regions(tets);  // so that it knows where rays can go
          report_.crossings = reduce_crossings(tets, options_.optimize, progress_);
          sort_tets(tets);
        }
        sort_out_regions(tets, surface);
        log_.begin("order");
        // Sides name materials only where the file holds them.
        const bool materials = options_.attributes == KeepAttributes::all;
        mesh = order(tets, surface, materials ? soup.appearance.triangle_material : std::vector<Index>{});
        add_attributes(soup.appearance, mesh);
      }
      report_.vertices = mesh.vertices.size();
      report_.tets = mesh.tets.size();
      report_.sides = mesh.sides.size();
      log_.begin("encode");
      bytes = tetfmt::encode(mesh, options_.layout);
      if (whole_bytes_ > 0)
        report_.regions.bytes_saved = whole_bytes_ + report_.attributes.bytes - bytes.size();
    }
    log_.begin("validate");
    prove(bytes);
    report_.hull_faces = reinterpret_cast<const tetfmt::FileHeader*>(bytes.data())->hull_count;
    report_.output_bytes = bytes.size();
    return bytes;
  }

  void write(const std::vector<std::byte>& bytes, AtomicFile& output) {
    log_.begin("write");
    output.write(bytes);
  }

 private:
  TriangleSoup read() {
    log_.begin("read");
    std::vector<TriangleSoup> soups;
    for (const std::string& input : options_.inputs) soups.push_back(read_soup(input));
    TriangleSoup soup = soups.size() == 1 ? std::move(soups.front()) : merge_soups(std::move(soups));
    report_.warnings = std::move(soup.warnings);
    std::vector<bool> used(soup.points.size(), false);
    for (const auto& triangle : soup.triangles)
      for (const Index corner : triangle) used[corner] = true;
    report_.input_points = static_cast<std::size_t>(std::count(used.begin(), used.end(), true));
    report_.input_triangles = soup.triangles.size();
    if (options_.simplify > 0) {
      log_.begin("simplify");
      soup = simplify(std::move(soup), options_.simplify, progress_, report_.simplify);
    }
    return soup;
  }

  /// The box around the surface, full of tets. Failures name the input.
  TetMesh fill(const TriangleSoup& soup, CleanSurface& surface) try {
    surface = put_on_grid(soup, 0);
    try {
      return cut_and_tetrahedralize(surface);
    } catch (const NoRoomOnGrid& failure) {
      surface = coarser_after(failure, soup, surface.grid_exponent);
    } catch (const Failure& failure) {
      if (failure.code() != ExitCode::runtime || ran_out()) throw;
      surface = coarser_after(failure, soup, surface.grid_exponent);
    }
    return cut_and_tetrahedralize(surface);
  } catch (const Failure& failure) {
    const std::size_t more = options_.inputs.size() - 1;
    throw Failure(failure.code(), options_.inputs.front() +
                                      (more == 0 ? "" : " and " + std::to_string(more) + " more") + ": " +
                                      failure.what());
  }

  /// Whether TetGen's last attempt ended for want of time or memory, which no grid saves.
  bool ran_out() const {
    const auto& attempts = report_.tetrahedralize.failed_attempts;
    return !attempts.empty() && (attempts.back().reason.starts_with("no end after") ||
                                 attempts.back().reason.find("memory") != std::string::npos);
  }

  CleanSurface put_on_grid(const TriangleSoup& soup, int coarser_bits) {
    log_.begin("snap");
    CleanSurface surface = snap(soup, coarser_bits);
    report_.merged_points = surface.merged_points;
    report_.degenerate_triangles = surface.degenerate_triangles;
    report_.duplicate_triangles = surface.duplicate_triangles;
    report_.origin = surface.origin;
    report_.grid_exponent = surface.grid_exponent;
    report_.coarser_bits = coarser_bits;
    report_.max_deviation = surface.max_deviation;
    return surface;
  }

  /// The surface on a coarser grid, if that makes a difference; else `failure` is the answer.
  CleanSurface coarser_after(const Failure& failure, const TriangleSoup& soup, int grid_exponent) {
    const auto before = report_;
    std::optional<CleanSurface> surface;
    try {
      surface = put_on_grid(soup, kCoarserBits);
    } catch (const Failure&) {  // nothing is left of the surface there
    }
    if (!surface || surface->grid_exponent == grid_exponent || surface->max_deviation == 0) {
      report_ = before;
      throw failure;
    }
    report_.warnings.push_back("the surface was put on a coarser grid, of step " +
                               number(std::ldexp(1.0, surface->grid_exponent)) +
                               " (points moved by at most " + number(surface->max_deviation) +
                               ", model units), because of this: " + failure.what());
    report_.resolve = {};
    report_.tetrahedralize = {};
    return std::move(*surface);
  }

  TetMesh cut_and_tetrahedralize(CleanSurface& surface) {
    // TetGen is one of the threads.
    const TetrahedralizeOptions how{options_.radius_edge, options_.time_limit, options_.memory_limit,
                                    std::max(2u, threads_) - 1};
    for (int resolutions = 0;; ++resolutions) {
      std::vector<TrianglePair> pairs;
      try {
        TetMesh tets = tetrahedralize(surface, how, progress_, log_, report_.tetrahedralize);
        report_.surface_points = surface.points.size();
        report_.surface_triangles = surface.triangles.size();
        report_.grid_exponent = surface.grid_exponent;  // Steiner points may have asked for a finer one
        report_.origin = surface.origin;
        if (report_.tetrahedralize.cut_triangles > 0)
          report_.warnings.push_back(
              std::to_string(report_.tetrahedralize.cut_triangles) +
              " triangles had to be cut because TetGen found no tetrahedra otherwise (new points at most " +
              number(report_.tetrahedralize.cut_deviation) + " away from them, model units)");
        return tets;
      } catch (Intersecting& intersecting) {
        pairs = std::move(intersecting.pairs);
      } catch (const Failure&) {
        try {
          write_debug(surface, report_.tetrahedralize.suspects);
        } catch (const Failure&) {  // the surface is what the user has to hear about
        }
        throw;
      }
      std::vector<Index> meeting;
      for (const auto& [a, b] : pairs) meeting.insert(meeting.end(), {a, b});
      write_debug(surface, std::move(meeting));
      if (resolutions == kMostResolutions)
        throw Failure(ExitCode::runtime, describe_intersections(surface, pairs));
      resolve_once(surface, std::move(pairs));
    }
  }

  void resolve_once(CleanSurface& surface, std::vector<TrianglePair> pairs) {
    log_.begin("resolve");
    ResolveReport& sum = report_.resolve;
    ResolveReport once;
    surface = resolve(std::move(surface), std::move(pairs), threads_, progress_, once);
    log_.end();
    if (once.grid_coarsening > 0)
      report_.warnings.push_back(
          "intersections did not end until points near each other were made one (the surface moved by at "
          "most " +
          number(once.max_deviation) + ", model units)");
    once.intersecting_pairs = std::max(sum.intersecting_pairs, once.intersecting_pairs);
    once.rounds += sum.rounds;
    once.new_points += sum.new_points;
    once.overlaps += sum.overlaps;
    once.grid_coarsening += sum.grid_coarsening;
    once.max_deviation = std::max(sum.max_deviation, once.max_deviation);
    sum = once;
  }

  /// `marked` may hold triangles more than once.
  void write_debug(const CleanSurface& surface, std::vector<Index> marked) {
    if (options_.debug_mesh.empty()) return;
    std::sort(marked.begin(), marked.end());
    marked.erase(std::unique(marked.begin(), marked.end()), marked.end());
    write_debug_mesh(options_.debug_mesh, surface, std::move(marked));
  }

  /// Finds the regions, puts the tets of each together, and leaves out those that are not wanted.
  void sort_out_regions(TetMesh& tets, const CleanSurface& surface) {
    log_.begin("regions");
    const Index count = find_regions(tets);
    group_by_region(tets);
    const std::vector<bool> wanted = wanted_regions(tets, count);
    report_.regions.count = count;
    report_.regions.kept = static_cast<std::size_t>(std::count(wanted.begin(), wanted.end(), true));
    if (report_.regions.kept == count) {
      if (options_.keep != Keep::all)
        report_.warnings.push_back(
            "nothing could be left out: " +
            std::string(count == 1 ? "the surface closes no space off" : "all spaces were asked for"));
      return;
    }
    // Of a file with gaps the validator cannot tell that what is left out was full of tets. So the whole is
    // proven first: its tets fill the box, each face has the one tet on either side that it names, and no two
    // overlap. All of that, less the fullness, is then true of any selection of them, and the validator sees
    // to it once more that the selection is a sound file.
    log_.begin("prove whole");
    const std::vector<std::byte> whole = tetfmt::encode(order(tets, surface, {}), options_.layout);
    prove(whole);
    log_.begin("leave out");
    const std::size_t before = tets.tets.size();
    keep_regions(tets, wanted);
    report_.regions.tets_left_out = before - tets.tets.size();
    whole_bytes_ = whole.size();
  }

  std::vector<bool> wanted_regions(const TetMesh& tets, Index count) const {
    std::vector<bool> wanted(count, options_.keep == Keep::all);
    if (options_.keep == Keep::outside) wanted[0] = true;
    if (options_.keep == Keep::reachable_from) {
      for (const Point& point : options_.reachable_from) {
        const Index region = region_at(tets, point);
        if (region == kNone) fail_outside(tets, point);
        wanted[region] = true;
      }
    }
    return wanted;
  }

  [[noreturn]] static void fail_outside(const TetMesh& tets, const Point& point) {
    const auto text = [](const Point& p) { return number(p[0]) + "," + number(p[1]) + "," + number(p[2]); };
    GridPoint low = tets.points.front(), high = low;
    for (const GridPoint& p : tets.points) {
      for (std::size_t k = 0; k < 3; ++k) {
        low[k] = std::min(low[k], p[k]);
        high[k] = std::max(high[k], p[k]);
      }
    }
    const double step = std::ldexp(1.0, tets.grid_exponent);
    const auto model = [&](const GridPoint& p) {
      Point point_of{};
      for (std::size_t k = 0; k < 3; ++k) point_of[k] = tets.origin[k] + p[k] * step;
      return point_of;
    };
    throw Failure(ExitCode::usage, "--keep reachable-from " + text(point) +
                                       ": lies outside of the box around the surface, from " +
                                       text(model(low)) + " to " + text(model(high)) +
                                       "; rays from there reach what --keep outside keeps");
  }

  void add_attributes(const Appearance& appearance, tetfmt::Mesh& mesh) {
    AttributeReport& report = report_.attributes;
    report.materials = appearance.materials.size();
    report.objects = appearance.objects.size();
    report.surface_points = appearance.surface_points;
    report.properties = appearance.properties.size();
    report.normals = !appearance.normals.empty();
    report.texcoords = !appearance.texcoords.empty();
    report.colors = !appearance.colors.empty();
    auto sections = to_sections(appearance, options_.attributes, options_.draco);
    report.bytes = bytes_in(sections);
    if (options_.attributes != KeepAttributes::all || options_.draco)
      report.bytes_saved = static_cast<std::int64_t>(bytes_in(to_sections(appearance, KeepAttributes::all))) -
                           static_cast<std::int64_t>(report.bytes);
    for (auto& section : sections) {
      report.sections.emplace_back(reinterpret_cast<const char*>(&section.kind), sizeof section.kind);
      mesh.optional.push_back(std::move(section));
    }
  }

  const ConvertOptions& options_;
  const unsigned threads_;
  Progress& progress_;
  ConvertReport& report_;
  StageLog log_;
  std::uint64_t whole_bytes_ = 0;  ///< of the file with all regions and no attributes; 0: none was made
};

/// This process's worst stage, and TetGen's worst beside what this process holds meanwhile.
double total_peak(const std::vector<StageCost>& stages) {
  double own = 0, waiting = 0, tetgen = 0;
  for (const StageCost& stage : stages) {
    if (stage.name.starts_with("tetgen: ")) {
      tetgen = std::max(tetgen, stage.peak_memory_mb);
    } else {
      own = std::max(own, stage.peak_memory_mb);
      if (stage.name == "tetrahedralize") waiting = std::max(waiting, stage.peak_memory_mb);
    }
  }
  return std::max(own, waiting + tetgen);
}

}  // namespace

void convert(const ConvertOptions& options, Progress& progress, ConvertReport& report) {
  const auto started = std::chrono::steady_clock::now();
  const unsigned threads =
      options.threads > 0 ? options.threads : std::max(1u, std::thread::hardware_concurrency());
  const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);

  // Before the long work: an output that cannot be written should not be its last discovery.
  refuse_same_files(options);
  AtomicFile output(options.output);
  std::optional<AtomicFile> report_file;
  if (!options.report.empty()) report_file.emplace(options.report);
  const auto finish_report = [&](const Failure* failure) {
    report.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - started).count();
    report.peak_memory_mb = total_peak(report.stages);
    if (!report_file) return;
    report_file->write(to_json(options, report, failure));
    report_file->commit();
  };

  const auto give_up = [&](const Failure& failure) {
    try {
      finish_report(&failure);
    } catch (const Failure&) {  // the first failure is what the user has to hear about
    }
    throw failure;
  };
  try {
    Conversion conversion(options, threads, progress, report);
    conversion.write(conversion.make(), output);
  } catch (const Failure& failure) {
    give_up(failure);
  } catch (const std::bad_alloc&) {
    give_up({ExitCode::runtime, options.inputs.front() + ": out of memory; try a smaller input, --simplify, "
                                                         "or a larger machine"});
  }
  // The report first: if it cannot be written, the output must not stay either.
  finish_report(nullptr);
  output.commit();
}

}  // namespace tetprep
