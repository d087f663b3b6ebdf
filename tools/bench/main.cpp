// SPDX-License-Identifier: AGPL-3.0-or-later
// Measures what the project claims. Ratios of one run; absolute times mean something only beside each other.
#include <CLI/CLI.hpp>
#include <cstdio>
#include <optional>

#include "bench/bench.hpp"
#include "common/failure.hpp"
#include "tetfmt/mapped_file.hpp"

namespace {

using tetprep::ExitCode;
using tetprep::Failure;

struct OpenFile {
  tetfmt::MappedFile file;
  tetfmt::TrustedView view;
};

OpenFile open_trusted(const std::string& path) {
  auto file = tetfmt::MappedFile::open(path);
  if (!file) throw Failure(ExitCode::io, tetfmt::to_string(file.error()));
  auto view = tetfmt::TrustedView::validated(file->bytes());
  if (!view) throw Failure(ExitCode::invalid, path + ": " + tetfmt::to_string(view.error()));
  return {std::move(file).value(), std::move(view).value()};
}

int run(int argc, char** argv) {
  CLI::App app(
      "Times a tet file: opening, validating, and camera rays from far to touching against Embree's\n"
      "rtcIntersect1 on the same rays. Example:\n"
      "  tet-bench armadillo20.tet --other armadillo16.tet");
  std::string path, other;
  tetbench::CameraSeries series;
  app.add_option("FILE", path, "the tet file")->required();
  app.add_option("--other", other, "the same mesh in the other layout");
  app.add_option("--size", series.size, "width and height of each view, in rays")
      ->check(CLI::Range(1, 10000))
      ->capture_default_str();
  app.add_option("--repeats", series.repeats, "how often each measurement is made")
      ->check(CLI::Range(1, 1000))
      ->capture_default_str();
  app.add_option("--fov", series.field_of_view, "field of view, degrees")
      ->check(CLI::Range(1.0, 170.0))
      ->capture_default_str();
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : static_cast<int>(ExitCode::usage);
  }
  tetbench::file_costs(path, series.repeats);
  if (!other.empty()) tetbench::file_costs(other, series.repeats);
  const OpenFile first = open_trusted(path);
  std::optional<OpenFile> second;
  if (!other.empty()) second.emplace(open_trusted(other));
  tetbench::camera_series(first.view, second ? &second->view : nullptr, series);
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  try {
    return run(argc, argv);
  } catch (const Failure& failure) {
    std::fprintf(stderr, "tet-bench: %s\n", failure.what());
    return static_cast<int>(failure.code());
  } catch (const std::exception& error) {
    std::fprintf(stderr, "tet-bench: %s\n", error.what());
    return static_cast<int>(ExitCode::runtime);
  }
}
