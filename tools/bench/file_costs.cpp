// SPDX-License-Identifier: AGPL-3.0-or-later
#include "bench/bench.hpp"
#include "bench/statistics.hpp"
#include "bench/text.hpp"
#include "common/failure.hpp"
#include "common/output.hpp"
#include "tetfmt/mapped_file.hpp"

namespace tetbench {

void file_costs(const std::string& path, int repeats) {
  std::vector<double> open, check;
  double tets = 0;
  for (int i = 0; i < repeats; ++i) {
    open.push_back(1e3 * seconds([&] {
                     const auto file = tetfmt::MappedFile::open(path);
                     if (!file)
                       throw tetprep::Failure(tetprep::ExitCode::io, tetfmt::to_string(file.error()));
                     const auto view = tetfmt::FileView::open(file->bytes());
                     if (!view)
                       throw tetprep::Failure(tetprep::ExitCode::invalid, tetfmt::to_string(view.error()));
                     tets = view->tet_count();
                   }));
    const auto file = tetfmt::MappedFile::open(path);
    check.push_back(tets / 1e6 / seconds([&] {
                      if (!tetfmt::validate(file->bytes()).valid())
                        throw tetprep::Failure(tetprep::ExitCode::invalid, path + ": run `tet validate`");
                    }));
  }
  const auto print = [](const std::string& line) { tetprep::Output::standard().write(line); };
  print(format("%s: %.0f tets\n", path.c_str(), tets));
  print(format("  map and open, ms                        %s\n", text(summarize(open), 3).c_str()));
  print(format("  validate at geometry, million tets a s  %s\n", text(summarize(check), 2).c_str()));
}

}  // namespace tetbench
