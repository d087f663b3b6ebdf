// SPDX-License-Identifier: AGPL-3.0-or-later
// `tet sample`: a surface mesh out of nothing.
#include <iostream>
#include <memory>

#include "common/failure.hpp"
#include "common/parse.hpp"
#include "common/terminal_progress.hpp"
#include "sample/surface.hpp"
#include "sample/write_mesh.hpp"
#include "tet/command.hpp"

namespace tetprep {
namespace {

struct SampleOptions {
  std::string kind, output;
  std::uint64_t triangles = 20000, seed = 1;
};

int run_sample(const SampleOptions& options) {
  for (const SurfaceKind& kind : surface_kinds()) {
    if (options.kind != kind.name) continue;
    if (options.triangles < kind.minimum) {
      throw Failure(ExitCode::usage, "--triangles " + std::to_string(options.triangles) + ": " + kind.name +
                                         " needs at least " + std::to_string(kind.minimum));
    }
    check_mesh_ending(options.output);
    TerminalProgress progress;
    progress.stage("sample");
    const Surface surface = kind.make(options.triangles, options.seed);
    progress.stage("write");
    write_mesh(surface, options.output);
    std::cerr << "tet sample: " << options.output << ": " << surface.triangles.size() << " triangles, "
              << surface.points.size() << " vertices\n";
    return 0;
  }
  throw Failure(ExitCode::usage, "unknown kind of surface: " + options.kind);
}

std::string kinds_text() {
  std::string text = "Kinds:\n";
  for (const SurfaceKind& kind : surface_kinds()) {
    std::string name = std::string("  ") + kind.name;
    name.resize(15, ' ');
    text += name + kind.description + "; at least " + std::to_string(kind.minimum) + " triangles\n";
  }
  return text;
}

}  // namespace

void add_sample_command(CLI::App& app, std::function<int()>& run) {
  const auto options = std::make_shared<SampleOptions>();
  CLI::App* verb = app.add_subcommand(
      "sample", "Make a procedural surface mesh, to try things on and to see how they scale.");
  std::vector<std::string> names;
  for (const SurfaceKind& kind : surface_kinds()) names.emplace_back(kind.name);
  verb->add_option("KIND", options->kind, "What to make")->required()->check(one_of(names))->type_name("");
  verb->add_option("-o,--output", options->output,
                   std::string("The mesh to write; its format by the name's ending: ") + kMeshEndings)
      ->required()
      ->type_name("MESH");
  verb->add_option("--triangles", options->triangles,
                   "About how many triangles, within 3 % from 1000 on [20000]; the exact count is printed")
      ->check(CLI::Range(std::uint64_t{1}, kMaxSampleTriangles))
      ->type_name("N");
  verb->add_option_function<std::string>(
          "--seed",
          [options](const std::string& text) {
            const auto seed = parse_whole(text);
            if (!seed)
              throw CLI::ValidationError("--seed",
                                         "expected a whole number from 0 to 2^64 - 1, found '" + text + "'");
            options->seed = *seed;
          },
          "What the bumps and the placing of knots are drawn from, 0 to 2^64 - 1 [1]")
      ->type_name("S");
  verb->footer(kinds_text() +
               "No surface meets itself; closed ones (all but bumpy-plane) are watertight and point outward. "
               "The same\n"
               "options make the same file on every machine. PLY and STL are binary.\n"
               "\n"
               "Exit codes: 0 done; 1 usage; 2 the mesh cannot be written (then nothing is left there).\n"
               "\n"
               "Examples:\n"
               "  tet sample sphere -o sphere.obj --triangles 1000\n"
               "  tet sample knots -o knots.ply --triangles 1000000 --seed 7");
  verb->callback([options, &run] { run = [options] { return run_sample(*options); }; });
}

}  // namespace tetprep
