// SPDX-License-Identifier: AGPL-3.0-or-later
// `tet trace`: a picture of the surface in a tet file.
#include <cmath>
#include <cstdio>
#include <iostream>
#include <memory>

#include "common/atomic_file.hpp"
#include "common/failure.hpp"
#include "common/output.hpp"
#include "common/parse.hpp"
#include "common/same_file.hpp"
#include "common/terminal_progress.hpp"
#include "common/tet_file.hpp"
#include "common/threads.hpp"
#include "tet/command.hpp"
#include "trace/render.hpp"

namespace tetprep {
namespace {

constexpr int kMaxEdge = 32768;
constexpr std::int64_t kMaxPixels = std::int64_t{1} << 28;
constexpr int kMaxSamples = 1024;
constexpr double kMaxCoordinate = 1e30;  // squares and products of three stay finite in double

struct TraceOptions {
  std::string file, output;
  CameraWish camera;
  bool up_given = false;
  RenderOptions render;
};

void print_summary(const TraceOptions& options, const RenderStatistics& s) {
  const auto rays = static_cast<double>(s.rays);
  std::array<char, 256> text;
  std::snprintf(
      text.data(), text.size(),
      ": %d x %d pixels; %llu rays in %.3f s on %d thread%s, %.0f ns of a thread a ray; %.1f %% hit; "
      "%.1f tets a ray, at most %u",
      options.render.width, options.render.height, static_cast<unsigned long long>(s.rays), s.seconds,
      s.threads, s.threads == 1 ? "" : "s", 1e9 * s.seconds * s.threads / rays,
      100 * static_cast<double>(s.hits) / rays, static_cast<double>(s.steps) / rays, s.most_steps);
  std::cerr << "tet trace: " << one_line(options.output + text.data()) << '\n';
}

int run_trace(const TraceOptions& options) {
  refuse_same_file(options.file, options.output);
  const TetFile file(options.file);
  AtomicFile out(options.output);
  const double aspect = static_cast<double>(options.render.width) / options.render.height;
  RenderStatistics statistics;
  {
    TerminalProgress progress;
    try {
      const Camera camera = make_camera(options.camera, options.up_given, file.view(), aspect);
      const Rendering rendering = render(file.view(), camera, options.render, progress);
      statistics = rendering.statistics;
      progress.stage("write");
      write_png(rendering.image, out);
    } catch (const Failure& failure) {
      if (failure.code() != ExitCode::invalid) throw;
      throw Failure(failure.code(), options.file + ": " + failure.what());
    }
    out.commit();
  }
  print_summary(options, statistics);
  return 0;
}

Vec3 vector_option(const char* option, const std::string& text) {
  const auto vector = parse_vector(text);
  if (!vector) throw CLI::ValidationError(option, "expected three numbers X,Y,Z, found '" + text + "'");
  for (const double x : *vector) {
    if (std::abs(x) > kMaxCoordinate)
      throw CLI::ValidationError(option, "expected numbers up to 1e30, found '" + text + "'");
  }
  return vec3(*vector);
}

/// An option in degrees. Parsed here, for CLI11's ranges let nan pass. `target` must outlive the parsing.
CLI::Option* add_angle(CLI::App* verb, const std::string& name, double& target, double low, double high,
                       const std::string& help) {
  const auto parse = [&target, name, low, high](const std::string& text) {
    const auto degrees = parse_double(text);
    if (!degrees || !(*degrees >= low && *degrees <= high)) {
      throw CLI::ValidationError(
          name, "expected " + number(low) + " to " + number(high) + " degrees, found '" + text + "'");
    }
    target = *degrees;
  };
  return verb->add_option_function<std::string>(name, parse, help)->type_name("DEG");
}

}  // namespace

void add_trace_command(CLI::App& app, std::function<int()>& run) {
  const auto options = std::make_shared<TraceOptions>();
  CLI::App* verb = app.add_subcommand("trace", "Trace a picture of the surface in a tet file.");
  verb->add_option("FILE", options->file, "A tet file")->required();
  verb->add_option("-o,--output", options->output, "The PNG to write: 8 bits a channel, sRGB")
      ->required()
      ->type_name("OUT.png");
  verb->add_option_function<std::string>(
          "--size",
          [options](const std::string& text) {
            const auto size = parse_size(text);
            if (!size || (*size)[0] > kMaxEdge || (*size)[1] > kMaxEdge ||
                std::int64_t{(*size)[0]} * (*size)[1] > kMaxPixels) {
              throw CLI::ValidationError(
                  "--size",
                  "expected WxH, each 1 to 32768 and 2^28 pixels in all at most, found '" + text + "'");
            }
            options->render.width = (*size)[0];
            options->render.height = (*size)[1];
          },
          "Pixels, width and height [1024x1024]")
      ->type_name("WxH");
  CLI::Option* eye =
      verb->add_option_function<std::string>(
              "--eye",
              [options](const std::string& text) { options->camera.eye = vector_option("--eye", text); },
              "Where the camera is, in the input mesh's coordinates [in front, to the right and above, just "
              "far\n"
              "enough to see the whole surface]")
          ->type_name("X,Y,Z");
  verb->add_option_function<std::string>(
          "--look-at",
          [options](const std::string& text) { options->camera.look_at = vector_option("--look-at", text); },
          "The point in the middle of the picture [the middle of the surface]")
      ->type_name("X,Y,Z");
  verb->add_option_function<std::string>(
          "--up",
          [options](const std::string& text) {
            options->camera.up = vector_option("--up", text);
            options->up_given = true;
            if (!(length(options->camera.up) > 0)) throw CLI::ValidationError("--up", "must not be zero");
          },
          "The direction that is upward in the picture [0,1,0]; try 0,0,1 for models from CAD and maps")
      ->type_name("X,Y,Z");
  add_angle(verb, "--fov", options->camera.fov, 0.01, 179, "Vertical opening angle in degrees [30]");
  add_angle(verb, "--azimuth", options->camera.azimuth, -360, 360,
            "Without --eye: from which side to look, in degrees around --up from the front (+z; -y if "
            "z is up)\n"
            "towards its right [30]; 210 for models that face the other way")
      ->excludes(eye);
  add_angle(verb, "--elevation", options->camera.elevation, -89, 89,
            "Without --eye: from how far above to look, in degrees [18]")
      ->excludes(eye);
  const std::map<std::string, Shade> shades{{"lambert", Shade::lambert},
                                            {"normal", Shade::normal},
                                            {"depth", Shade::depth},
                                            {"steps", Shade::steps}};
  verb->add_option_function<std::string>(
          "--shade", [options, shades](const std::string& name) { options->render.shade = shades.at(name); },
          "What colours show [lambert]:\n"
          "lambert: a clay model under two lights, both sides of the surface alike\n"
          "normal:  the input triangle's unit normal n as (n + 1) / 2\n"
          "depth:   distance along the view axis, near bright\n"
          "steps:   tetrahedra visited, dark blue (none) to yellow (the most of a pixel)")
      ->check(one_of({"lambert", "normal", "depth", "steps"}))
      ->type_name("SHADE");
  verb->add_option("--samples", options->render.samples, "Rays a pixel, on a regular grid [4]")
      ->check(CLI::Range(1, kMaxSamples))
      ->type_name("N");
  verb->add_option("--threads", options->render.threads,
                   "Threads to use [all]; the picture is the same for any number")
      ->check(CLI::Range(1, kMaxThreads))
      ->type_name("N");
  verb->footer(
      "A summary goes to standard error: rays, seconds, nanoseconds of a thread's time a ray, share of rays "
      "that hit,\n"
      "tetrahedra visited a ray and at most.\n"
      "\n"
      "Exit codes: 0 done; 1 usage; 2 a file cannot be read or written; 3 a broken tet file; 5 a kind of "
      "file that\n"
      "this version does not know. On failure nothing is left at OUT.png.\n"
      "\n"
      "Examples:\n"
      "  tet trace bunny.tet -o bunny.png\n"
      "  tet trace bunny.tet -o side.png --size 1920x1080 --eye 10,2,0 --look-at 0,0,0 --fov 30\n"
      "  tet trace armadillo.tet -o front.png --azimuth 210\n"
      "  tet trace part.tet -o part.png --up 0,0,1 --shade normal\n"
      "  tet trace bunny.tet -o cost.png --shade steps --samples 1");
  verb->callback([options, &run] { run = [options] { return run_trace(*options); }; });
}

}  // namespace tetprep
