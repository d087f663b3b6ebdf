// SPDX-License-Identifier: AGPL-3.0-or-later
// tet convert: a surface mesh becomes a tet file.
#include <cmath>
#include <cstdio>
#include <iostream>
#include <map>
#include <memory>
#include <type_traits>

#include "common/terminal_progress.hpp"
#include "prep/pipeline.hpp"
#include "tet/command.hpp"

namespace tetprep {
namespace {

constexpr const char* kFooter =
    "Input by extension: .obj, .off, .ply (ascii, binary), .stl (ascii, binary), .drc. Triangles and "
    "polygons,\n"
    "open or closed, connected or not. A surface that intersects itself is refused, and the triangles are "
    "named.\n"
    "Coordinates are put on a power-of-two grid of about 2^21 steps over the extent; those that lie on such "
    "a\n"
    "grid already keep every bit. The output appears only when it is complete and has passed\n"
    "`tet validate --level geometry`.";

struct Settings {
  ConvertOptions options;
  bool quiet = false, verbose = false;
};

template <class... Values>
void print(const char* format, Values... values) {
  char line[512];
  std::snprintf(line, sizeof line, format, values...);
  std::cerr << line << '\n';
}

void print_summary(const Settings& settings, const ConvertReport& report) {
  const auto megabytes = static_cast<double>(report.output_bytes) * 1e-6;
  std::cerr << settings.options.output << ": ";
  print("%zu triangles, %zu tets, %.2f MB (%.1f bytes a tet), %.2f s of which TetGen %.2f s",
        report.input_triangles, report.tets, megabytes,
        static_cast<double>(report.output_bytes) / static_cast<double>(report.tets), report.seconds,
        report.tetrahedralize.tetgen_seconds);
  if (report.degenerate_triangles + report.duplicate_triangles > 0)
    print("left out: %zu triangles without an area, %zu that repeat another", report.degenerate_triangles,
          report.duplicate_triangles);
  if (const std::string note = fallback_note(report.tetrahedralize); !note.empty()) std::cerr << note << '\n';
  if (!settings.verbose) return;
  print("grid 2^%d, points moved by at most %g, %zu equal points merged", report.grid_exponent,
        report.max_deviation, report.merged_points);
  print("TetGen -%s, %u points of its own, %u of them moved", report.tetrahedralize.switches.c_str(),
        report.tetrahedralize.steiner_points, report.tetrahedralize.moved_steiner_points);
  if (settings.options.optimize != Optimize::none)
    print("%u flips: area between tets from %.2f to %.2f times the box's surface", report.crossings.flips,
          report.crossings.area_before, report.crossings.area_after);
  for (const StageCost& stage : report.stages)
    print("%8.3f s %8.1f MB  %s", stage.seconds, stage.peak_memory_mb, stage.name.c_str());
  print("%8.3f s %8.1f MB  in all", report.seconds, report.peak_memory_mb);
}

/// Turns a name into its value's number, as CLI11 wants it; others are refused with the names that there are.
template <class Enum>
CLI::Validator one_of(const std::map<std::string, Enum>& names) {
  const auto change = [names](std::string& text) {
    if (const auto found = names.find(text); found != names.end()) {
      text = std::to_string(static_cast<std::underlying_type_t<Enum>>(found->second));
      return std::string();
    }
    std::string known;
    for (const auto& [name, value] : names) known += (known.empty() ? "" : " or ") + name;
    return "must be " + known + ", not " + text;
  };
  return CLI::Validator(change, "");
}

}  // namespace

void add_convert_command(CLI::App& app, std::function<int()>& run) {
  const auto settings = std::make_shared<Settings>();
  ConvertOptions& options = settings->options;
  CLI::App* command = app.add_subcommand("convert", "Make a tet file from a surface mesh");
  command->add_option("INPUT", options.inputs, "Surface mesh")->required();
  command->add_option("-o,--output", options.output, "Tet file to write")->required()->type_name("OUT.tet");
  const std::map<std::string, tetfmt::Layout> layouts{{"tet20", tetfmt::Layout::tet20},
                                                      {"tet16", tetfmt::Layout::tet16}};
  command->add_option("--layout", options.layout, "Bytes a cell: tet20 (default) or tet16")
      ->transform(one_of(layouts))
      ->type_name("LAYOUT");
  command->add_option("--threads", options.threads, "Threads to use (default: all)")
      ->check(CLI::Range(1u, 1024u))
      ->type_name("N");
  command->add_option("--report", options.report, "Write counts, times and memory as JSON")
      ->type_name("FILE.json");
  command
      ->add_option("--radius-edge", options.radius_edge,
                   "Bound on circumradius / shortest edge of tets: fewer tets along a ray, a few more points "
                   "(from 1 to 1000, default 5; 0 for none)")
      ->check(CLI::Validator(
          [](const std::string& text) {
            double value = 0;
            return CLI::detail::lexical_cast(text, value) && (value == 0 || (value >= 1 && value <= 1000))
                       ? std::string()
                       : "must be 0, or from 1 to 1000, not " + text;
          },
          "0 or 1 to 1000"))
      ->type_name("R");
  const std::map<std::string, Optimize> optimize{
      {"none", Optimize::none}, {"fast", Optimize::fast}, {"best", Optimize::best}};
  command
      ->add_option(
          "--optimize", options.optimize,
          "Flip tets so that rays cross fewer of them: none, fast (default, where it pays most) or best "
          "(everywhere)")
      ->transform(one_of(optimize))
      ->type_name("HOW");
  command
      ->add_option("--time-limit", options.time_limit,
                   "Seconds that TetGen may take for one attempt (default: by size)")
      ->check(CLI::Validator(
          [](const std::string& text) {
            double value = 0;
            return CLI::detail::lexical_cast(text, value) && std::isfinite(value) && value > 0
                       ? std::string()
                       : "must be a positive number of seconds, not " + text;
          },
          "> 0"))
      ->type_name("SECONDS");
  CLI::Option* quiet = command->add_flag("-q,--quiet", settings->quiet, "Print nothing but errors");
  command->add_flag("-v,--verbose", settings->verbose, "Print every stage")->excludes(quiet);
  command->footer(kFooter);
  command->callback([settings, &run] {
    run = [settings] {
      ConvertReport report;
      {
        TerminalProgress progress(!settings->quiet);
        report = convert(settings->options, progress);
      }
      if (!settings->quiet) print_summary(*settings, report);
      return static_cast<int>(ExitCode::ok);
    };
  });
}

}  // namespace tetprep
