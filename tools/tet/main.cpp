// SPDX-License-Identifier: AGPL-3.0-or-later
// The `tet` command: parse, run one verb, turn every way to fail into one line and an exit code.
#include <csignal>
#include <exception>
#include <iostream>
#include <new>
#include <sstream>

#include "common/failure.hpp"
#include "common/output.hpp"
#include "tet/command.hpp"
#include "tetfmt/version.hpp"

namespace {

using namespace tetprep;

constexpr const char* kVersion = "tet " TETFMT_VERSION
#ifdef TETFMT_HAVE_CONVERT
                                 " (with converter)";
#else
                                 " (without converter)";
#endif

constexpr const char* kFooter =
    "Exit codes:\n"
    "  0  all is well\n"
    "  1  usage: the command line is wrong\n"
    "  2  input or output: a file cannot be read or written\n"
    "  3  invalid: the contents of an input are wrong\n"
    "  4  runtime: something that should have worked did not (out of memory, a stage died)\n"
    "  5  unsupported: sound input that this build or version cannot handle\n"
    "  7  differs: a comparison found a difference\n"
    "Data goes to standard output, messages to standard error, one line a problem.\n"
    "\n"
    "Examples:\n"
    "  tet sample torus-knot -o knot.obj      make a surface\n"
    "  tet convert knot.obj -o knot.tet       fill its box with tetrahedra\n"
    "  tet validate knot.tet                  prove the file; silent when all is well\n"
    "  tet info knot.tet                      what is inside\n"
    "  tet trace knot.tet -o knot.png         a picture\n"
    "  tet query knot.tet --rays rays.csv --hits -\n"
    "  tet extract knot.tet --surface back.ply\n"
    "  tet bench --stress knot.tet            hold every kind of ray against exact arithmetic\n"
    "\n"
    "`tet VERB --help` tells more about each.";

int report(const std::string& who, ExitCode code, const std::string& message) {
  std::cerr << who << ": " << one_line(message) << '\n';
  return static_cast<int>(code);
}

/// "tet" or "tet VERB", as far as the command line got.
std::string speaker(const CLI::App& app) {
  const auto verbs = app.get_subcommands();
  return verbs.empty() ? "tet" : "tet " + verbs.front()->get_name();
}

int parse_and_run(int argc, char** argv, CLI::App& app, std::function<int()>& run) {
  try {
    app.parse(argc, argv);
  } catch (const CLI::Success& wish) {  // --help and --version
    std::ostringstream text;
    app.exit(wish, text, text);
    Output::standard().write(text.str());
    return static_cast<int>(ExitCode::ok);
  } catch (const CLI::ParseError& error) {
    const std::string who = speaker(app);
    // CLI11 only misses a verb here; what stands in its place is what to tell.
    const auto rest = app.remaining();
    if (app.get_subcommands().empty() && !rest.empty() && !rest.front().starts_with("-"))
      return report(who, ExitCode::usage, "unknown verb '" + rest.front() + "' (see `tet --help`)");
    return report(who, ExitCode::usage, std::string(error.what()) + " (see `" + who + " --help`)");
  }
  return run();
}

}  // namespace

int main(int argc, char** argv) {
  // A reader that goes away must not kill us between creating a temporary and removing it: writes fail with
  // EPIPE instead, and the process ends by the signal after everything is cleaned up.
  std::signal(SIGPIPE, SIG_IGN);
  std::signal(SIGXFSZ, SIG_IGN);  // a limit on file sizes likewise: writes fail with EFBIG

  CLI::App app{"Compact tetrahedral meshes for ray tracing: make, prove, inspect and trace tet files."};
  std::function<int()> run;
  try {
    app.name("tet");
    app.set_version_flag("--version", kVersion);
    app.set_help_flag("-h,--help", "Show this text");
    app.footer(kFooter);
    app.require_subcommand(1);
    add_convert_command(app, run);
    add_validate_command(app, run);
    add_info_command(app, run);
    add_extract_command(app, run);
    add_trace_command(app, run);
    add_query_command(app, run);
    add_sample_command(app, run);
    add_bench_command(app, run);
    return parse_and_run(argc, argv, app, run);
  } catch (const OutputClosed&) {
    std::signal(SIGPIPE, SIG_DFL);
    std::raise(SIGPIPE);
  } catch (const Failure& failure) {
    return report(speaker(app), failure.code(), failure.what());
  } catch (const std::bad_alloc&) {
    return report(speaker(app), ExitCode::runtime, "out of memory; try a smaller input or a larger machine");
  } catch (const std::exception& error) {
    return report(speaker(app), ExitCode::runtime, std::string("unexpected: ") + error.what());
  } catch (...) {
    return report(speaker(app), ExitCode::runtime, "unexpected failure of unknown kind");
  }
  return static_cast<int>(ExitCode::runtime);
}
