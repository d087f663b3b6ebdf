// SPDX-License-Identifier: AGPL-3.0-or-later
// `tet bench`: measures what the project claims, on the user's own files and machine.
#include <filesystem>
#include <memory>
#include <optional>

#include "bench/convert_costs.hpp"
#include "bench/race.hpp"
#include "bench/stress.hpp"
#include "common/atomic_file.hpp"
#include "common/failure.hpp"
#include "common/output.hpp"
#include "common/parse.hpp"
#include "common/same_file.hpp"
#include "common/terminal_progress.hpp"
#include "common/threads.hpp"
#include "tet/command.hpp"

namespace tetprep {
namespace {

struct BenchOptions {
  std::vector<std::string> files;
  std::string csv, json, pictures;
  tetbench::RaceOptions race;
  bool quick = false, stress = false, convert = false;
  tetbench::StressOptions stress_options;
};

/// The files to write, made before long work and filled after it.
struct Outputs {
  std::optional<AtomicFile> csv, json;
  explicit Outputs(const BenchOptions& options) {
    for (const std::string& file : options.files) {
      refuse_same_file(file, options.csv);
      refuse_same_file(file, options.json);
    }
    if (same_file(options.csv, options.json))
      throw Failure(ExitCode::usage,
                    "--csv and --json both name " + options.json + "; give each output a file of its own");
    for (const std::string& output : {options.csv, options.json})
      if (output == "-")
        throw Failure(ExitCode::usage,
                      "--csv and --json take names of files; for standard output, /dev/stdout");
    if (!options.csv.empty()) csv.emplace(options.csv);
    if (!options.json.empty()) json.emplace(options.json);
  }
  template <class Csv, class Json>
  void write(Csv to_csv, Json to_json) {
    if (csv) csv->write(to_csv());
    if (json) json->write(to_json());
    if (csv) csv->commit();
    if (json) json->commit();
  }
};

/// Makes the folder, if there is none, and sees that files can be made there.
void prepare_folder(const std::string& folder) {
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (!std::filesystem::is_directory(folder))
    throw Failure(ExitCode::io, folder + ": cannot make this folder" +
                                    (error ? " (" + error.message() + ")" : "") +
                                    "; --pictures takes the name of a folder");
  const AtomicFile probe(folder + "/errors.svg");  // discarded
}

int run_race(BenchOptions options) {
  tetbench::chosen_tracers(options.race.tracers);  // long work should not end in a wrong name
  tetbench::chosen_workloads(options.race.workloads);
  Outputs outputs(options);
  if (!options.pictures.empty()) prepare_folder(options.pictures);
  tetbench::RaceResult result;
  {
    TerminalProgress progress(true, true);
    result = tetbench::race(options.files, options.race, progress);
  }
  outputs.write([&] { return tetbench::race_csv(result); }, [&] { return tetbench::race_json(result); });
  Output::standard().write(tetbench::race_table(result));
  if (!options.pictures.empty())
    for (const tetbench::Picture& picture : tetbench::race_pictures(result)) {
      AtomicFile file(options.pictures + "/" + picture.name);
      file.write(picture.svg);
      file.commit();
    }
  return static_cast<int>(result.failures() == 0 ? ExitCode::ok : ExitCode::differs);
}

#ifdef TETFMT_HAVE_CONVERT
int run_convert(const BenchOptions& options) {
  Outputs outputs(options);
  const int repeats = options.race.repeats;
  std::vector<tetbench::ConvertCost> costs;
  {
    TerminalProgress progress(true, true);
    costs = tetbench::convert_costs(options.files, repeats, progress);
  }
  outputs.write([&] { return tetbench::convert_csv(costs); },
                [&] { return tetbench::convert_json(costs, repeats); });
  Output::standard().write(tetbench::convert_table(costs, repeats));
  return 0;
}
#else
int run_convert(const BenchOptions&) {
  throw Failure(ExitCode::unsupported,
                "--convert: this tet was built without its converter (TETFMT_BUILD_CONVERT=OFF)");
}
#endif

int run_stress(const BenchOptions& options) {
  tetbench::chosen_sets(options.stress_options.sets);  // long work should not end in a wrong name
  Outputs outputs(options);
  tetbench::StressResult result;
  {
    TerminalProgress progress(true, true);
    result = tetbench::stress(options.files, options.stress_options, progress);
  }
  outputs.write([&] { return tetbench::stress_csv(result); },
                [&] { return tetbench::stress_json(result, options.stress_options); });
  Output::standard().write(tetbench::stress_table(result, options.stress_options));
  return static_cast<int>(result.total().failures() == 0 ? ExitCode::ok : ExitCode::differs);
}

/// Names and descriptions, one a line.
template <class Items>
std::string names_text(const std::string& title, const Items& items) {
  std::string text = title + "\n";
  for (const auto& item : items) {
    std::string name = std::string("  ") + item.name;
    name.resize(26, ' ');
    text += name + item.description + "\n";
  }
  return text;
}

}  // namespace

void add_bench_command(CLI::App& app, std::function<int()>& run) {
  const auto options = std::make_shared<BenchOptions>();
  tetbench::StressOptions& stress = options->stress_options;
  tetbench::RaceOptions& race = options->race;
  CLI::App* verb = app.add_subcommand(
      "bench",
      "Measure: the time and the errors of tracers, ours and others; or, with --stress, whether every ray is "
      "right; or, with --convert, what converting costs.");
  const auto names = [&](const char* option, std::vector<std::string>& value, const char* description) {
    return verb->add_option(option, value, description)
        ->delimiter(',')
        ->allow_extra_args(false)
        ->type_name("A,B");
  };
  verb->add_option("FILE", options->files,
                   "Tet files; with several, cost against size. With --convert, meshes")
      ->required();
  CLI::Option* quick =
      verb->add_flag("--quick", options->quick,
                     "Small views, few repeats: two minutes for 50,000 triangles, and rough figures");
  CLI::Option* tracers = names("--tracers", race.tracers, "Which tracers, separated by commas [all]");
  CLI::Option* workloads = names("--workloads", race.workloads, "Which workloads, separated by commas [all]");
  CLI::Option* shuffle =
      verb->add_flag("--shuffled", race.shuffle, "Every workload once more with its rays in random order");
  CLI::Option* against =
      verb->add_option("--against", race.against,
                       "The tracer that ratios are to [embree-1, or the first one without Embree]")
          ->type_name("NAME");
  CLI::Option* size =
      verb->add_option("--size", race.rays.size, "Width and height of each view, in rays [1000; quick: 250]")
          ->check(CLI::Range(1, 10000))
          ->type_name("N");
  CLI::Option* repeats =
      verb->add_option("--repeats", race.repeats, "How often each measurement is made [5; quick: 3]")
          ->check(CLI::Range(1, 1000))
          ->type_name("N");
  CLI::Option* fov =
      verb->add_option_function<std::string>(
              "--fov",
              [options](const std::string& text) {
                const auto degrees = parse_double(text);  // CLI11's ranges let nan pass
                if (!degrees || !(*degrees >= 1 && *degrees <= 170))
                  throw CLI::ValidationError("--fov", "expected 1 to 170 degrees, found '" + text + "'");
                options->race.rays.field_of_view = *degrees;
              },
              "Field of view, degrees [45]")
          ->type_name("DEGREES");
  CLI::Option* sample =
      verb->add_option("--sample", race.sample,
                       "Rays of each workload for which the exact kernel itself is checked [2000]")
          ->check(CLI::Range(std::uint64_t{0}, std::uint64_t{1} << 32U))
          ->type_name("N");
  CLI::Option* pictures =
      verb->add_option(
              "--pictures", options->pictures,
              "A folder for pictures (SVG): time against errors, the camera series, cost against size")
          ->type_name("FOLDER");
  CLI::Option* stress_flag = verb->add_flag(
      "--stress", options->stress,
      "Hold first hits, all hits, occlusion and secondary rays against exact arithmetic, in both layouts");
  CLI::Option* convert_flag =
      verb->add_flag("--convert", options->convert,
                     "Time converting instead, by stage: every mesh with --optimize none, fast and best");
  CLI::Option* rays =
      verb->add_option("--rays", stress.rays, "Stress: rays in all, over all files and sets [4000000]")
          ->check(CLI::Range(std::uint64_t{1}, std::uint64_t{1} << 40U))
          ->type_name("N");
  CLI::Option* sets = names("--sets", stress.sets, "Stress: which sets, separated by commas [all]");
  CLI::Option* threads =
      verb->add_option("--threads", stress.threads,
                       "Stress: threads to use [all]; what is found is the same for any number")
          ->check(CLI::Range(1, kMaxThreads))
          ->type_name("N");
  CLI::Option* seed =
      verb->add_option_function<std::string>(
              "--seed",
              [options](const std::string& text) {
                const auto whole = parse_whole(text);
                if (!whole)
                  throw CLI::ValidationError(
                      "--seed", "expected a whole number from 0 to 2^64 - 1, found '" + text + "'");
                options->stress_options.seed = options->race.rays.seed = *whole;
              },
              "What rays are drawn from, 0 to 2^64 - 1 [1]")
          ->type_name("S");
  verb->add_option("--csv", options->csv, "A line a measurement; stress: a line a file and set")
      ->type_name("NAME");
  verb->add_option("--json", options->json, "Everything; stress: with up to 10 reproducers a file and set")
      ->type_name("NAME");
  // What a measurement does not look at is refused, not ignored.
  stress_flag->excludes(convert_flag);
  for (CLI::Option* option : {rays, sets, threads}) option->needs(stress_flag);
  repeats->excludes(stress_flag);
  for (CLI::Option* option : {quick, tracers, workloads, shuffle, against, size, fov, sample, pictures}) {
    option->excludes(stress_flag);
    option->excludes(convert_flag);
  }
  seed->excludes(convert_flag);
  verb->footer(
      names_text("Tracers (--tracers); \"embree\" names all that begin with \"embree-\":",
                 tetbench::tracer_kinds()) +
      names_text("Workloads (--workloads); \"camera\" likewise:", tetbench::workload_kinds()) +
      "Every tracer gets the same rays, in turn, and in another order each time; times are processor time "
      "of one\n"
      "thread, to be compared within one run. Wrong: another triangle than exact arithmetic has (where a ray "
      "meets an\n"
      "edge exactly, any triangle there is right), or something in the way where nothing is. Missed: "
      "nothing where\n"
      "there is something. What only touches an edge or a vertex is in the way by the exact kernel's rule "
      "for ties:\n"
      "where it is only asked whether something is in the way (ao, shadow), a peer that says otherwise "
      "counts as wrong\n"
      "or missed. Rays from surfaces start on their side of the surface exactly; peers' start at "
      "that point\n"
      "rounded to float32, and count from 0.00001 of the surface's diagonal on.\n"
      "\n" +
      names_text("Stress: sets of rays (--sets), each around every file:", tetbench::ray_sets()) +
      "Counted as failures: wrong (face, side, tetrahedra, t more than 4 ulp off above 1 degree, u, "
      "v), missed,\n"
      "false (a hit where there is none), double (all hits: twice, out of order, odd through a "
      "closed surface),\n"
      "hung, started (a place given to a tetrahedron that does not contain it), self (a ray met the "
      "face that it\n"
      "leaves), differ (layouts, checked and unchecked view, bases, arithmetics; one ray at a time, "
      "many from one\n"
      "place together, and many of any places side by side). Counted for comparison: fl.wrong and "
      "lost, of the float\n"
      "kernel; Embree, where built in. double2, exact, tied: share of signs that needed it.\n"
      "\n"
      "Exit codes: 0 done, and no failure; 1 usage; 2 a file cannot be read or written; 3 a broken "
      "tet file;\n"
      "5 a file that this version cannot test, such as one that leaves space out; 7 the exact "
      "kernel differs\n"
      "from the truth.\n"
      "\n"
      "Examples:\n"
      "  tet bench bunny.tet --quick --pictures bunny\n"
      "  tet bench small.tet medium.tet large.tet --workloads camera,ao --json growth.json\n"
      "  tet bench bunny.tet --tracers tet20-exact,embree --against embree-16 --csv bunny.csv\n"
      "  tet bench --convert bunny.ply room.obj --repeats 3\n"
      "  tet bench --stress bunny.tet part.tet --rays 10000000 --json stress.json\n"
      "  tet bench --stress bunny.tet --sets vertices,bounces --seed 7");
  verb->callback([options, size, repeats, &run] {
    if (options->quick && size->count() == 0) options->race.rays.size = 250;
    if (options->quick && repeats->count() == 0) options->race.repeats = 3;
    run = [options] {
      return options->stress    ? run_stress(*options)
             : options->convert ? run_convert(*options)
                                : run_race(*options);
    };
  });
}

}  // namespace tetprep
