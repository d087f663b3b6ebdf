// SPDX-License-Identifier: AGPL-3.0-or-later
// `tet trace`: a picture of a tet file or of a scene.
#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <iostream>
#include <memory>

#include "common/atomic_file.hpp"
#include "common/failure.hpp"
#include "common/output.hpp"
#include "common/parse.hpp"
#include "common/same_file.hpp"
#include "common/terminal_progress.hpp"
#include "common/threads.hpp"
#include "tet/command.hpp"
#include "trace/render.hpp"

namespace tetprep {
namespace {

constexpr double kMaxCoordinate = 1e30;  // squares and products of three stay finite in double

constexpr const char* kTraceFooter =
    "A scene, in JSON; only \"files\" must be there, paths start at the scene's folder:\n"
    "  {\n"
    "    \"files\": [{\"path\": \"room.tet\",\n"
    "               \"materials\": {\"lamp\": {\"emission\": 15}},\n"
    "               \"objects\": {\"bunny.ply\": {\"type\": \"glass\", \"ior\": 1.5, \"absorption\": [2, "
    "0.5, 1]}}}],\n"
    "    \"camera\": {\"eye\": [0, 2, 5], \"look_at\": [0, 1, 0], \"fov\": 35},\n"
    "    \"point_lights\": [{\"position\": [2, 4, 2], \"intensity\": 40}],\n"
    "    \"background\": {\"bottom\": \"#404448\", \"top\": \"#b8c8e0\"},\n"
    "    \"ambient_occlusion\": {\"distance\": 1.5, \"samples\": 4},\n"
    "    \"samples\": 64, \"max_bounces\": 12, \"size\": [800, 600]\n"
    "  }\n"
    "Materials and objects are named as in the file (`tet info` lists them; objects by their input file, "
    "too) and "
    "may\n"
    "change type (diffuse, mirror, glass), color, emission, ior, absorption, texture, texture_origin, "
    "vertex_colors,\n"
    "smooth; \"material\" changes all of a file. Colours are linear numbers or \"#rrggbb\". "
    "spec/scene.schema.json has all.\n"
    "\n"
    "A summary goes to standard error: rays of each kind, seconds, nanoseconds of a thread's time a ray, "
    "share of camera\n"
    "rays that hit, tetrahedra visited a camera ray, and how much of the files the picture needed. Rays are "
    "walked together,\n"
    "and a tetrahedron counts once for all that are in it; with --shade steps or --kernel float each is "
    "walked alone, and the\n"
    "most that one visited is told as well.\n"
    "\n"
    "Of tet files only the structure is checked, which takes no time: `tet validate` proves a file.\n"
    "\n"
    "Exit codes: 0 done; 1 usage; 2 a file cannot be read or written; 3 a broken tet file or scene; 5 a kind "
    "of file\n"
    "that this version does not know. Where the camera is in space that a file leaves out (convert "
    "--keep), or has no view\n"
    "direction: 3 if the scene file places it, 1 if options do or nobody does; for lights and rays into "
    "glass, 3. "
    "On failure\n"
    "nothing is left at OUT.png.\n"
    "\n"
    "Examples:\n"
    "  tet trace bunny.tet -o bunny.png\n"
    "  tet trace bunny.tet -o side.png --size 1920x1080 --eye 10,2,0 --look-at 0,0,0 --fov 30\n"
    "  tet trace armadillo.tet -o front.png --azimuth 210\n"
    "  tet trace part.tet -o part.png --up 0,0,1 --shade normal\n"
    "  tet trace bunny.tet -o cost.png --shade steps --samples 1\n"
    "  tet trace scene.json -o draft.png --samples 4 --size 320x240\n"
    "  tet trace scene.json -o scene.exr";

struct TraceOptions {
  std::string file, output;
  std::vector<std::function<void(CameraWish&)>>
      camera;  ///< what the options say of it, over what a scene says
  std::optional<std::array<int, 2>> size;
  std::optional<int> samples;
  std::optional<Shade> shade;
  Walks walks = Walks::together;
  int threads = 0;
};

bool ends_with_ignoring_case(const std::string& text, std::string_view ending) {
  return text.size() >= ending.size() &&
         std::equal(ending.begin(), ending.end(), text.end() - static_cast<std::ptrdiff_t>(ending.size()),
                    [](char a, char b) { return a == std::tolower(static_cast<unsigned char>(b)); });
}

/// What writes a picture of this name.
auto writer_of(const std::string& path) {
  const std::string extension = std::filesystem::path(path).extension().string();
  if (ends_with_ignoring_case(extension, ".exr")) return write_exr;
  if (extension.empty() || ends_with_ignoring_case(extension, ".png")) return write_png;
  throw Failure(ExitCode::usage, path +
                                     ": no picture of this kind can be written; name it .png (8 bits a "
                                     "channel, sRGB) or .exr (OpenEXR, linear float)");
}

/// "12345 camera, 678 shadow": kinds that there were.
std::string ray_list(const RayCounts& counts) {
  std::string text;
  for (std::size_t i = 0; i < counts.rays.size(); ++i) {
    if (counts.rays[i] == 0) continue;
    text += (text.empty() ? "" : ", ") + std::to_string(counts.rays[i]) + " " + kRayKindNames[i];
  }
  return text;
}

void print_summary(const std::string& output, const Rendering& rendering, const Scene& scene) {
  const RenderStatistics& s = rendering.statistics;
  const auto count = [](std::uint64_t n) { return static_cast<double>(n); };
  const auto camera_rays = s.counts.rays[static_cast<std::size_t>(RayKind::camera)];
  std::array<char, 512> text;
  std::snprintf(text.data(), text.size(),
                ": %d x %d pixels; %llu rays (%s) in %.3f s on %d thread%s, %.0f ns of a thread a ray; %.1f "
                "%% hit; %.1f tets visited a camera ray",
                rendering.image.width, rendering.image.height,
                static_cast<unsigned long long>(s.counts.total()), ray_list(s.counts).c_str(), s.seconds,
                s.threads, s.threads == 1 ? "" : "s", 1e9 * s.seconds * s.threads / count(s.counts.total()),
                100 * count(s.counts.hits) / count(camera_rays), count(s.counts.visits) / count(camera_rays));
  std::string line = output + text.data();
  line += rendering.statistics.walks == Walks::together ? ", walked together"
                                                        : ", at most " + std::to_string(s.counts.most_steps);
  std::snprintf(text.data(), text.size(), "; read at most %.2f of %.2f MB",
                1e-6 * count(scene.readable_bytes()), 1e-6 * count(scene.file_bytes()));
  line += text.data();
  if (s.counts.lost > 0) line += "; " + std::to_string(s.counts.lost) + " rays lost by the float kernel";
  std::cerr << "tet trace: " << one_line(line) << '\n';
}

int run_trace(const TraceOptions& options) {
  refuse_same_file(options.file, options.output);
  if (options.output == "-")
    throw Failure(ExitCode::usage, "-o takes the name of a file; for standard output, /dev/stdout");
  const bool is_scene = ends_with_ignoring_case(options.file, ".json");
  SceneDescription description = is_scene ? read_scene_file(options.file) : scene_of(options.file);
  for (const auto& change : options.camera) change(description.camera);
  if (!options.camera.empty()) description.camera.where.clear();
  for (const FileEntry& entry : description.files) refuse_same_file(entry.path, options.output);
  const auto write = writer_of(options.output);

  RenderOptions render_options;
  const auto size = options.size ? options.size : description.size;
  if (size) render_options.width = (*size)[0], render_options.height = (*size)[1];
  if (const auto samples = options.samples ? options.samples : description.samples)
    render_options.samples = *samples;
  render_options.shade = options.shade.value_or(is_scene ? Shade::scene : Shade::lambert);
  render_options.walks = options.walks;
  if (render_options.shade == Shade::steps && options.walks == Walks::together)
    render_options.walks = Walks::one_by_one;
  render_options.threads = options.threads;

  const Scene scene = open_scene(description, render_options.shade == Shade::scene);
  for (const std::string& texture : scene.texture_files) refuse_same_file(texture, options.output);
  for (const std::string& warning : scene.warnings)
    std::cerr << "tet trace: warning: " << one_line(warning) << '\n';
  AtomicFile out(options.output);
  const auto rendering = [&] {
    TerminalProgress progress;
    const double aspect = static_cast<double>(render_options.width) / render_options.height;
    const Camera camera = make_camera(description.camera, scene, aspect);
    Rendering result = render(scene, camera, render_options, progress);
    progress.stage("write");
    write(result.image, out);
    return result;
  }();
  out.commit();
  print_summary(options.output, rendering, scene);
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

/// An option in degrees. Parsed here, for CLI11's ranges let nan pass.
CLI::Option* add_angle(CLI::App* verb, const std::string& name, double low, double high,
                       const std::string& help, std::function<void(double)> use) {
  const auto parse = [use = std::move(use), name, low, high](const std::string& text) {
    const auto degrees = parse_double(text);
    if (!degrees || !(*degrees >= low && *degrees <= high)) {
      throw CLI::ValidationError(
          name, "expected " + number(low) + " to " + number(high) + " degrees, found '" + text + "'");
    }
    use(*degrees);
  };
  return verb->add_option_function<std::string>(name, parse, help)->type_name("DEG");
}

/// Where the camera is and how it looks.
void add_camera_options(CLI::App* verb, const std::shared_ptr<TraceOptions>& options) {
  const auto change = [options](auto how) { options->camera.emplace_back(std::move(how)); };
  CLI::Option* eye =
      verb->add_option_function<std::string>(
              "--eye",
              [change](const std::string& text) {
                change([eye = vector_option("--eye", text)](CameraWish& wish) { wish.eye = eye; });
              },
              "Where the camera is, in the input mesh's coordinates [in front, to the right and above, just "
              "far\n"
              "enough to see the whole surface]")
          ->type_name("X,Y,Z");
  verb->add_option_function<std::string>(
          "--look-at",
          [change](const std::string& text) {
            change([point = vector_option("--look-at", text)](CameraWish& wish) { wish.look_at = point; });
          },
          "The point in the middle of the picture [the middle of the surface]")
      ->type_name("X,Y,Z");
  verb->add_option_function<std::string>(
          "--up",
          [change](const std::string& text) {
            const Vec3 up = vector_option("--up", text);
            if (!(length(up) > 0)) throw CLI::ValidationError("--up", "must not be zero");
            change([up](CameraWish& wish) { wish.up = up; });
          },
          "The direction that is upward in the picture [0,1,0]; try 0,0,1 for models from CAD and maps")
      ->type_name("X,Y,Z");
  add_angle(verb, "--fov", 0.01, 179, "Vertical opening angle in degrees [30]",
            [change](double x) { change([x](CameraWish& wish) { wish.fov = x; }); });
  // These two are ways to say where the eye is, so they take the place of a scene's.
  add_angle(verb, "--azimuth", -360, 360,
            "Without --eye: from which side to look, in degrees around --up from the front (+z; -y if "
            "z is up)\n"
            "towards its right [30]; 210 for models that face the other way",
            [change](double x) { change([x](CameraWish& wish) { wish.azimuth = x, wish.eye.reset(); }); })
      ->excludes(eye);
  add_angle(verb, "--elevation", -89, 89, "Without --eye: from how far above to look, in degrees [18]",
            [change](double x) { change([x](CameraWish& wish) { wish.elevation = x, wish.eye.reset(); }); })
      ->excludes(eye);
}

}  // namespace

void add_trace_command(CLI::App& app, std::function<int()>& run) {
  const auto options = std::make_shared<TraceOptions>();
  CLI::App* verb = app.add_subcommand(
      "trace",
      "Trace a picture of the surface in a tet file, or of a scene: tet files, light and materials.");
  verb->add_option("FILE", options->file, "A tet file; or a scene, whose name ends in .json")->required();
  verb->add_option("-o,--output", options->output,
                   "The picture to write, .png (8 bits a channel, sRGB; so are names without an ending) or "
                   ".exr (OpenEXR,\n"
                   "linear float)")
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
            options->size = *size;
          },
          "Pixels, width and height [the scene's, or 1024x1024]")
      ->type_name("WxH");
  add_camera_options(verb, options);
  const std::map<std::string, Shade> shades{{"scene", Shade::scene},
                                            {"lambert", Shade::lambert},
                                            {"normal", Shade::normal},
                                            {"depth", Shade::depth},
                                            {"steps", Shade::steps}};
  verb->add_option_function<std::string>(
          "--shade", [options, shades](const std::string& name) { options->shade = shades.at(name); },
          "What colours show [scene for scenes, lambert for tet files]:\n"
          "scene:   materials, light and shadow; without any light, two lights fixed to the camera\n"
          "lambert: a clay model under two lights, both sides of the surface alike\n"
          "normal:  the input triangle's unit normal n as (n + 1) / 2\n"
          "depth:   distance along the view axis, near bright\n"
          "steps:   tetrahedra visited, dark blue (none) to yellow (the most of a pixel); rays are walked "
          "one by "
          "one")
      ->check(one_of({"scene", "lambert", "normal", "depth", "steps"}))
      ->type_name("SHADE");
  verb->add_option("--samples", options->samples,
                   "Camera rays a pixel, on a regular grid [the scene's, or 4]")
      ->check(CLI::Range(1, kMaxSamples))
      ->type_name("N");
  add_choice<Walks>(*verb, "--kernel", options->walks,
                    {{"exact", Walks::together}, {"float", Walks::float_signs}},
                    "How the signs that steer a ray are computed: exact; or float, which can go wrong where "
                    "rays meet\n"
                    "edges, and takes rays one by one, for comparison [exact]")
      ->type_name("KERNEL");
  verb->add_option("--threads", options->threads,
                   "Threads to use [all]; the picture is the same for any number")
      ->check(CLI::Range(1, kMaxThreads))
      ->type_name("N");
  verb->footer(kTraceFooter);
  verb->callback([options, &run] { run = [options] { return run_trace(*options); }; });
}

}  // namespace tetprep
