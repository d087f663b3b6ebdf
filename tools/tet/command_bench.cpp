// SPDX-License-Identifier: AGPL-3.0-or-later
// `tet bench`: measures what the project claims, on the user's own files and machine.
#include <algorithm>
#include <memory>
#include <optional>

#include "bench/bench.hpp"
#include "bench/stress.hpp"
#include "common/atomic_file.hpp"
#include "common/failure.hpp"
#include "common/output.hpp"
#include "common/parse.hpp"
#include "common/same_file.hpp"
#include "common/terminal_progress.hpp"
#include "common/tet_file.hpp"
#include "common/threads.hpp"
#include "tet/command.hpp"
#include "tetfmt/mapped_file.hpp"

namespace tetprep {
namespace {

struct BenchOptions {
  std::vector<std::string> files;
  std::string other, csv, json;
  tetbench::CameraSeries series;
  bool stress = false;
  tetbench::StressOptions stress_options;
};

struct OpenFile {
  explicit OpenFile(const std::string& path)
      : file((TetFile(path), tetfmt::MappedFile::open(path))),
        view(tetfmt::TrustedView::validated(file.value().bytes())) {
    if (!view) throw Failure(ExitCode::invalid, path + ": " + tetfmt::to_string(view.error()));
  }
  tetfmt::Result<tetfmt::MappedFile> file;
  tetfmt::Result<tetfmt::TrustedView> view;
};

int run_camera(const BenchOptions& options) {
  if (options.files.size() != 1)
    throw Failure(ExitCode::usage, "one FILE at a time, unless --stress is given");
  if (!options.csv.empty() || !options.json.empty())
    throw Failure(ExitCode::usage, "--csv and --json go with --stress");
  const std::string& path = options.files[0];
  const OpenFile first(path);
  std::optional<OpenFile> second;
  if (!options.other.empty()) {
    second.emplace(options.other);
    const tetfmt::FileView &a = first.view->view(), &b = second->view->view();
    if (a.layout() == b.layout() || !std::ranges::equal(a.vertices(), b.vertices()) ||
        a.tet_count() != b.tet_count())
      throw Failure(ExitCode::differs, options.other + ": not the mesh of " + path +
                                           " in the other layout; convert the same input with --layout");
  }
  tetbench::file_costs(path, options.series.repeats);
  if (second) tetbench::file_costs(options.other, options.series.repeats);
  tetbench::camera_series(*first.view, second ? &*second->view : nullptr, options.series);
  tetbench::compare_variants(*first.view, options.series);
  return 0;
}

int run_stress(const BenchOptions& options) {
  if (!options.other.empty()) throw Failure(ExitCode::usage, "--other goes without --stress, which makes it");
  tetbench::chosen_sets(options.stress_options.sets);  // long work should not end in a wrong name
  std::optional<AtomicFile> csv, json;
  for (const std::string& file : options.files) {
    refuse_same_file(file, options.csv);
    refuse_same_file(file, options.json);
  }
  refuse_same_file(options.csv, options.json);
  for (const std::string& output : {options.csv, options.json})
    if (output == "-")
      throw Failure(ExitCode::usage,
                    "--csv and --json take names of files; for standard output, /dev/stdout");
  if (!options.csv.empty()) csv.emplace(options.csv);
  if (!options.json.empty()) json.emplace(options.json);
  tetbench::StressResult result;
  {
    TerminalProgress progress(true, true);
    result = tetbench::stress(options.files, options.stress_options, progress);
  }
  if (csv) csv->write(tetbench::stress_csv(result));
  if (json) json->write(tetbench::stress_json(result, options.stress_options));
  if (csv) csv->commit();
  if (json) json->commit();
  Output::standard().write(tetbench::stress_table(result, options.stress_options));
  return static_cast<int>(result.total().failures() == 0 ? ExitCode::ok : ExitCode::differs);
}

std::string sets_text() {
  std::string text = "Sets of rays (--sets), each around every file:\n";
  for (const tetbench::RaySet& set : tetbench::ray_sets()) {
    std::string name = std::string("  ") + set.name;
    name.resize(18, ' ');
    text += name + set.description + "\n";
  }
  return text;
}

}  // namespace

void add_bench_command(CLI::App& app, std::function<int()>& run) {
  const auto options = std::make_shared<BenchOptions>();
  tetbench::StressOptions& stress = options->stress_options;
  CLI::App* verb = app.add_subcommand(
      "bench", "Measure: cost of opening and of camera rays, or, with --stress, whether every ray is right.");
  verb->add_option("FILE", options->files, "Tet files; one without --stress")->required();
  verb->add_option("--other", options->other, "The same mesh in the other layout, to be timed beside FILE")
      ->type_name("FILE");
  CLI::Option* size =
      verb->add_option("--size", options->series.size, "Width and height of each view, in rays")
          ->check(CLI::Range(1, 10000))
          ->type_name("N")
          ->capture_default_str();
  CLI::Option* repeats =
      verb->add_option("--repeats", options->series.repeats, "How often each measurement is made")
          ->check(CLI::Range(1, 1000))
          ->type_name("N")
          ->capture_default_str();
  CLI::Option* fov =
      verb->add_option_function<std::string>(
              "--fov",
              [options](const std::string& text) {
                const auto degrees = parse_double(text);  // CLI11's ranges let nan pass
                if (!degrees || !(*degrees >= 1 && *degrees <= 170))
                  throw CLI::ValidationError("--fov", "expected 1 to 170 degrees, found '" + text + "'");
                options->series.field_of_view = *degrees;
              },
              "Field of view, degrees [45]")
          ->type_name("DEGREES");
  CLI::Option* stress_flag = verb->add_flag(
      "--stress", options->stress,
      "Hold first hits, all hits, occlusion and secondary rays against exact arithmetic, in both layouts");
  CLI::Option* rays =
      verb->add_option("--rays", stress.rays, "Stress: rays in all, over all files and sets [4000000]")
          ->check(CLI::Range(std::uint64_t{1}, std::uint64_t{1} << 40U))
          ->type_name("N");
  CLI::Option* sets = verb->add_option("--sets", stress.sets, "Stress: which sets, separated by commas [all]")
                          ->delimiter(',')
                          ->allow_extra_args(false)
                          ->type_name("A,B");
  CLI::Option* seed =
      verb->add_option_function<std::string>(
              "--seed",
              [options](const std::string& text) {
                const auto whole = parse_whole(text);
                if (!whole)
                  throw CLI::ValidationError(
                      "--seed", "expected a whole number from 0 to 2^64 - 1, found '" + text + "'");
                options->stress_options.seed = *whole;
              },
              "Stress: what rays are drawn from, 0 to 2^64 - 1 [1]")
          ->type_name("S");
  CLI::Option* threads =
      verb->add_option("--threads", stress.threads,
                       "Stress: threads to use [all]; what is found is the same for any number")
          ->check(CLI::Range(1, kMaxThreads))
          ->type_name("N");
  verb->add_option("--csv", options->csv, "Stress: a line a file and set")->type_name("NAME");
  verb->add_option("--json", options->json, "Stress: everything, with up to 10 reproducers a file and set")
      ->type_name("NAME");
  // What one of the two measurements does not look at is refused, not ignored.
  for (CLI::Option* option : {rays, sets, seed, threads}) option->needs(stress_flag);
  for (CLI::Option* option : {size, repeats, fov}) option->excludes(stress_flag);
  verb->footer(sets_text() +
               "Counted as failures: wrong (face, side, tetrahedra, t more than 4 ulp off above 1 degree, u, "
               "v), missed,\n"
               "false (a hit where there is none), double (all hits: twice, out of order, odd through a "
               "closed surface),\n"
               "hung, started (a place given to a tetrahedron that does not contain it), self (a ray met the "
               "face that it\n"
               "leaves), differ (layouts, checked and unchecked view, bases, arithmetics). Counted for "
               "comparison: fl.wrong\n"
               "and lost, of the float kernel; Embree, where built in. double2, exact, tied: share of signs "
               "that needed it.\n"
               "Times without --stress are of one thread; compare them with each other, within one run.\n"
               "\n"
               "Exit codes: 0 done, and no failure; 1 usage; 2 a file cannot be read or written; 3 a broken "
               "tet file;\n"
               "5 a file that this version cannot test, such as one that leaves space out; 7 the exact "
               "kernel differs\n"
               "from the truth.\n"
               "\n"
               "Examples:\n"
               "  tet bench bunny20.tet --other bunny16.tet\n"
               "  tet bench --stress bunny.tet part.tet --rays 10000000 --json stress.json\n"
               "  tet bench --stress bunny.tet --sets vertices,bounces --seed 7");
  verb->callback([options, &run] {
    run = [options] { return options->stress ? run_stress(*options) : run_camera(*options); };
  });
}

}  // namespace tetprep
