// SPDX-License-Identifier: AGPL-3.0-or-later
// tet convert: surface meshes become a tet file; with --batch, many of them.
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <iterator>
#include <memory>
#include <optional>
#include <sstream>

#include "common/atomic_file.hpp"
#include "common/output.hpp"
#include "common/parse.hpp"
#include "common/same_file.hpp"
#include "common/terminal_progress.hpp"
#include "prep/batch.hpp"
#include "prep/pipeline.hpp"
#include "tet/command.hpp"

namespace tetprep {
namespace {

constexpr const char* kFooter =
    "Triangles and polygons, open or closed, connected or not. Where the surface meets itself it is cut, "
    "exactly, and\nevery piece keeps its input triangle's number. Coordinates are put on a power-of-two grid "
    "of about 2^21 steps over\nthe extent; those that lie on such a grid already keep every bit. The output "
    "appears only when it is complete and\nhas passed `tet validate --level geometry`.\n\nBatch: LIST has a "
    "conversion a line, its fields separated by tabs: an input alone (its output is NAME.tet beside it,\nor "
    "in the folder that -o names), or one input or more and then the output. Empty lines and lines that "
    "begin with #\ndo not count. Each conversion is a process of its own, and a failure does not end the "
    "others. At the end standard\noutput gets a line a conversion, fields separated by tabs: file, "
    "triangles, outcome, seconds, memory, tets, and the\noutput's name or the error. Outcomes: ok, ok (cut), "
    "usage, io, invalid, runtime, unsupported.\n\nExit codes: 0 done; 1 usage; 2 a file cannot be read or "
    "written; 3 an input's contents are wrong, or hold no surface;\n4 out of time or memory, or no "
    "tetrahedra were found; 5 an unknown kind of file, or beyond what the format holds.\nOf a batch: 0 if "
    "all went well, else the code of the first conversion in the list that failed.\n\nExamples:\n  tet "
    "convert bunny.ply -o bunny.tet\n  tet convert house.obj car.glb -o scene.tet --keep outside --report "
    "scene.json\n  tet convert room.glb -o room.tet --keep reachable-from 0,1.5,0\n  find models -name "
    "'*.obj' | tet convert --batch - -o tets -j 4 > table.tsv";

struct Settings {
  ConvertOptions options;
  std::string batch;
  unsigned at_once = 1;
  bool quiet = false, verbose = false;
};

template <class... Values>
std::string text(const char* format, Values... values) {
  char line[512];
  std::snprintf(line, sizeof line, format, values...);
  return line;
}

void print(const std::string& line) {
  std::cerr << one_line(line) << '\n';
}

double megabytes(std::uint64_t bytes) {
  return static_cast<double>(bytes) * 1e-6;
}

void print_warnings(const std::vector<std::string>& warnings) {
  constexpr std::size_t kMost = 20;
  for (std::size_t i = 0; i < std::min(kMost, warnings.size()); ++i) print("warning: " + warnings[i]);
  if (warnings.size() > kMost)
    print("... and " + std::to_string(warnings.size() - kMost) + " warnings more (--report lists them)");
}

/// What each option that leaves something out has saved.
void print_savings(const ConvertOptions& options, const ConvertReport& report) {
  if (options.simplify > 0)
    print(text("simplified: %zu triangles to %zu (%zu left as they were, not manifold), at most %g away",
               report.simplify.triangles_before, report.simplify.triangles_after,
               report.simplify.skipped_triangles, report.simplify.max_deviation));
  if (const RegionReport& regions = report.regions; regions.tets_left_out > 0) {
    const std::size_t whole = regions.tets_left_out + report.tets;
    print(text("left out: %zu of %zu spaces, %zu tets (%.1f %%), %.2f MB", regions.count - regions.kept,
               regions.count, regions.tets_left_out,
               100.0 * static_cast<double>(regions.tets_left_out) / static_cast<double>(whole),
               megabytes(regions.bytes_saved)));
  }
  if (const std::int64_t saved = report.attributes.bytes_saved; saved != 0)
    print(text("attributes: %.2f MB, %.2f MB %s than all of them plain", megabytes(report.attributes.bytes),
               std::abs(static_cast<double>(saved)) * 1e-6, saved > 0 ? "less" : "more"));
}

void print_details(const ConvertOptions& options, const ConvertReport& report) {
  print(text("grid 2^%d, points moved by at most %g, %zu equal points merged", report.grid_exponent,
             report.max_deviation, report.merged_points));
  print(text("TetGen -%s, %u points of its own, %u of them moved", report.tetrahedralize.switches.c_str(),
             report.tetrahedralize.steiner_points, report.tetrahedralize.moved_steiner_points));
  if (options.optimize != Optimize::none)
    print(text(
        "%u sets of tets replaced, %u points added, %u dropped: area between tets from %.2f to %.2f times "
        "the box's surface",
        report.crossings.replacements, report.crossings.new_points, report.crossings.dropped_points,
        report.crossings.area_before, report.crossings.area_after));
  std::string sections;
  for (const std::string& kind : report.attributes.sections) sections += " " + kind;
  print(text("%zu regions; %zu materials, %zu objects, %zu surface points; sections:%s", report.regions.count,
             report.attributes.materials, report.attributes.objects, report.attributes.surface_points,
             sections.empty() ? " none" : sections.c_str()));
  for (const StageCost& stage : report.stages)
    print(text("%8.3f s %8.1f MB  %s", stage.seconds, stage.peak_memory_mb, stage.name.c_str()));
  print(text("%8.3f s %8.1f MB  in all", report.seconds, report.peak_memory_mb));
}

void print_summary(const Settings& settings, const ConvertReport& report) {
  print_warnings(report.warnings);
  print(settings.options.output + ": " +
        text("%zu triangles, %zu tets, %.2f MB (%.1f bytes a tet), %.2f s of which TetGen %.2f s",
             report.input_triangles, report.tets, megabytes(report.output_bytes),
             static_cast<double>(report.output_bytes) / static_cast<double>(report.tets), report.seconds,
             report.tetrahedralize.tetgen_seconds));
  if (report.degenerate_triangles + report.duplicate_triangles > 0)
    print(text("dropped: %zu triangles without an area, %zu that repeat another", report.degenerate_triangles,
               report.duplicate_triangles));
  if (const ResolveReport& cut = report.resolve; cut.intersecting_pairs > 0)
    print(
        text("cut: %zu pairs of triangles met; %zu triangles are in %zu pieces now, %zu overlaps dropped, "
             "new points at most %g from their exact places",
             cut.intersecting_pairs, cut.cut_triangles, cut.pieces, cut.overlaps, cut.max_deviation));
  if (const std::string note = fallback_note(report.tetrahedralize); !note.empty()) print(note);
  print_savings(settings.options, report);
  if (settings.verbose) print_details(settings.options, report);
}

int convert_one(const Settings& settings) {
  ConvertReport report;
  {
    TerminalProgress progress(!settings.quiet, settings.verbose);
    convert(settings.options, progress, report);
  }
  if (!settings.quiet) print_summary(settings, report);
  return static_cast<int>(ExitCode::ok);
}

/// The whole of a file, or of standard input for "-".
std::string read_list(const std::string& path) {
  std::ifstream file;
  if (path != "-") {
    std::error_code error;
    if (std::filesystem::is_directory(path, error)) throw Failure(ExitCode::io, path + ": is a folder");
    file.open(path, std::ios::binary);
  }
  std::istream& in = path == "-" ? std::cin : file;
  std::string contents{std::istreambuf_iterator<char>(in), {}};
  if (in.bad() || (path != "-" && !file.is_open()))
    throw Failure(ExitCode::io, path + ": cannot be read; check the path and its permissions");
  return contents;
}

int convert_batch(const Settings& settings) {
  const ConvertOptions& options = settings.options;
  const std::string list = settings.batch == "-" ? "standard input" : settings.batch;
  if (!options.output.empty() && !std::filesystem::is_directory(options.output))
    throw Failure(ExitCode::io, options.output + ": no such folder; create it first");
  const std::vector<Job> jobs = parse_jobs(read_list(settings.batch), list, options.output);
  for (const Job& job : jobs) {
    if (same_file(job.output, settings.batch))
      throw Failure(ExitCode::usage, settings.batch + ": is the list itself, and line " +
                                         std::to_string(job.line) + " would write it");
    for (const std::string& file : job.inputs)
      if (same_file(file, options.report))
        throw Failure(ExitCode::usage, options.report + ": is an input; name another file for the report");
    if (same_file(job.output, options.report))
      throw Failure(ExitCode::usage, options.report + ": is an output; name another file for the report");
  }
  std::optional<AtomicFile> report;
  if (!options.report.empty()) report.emplace(options.report);

  std::vector<JobResult> results;
  {
    TerminalProgress progress(!settings.quiet, settings.verbose);
    results =
        run_jobs(jobs, options, settings.at_once, progress, [&](const Job& job, const JobResult& result) {
          if (!result.error.empty()) {
            progress.print_line("tet convert: " + one_line(result.error));
          } else if (settings.verbose) {
            progress.print_line(one_line(job.output) + ": " + result.outcome);
          }
        });
  }
  if (report) {
    report->write(to_json(jobs, results));
    report->commit();
  }
  Output::standard().write(to_table(jobs, results));
  for (const JobResult& result : results)
    if (result.code != ExitCode::ok) return static_cast<int>(result.code);
  return static_cast<int>(ExitCode::ok);
}

/// Turns the words after --keep into options. CLI11 takes two words where it may take two, so the second may
/// be an input: unless the first is reachable-from, it is given its place among the inputs.
void sort_out_keep(const CLI::App& command, const CLI::Option* inputs, const CLI::Option* keep,
                   ConvertOptions& options) {
  options.inputs.clear();
  auto input = inputs->results().begin();
  auto word = keep->results().begin();
  bool chosen = false, point_follows = false, more_may_follow = false;
  for (const CLI::Option* option : command.parse_order()) {
    if (option == inputs) {
      options.inputs.push_back(*input++);
    } else if (option == keep) {
      const std::string text = *word++;
      if (point_follows) {
        const auto point = parse_vector(text);
        if (!point)
          throw CLI::ValidationError("--keep", "expected X,Y,Z after reachable-from, found '" + text + "'");
        options.reachable_from.push_back(*point);
        point_follows = false;
        continue;
      }
      const bool known = text == "all" || text == "outside" || text == "reachable-from";
      if (!known && more_may_follow) {
        options.inputs.push_back(text);
        more_may_follow = false;
        continue;
      }
      if (!known)
        throw CLI::ValidationError("--keep", "must be all, outside or reachable-from X,Y,Z, not " + text);
      point_follows = text == "reachable-from";
      if (chosen && !(point_follows && options.keep == Keep::reachable_from))
        throw CLI::ValidationError("--keep", "can be given once, or several times with reachable-from");
      chosen = true;
      more_may_follow = !point_follows;
      options.keep = point_follows ? Keep::reachable_from : text == "outside" ? Keep::outside : Keep::all;
    }
  }
  if (point_follows) throw CLI::ValidationError("--keep", "reachable-from needs a point X,Y,Z after it");
}

void check_what_was_given(const Settings& settings) {
  const ConvertOptions& options = settings.options;
  if (settings.batch.empty()) {
    if (options.inputs.empty()) throw CLI::RequiredError("INPUT (or --batch LIST)");
    if (options.output.empty()) throw CLI::RequiredError("--output");
    return;
  }
  if (!options.inputs.empty())
    throw CLI::ValidationError(
        "--batch", "takes its inputs from the list, not from the command line: " + options.inputs.front());
  if (!options.debug_mesh.empty())
    throw CLI::ValidationError("--debug-mesh", "is for one conversion, not for --batch");
}

CLI::Option* add_number(CLI::App& app, const std::string& name, double& value, const std::string& what,
                        const std::string& description) {
  return app.add_option_function<std::string>(
      name,
      [&value, name, what](const std::string& text) {
        const auto number = parse_double(text);
        if (!number || !std::isfinite(*number) || *number <= 0)
          throw CLI::ValidationError(name, "must be a positive " + what + ", not " + text);
        value = *number;
      },
      description);
}

/// "512M", "4G", "1.5GiB", "100000000": in powers of 1024.
std::optional<std::uint64_t> parse_bytes(std::string text) {
  for (char& c : text) c = static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
  for (const char* unit : {"IB", "B"})
    if (text.ends_with(unit)) {
      text.resize(text.size() - std::string(unit).size());
      break;
    }
  double factor = 1;
  if (const auto power = text.empty() ? std::string::npos : std::string("KMGT").find(text.back());
      power != std::string::npos) {
    factor = std::ldexp(1.0, 10 * (static_cast<int>(power) + 1));
    text.pop_back();
  }
  const auto number = parse_double(text);
  if (!number || !(*number > 0) || !(*number * factor < 0x1p63)) return std::nullopt;
  return static_cast<std::uint64_t>(*number * factor);
}

void add_files(CLI::App& command, Settings& settings) {
  ConvertOptions& options = settings.options;
  command
      .add_option("-o,--output", options.output,
                  "Tet file to write; with --batch, the folder for outputs that the list does not name")
      ->type_name("OUT.tet");
  command
      .add_option("--report", options.report,
                  "Write what was done as JSON: counts, times and memory by stage, deviations, warnings")
      ->type_name("FILE.json");
  command
      .add_option("--debug-mesh", options.debug_mesh,
                  "Where triangles intersect, or no tetrahedra are found, write the surface as PLY with\nthe "
                  "triangles in question coloured red")
      ->type_name("FILE.ply");
}

void add_contents(CLI::App& command, Settings& settings) {
  ConvertOptions& options = settings.options;
  const std::string group = "What goes into the file";
  add_choice<tetfmt::Layout>(command, "--layout", options.layout,
                             {{"tet20", tetfmt::Layout::tet20}, {"tet16", tetfmt::Layout::tet16}},
                             "20 or 16 bytes a tetrahedron [tet20]")
      ->type_name("LAYOUT")
      ->group(group);
  add_choice<KeepAttributes>(
      command, "--attributes", options.attributes,
      {{"none", KeepAttributes::none}, {"normals", KeepAttributes::normals}, {"all", KeepAttributes::all}},
      "Which of the input's attributes to keep: none; normals; or all: normals, texture\ncoordinates, "
      "colours, properties, materials, objects [all]")
      ->type_name("WHICH")
      ->group(group);
  add_choice<bool>(
      command, "--surface", options.draco, {{"plain", false}, {"draco", true}},
      "How attributes are stored: plain, ready to use; or draco, smaller and rounded a little\n[plain]")
      ->type_name("HOW")
      ->group(group);
  add_number(command, "--simplify", options.simplify, "length in model units",
             "First make do with fewer triangles, which stay within this distance of the surface\n(model "
             "units; manifold parts only)")
      ->type_name("ERROR")
      ->group(group);
}

void add_tetrahedra(CLI::App& command, Settings& settings) {
  ConvertOptions& options = settings.options;
  const std::string group = "How the tetrahedra are made";
  command
      .add_option_function<std::string>(
          "--radius-edge",
          [&options](const std::string& text) {
            const auto value = parse_double(text);
            if (!value || !(*value == 0 || (*value >= 1 && *value <= 1000)))
              throw CLI::ValidationError("--radius-edge", "must be 0, or from 1 to 1000, not " + text);
            options.radius_edge = *value;
          },
          "Bound on circumradius / shortest edge of tets: fewer tets along a ray, a few more\npoints (from 1 "
          "to 1000; 0 for none) [5]")
      ->type_name("R")
      ->group(group);
  add_choice<Optimize>(command, "--optimize", options.optimize,
                       {{"none", Optimize::none}, {"fast", Optimize::fast}, {"best", Optimize::best}},
                       "Replace tets so that rays cross fewer of them: none, fast (where it pays most) or "
                       "best\n(everywhere, with more points) [fast]")
      ->type_name("HOW")
      ->group(group);
  command
      .add_option("--threads", options.threads, "Threads to use; the result is the same for any number [all]")
      ->check(CLI::Range(1u, 1024u))
      ->type_name("N")
      ->group(group);
}

void add_limits(CLI::App& command, Settings& settings) {
  ConvertOptions& options = settings.options;
  const std::string group = "Limits";
  const std::string what = "number of seconds";
  add_number(command, "--timeout", options.time_limit, what,
             "Seconds that TetGen may take for one attempt [by size]")
      ->type_name("SECONDS")
      ->group(group);
  add_number(command, "--time-limit", options.time_limit, what, "The former name of --timeout")->group("");
  command
      .add_option_function<std::string>(
          "--memory",
          [&options](const std::string& text) {
            const auto bytes = parse_bytes(text);
            if (!bytes)
              throw CLI::ValidationError("--memory", "must be a size such as 800M or 4G, not " + text);
            options.memory_limit = *bytes;
          },
          "Memory that TetGen's process may use, such as 800M or 4G [no limit]")
      ->type_name("SIZE")
      ->group(group);
}

void add_batch(CLI::App& command, Settings& settings) {
  const std::string group = "Many conversions";
  CLI::Option* batch =
      command.add_option("--batch", settings.batch, "Convert what LIST names; - for standard input")
          ->type_name("LIST")
          ->group(group);
  command.add_option("-j,--jobs", settings.at_once, "Conversions at a time [1]")
      ->check(CLI::Range(1u, 1024u))
      ->needs(batch)
      ->type_name("N")
      ->group(group);
}

}  // namespace

void add_convert_command(CLI::App& app, std::function<int()>& run) {
  const auto settings = std::make_shared<Settings>();
  CLI::App* command = app.add_subcommand(
      "convert", "Make a tet file from surface meshes: one, or several that make one scene.");
  CLI::Option* inputs =
      command
          ->add_option("INPUT", settings->options.inputs,
                       "Surface meshes, by extension: .obj (with .mtl), .ply, .stl, .off, .drc, .gltf, .glb")
          ->type_name("");
  add_files(*command, *settings);
  add_contents(*command, *settings);
  CLI::Option* keep = command
                          ->add_option("--keep",
                                       "Which space to keep: all; outside, for rays that start outside of "
                                       "everything among\nopaque surfaces; or reachable-from X,Y,Z, the "
                                       "space around a point (may be given several\ntimes) [all]")
                          ->expected(1, 2)
                          ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll)
                          ->type_name("SPACE")
                          ->group("What goes into the file");
  add_tetrahedra(*command, *settings);
  add_limits(*command, *settings);
  add_batch(*command, *settings);
  CLI::Option* quiet = command->add_flag("-q,--quiet", settings->quiet, "Print nothing but errors");
  command->add_flag("-v,--verbose", settings->verbose, "Print every stage, and more of what was done")
      ->excludes(quiet);
  command->footer(kFooter);
  command->callback([settings, &run, command, inputs, keep] {
    sort_out_keep(*command, inputs, keep, settings->options);
    check_what_was_given(*settings);
    run = [settings] { return settings->batch.empty() ? convert_one(*settings) : convert_batch(*settings); };
  });
}

}  // namespace tetprep
