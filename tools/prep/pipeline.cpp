// SPDX-License-Identifier: AGPL-3.0-or-later
#include "prep/pipeline.hpp"

#include <tbb/global_control.h>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <optional>
#include <thread>

#include "common/atomic_file.hpp"
#include "common/same_file.hpp"
#include "prep/describe.hpp"
#include "tetfmt/encode.hpp"
#include "tetfmt/validate.hpp"
#include "tetfmt/view.hpp"

namespace tetprep {
namespace {

void refuse_same_files(const ConvertOptions& options) {
  refuse_same_file(options.inputs.front(), options.output);
  if (options.report.empty()) return;
  if (same_file(options.inputs.front(), options.report))
    throw Failure(ExitCode::usage,
                  options.report + ": is the input itself; name another file for the report");
  if (same_file(options.output, options.report))
    throw Failure(ExitCode::usage,
                  options.report + ": is the output itself; name another file for the report");
}

std::size_t points_used(const TriangleSoup& soup) {
  std::vector<bool> used(soup.points.size(), false);
  for (const auto& triangle : soup.triangles)
    for (const Index corner : triangle) used[corner] = true;
  return static_cast<std::size_t>(std::count(used.begin(), used.end(), true));
}

CleanSurface read_and_snap(const ConvertOptions& options, StageLog& log, ConvertReport& report) {
  log.begin("read");
  const TriangleSoup soup = read_soup(options.inputs.front());
  log.begin("snap");
  report.input_points = points_used(soup);
  try {
    return snap(soup);
  } catch (const Failure& failure) {
    throw Failure(failure.code(), options.inputs.front() + ": " + failure.what());
  }
}

TetMesh tetrahedralize_input(const ConvertOptions& options, unsigned threads, CleanSurface& surface,
                             Progress& progress, StageLog& log, ConvertReport& report) {
  // TetGen is one of the threads.
  const TetrahedralizeOptions how{options.radius_edge, options.time_limit, options.memory_limit,
                                  std::max(2u, threads) - 1};
  try {
    return tetrahedralize(surface, how, progress, log, report.tetrahedralize);
  } catch (const Intersecting& intersecting) {
    throw Failure(ExitCode::invalid,
                  options.inputs.front() + ": " + describe_intersections(surface, intersecting.pairs));
  } catch (const Failure& failure) {
    throw Failure(failure.code(), options.inputs.front() + ": " + failure.what());
  }
}

/// The proof that what we made is what we claim. Returns the number of hull faces.
void prove(const std::vector<std::byte>& bytes) {
  const tetfmt::Report issues = tetfmt::validate(bytes, tetfmt::Level::geometry);
  if (!issues.valid())
    throw Failure(ExitCode::runtime, "the result failed its own validation, and was thrown away: " +
                                         tetfmt::to_string(issues.issues.begin()->second.examples.front()));
}

void fill_in(const CleanSurface& surface, const tetfmt::Mesh& mesh, ConvertReport& report) {
  report.input_triangles = surface.input_triangle_count;
  report.merged_points = surface.merged_points;
  report.degenerate_triangles = surface.degenerate_triangles;
  report.duplicate_triangles = surface.duplicate_triangles;
  report.surface_points = surface.points.size();
  report.surface_triangles = surface.triangles.size();
  report.origin = surface.origin;
  report.grid_exponent = surface.grid_exponent;
  report.max_deviation = surface.max_deviation;
  report.vertices = mesh.vertices.size();
  report.tets = mesh.tets.size();
  report.sides = mesh.sides.size();
}

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

ConvertReport convert(const ConvertOptions& options, Progress& progress) {
  const auto started = std::chrono::steady_clock::now();
  const unsigned threads =
      options.threads > 0 ? options.threads : std::max(1u, std::thread::hardware_concurrency());
  const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
  StageLog log(progress);
  ConvertReport report;

  // Before the long work: an output that cannot be written should not be its last discovery.
  refuse_same_files(options);
  AtomicFile output(options.output);
  std::optional<AtomicFile> report_file;
  if (!options.report.empty()) report_file.emplace(options.report);

  const auto write_report = [&](const std::string& error) {
    if (!report_file) return;
    report_file->write(to_json(options, report, error));
    report_file->commit();
  };

  CleanSurface surface = read_and_snap(options, log, report);
  std::vector<std::byte> bytes;
  {
    tetfmt::Mesh mesh;
    {
      TetMesh tets;
      try {
        tets = tetrahedralize_input(options, threads, surface, progress, log, report);
      } catch (const Failure& failure) {
        if (report.tetrahedralize.intersection_count > 0) {
          fill_in(surface, mesh, report);
          try {
            write_report(failure.what());
          } catch (const Failure&) {  // the surface is what the user has to hear about
          }
        }
        throw;
      }
      log.begin("sort");
      sort_tets(tets);
      if (options.optimize != Optimize::none) {
        log.begin("reduce crossings");
        report.crossings = reduce_crossings(tets, options.optimize, progress);
      }
      log.begin("order");
      mesh = order(tets, surface);
    }
    fill_in(surface, mesh, report);
    log.begin("encode");
    bytes = tetfmt::encode(mesh, options.layout);
  }
  log.begin("validate");
  prove(bytes);
  log.begin("write");
  output.write(bytes);
  log.end();

  report.hull_faces = reinterpret_cast<const tetfmt::FileHeader*>(bytes.data())->hull_count;
  report.output_bytes = bytes.size();
  report.stages = log.costs();
  report.peak_memory_mb = total_peak(report.stages);
  report.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - started).count();
  // The report first: if it cannot be written, the output must not stay either.
  write_report({});
  output.commit();
  return report;
}

}  // namespace tetprep
