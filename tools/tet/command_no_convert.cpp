// SPDX-License-Identifier: AGPL-3.0-or-later
// Stands in for command_convert.cpp in builds without the converter (TETFMT_BUILD_CONVERT=OFF).
#include "common/failure.hpp"
#include "tet/command.hpp"

namespace tetprep {

void add_convert_command(CLI::App& app, std::function<int()>& run) {
  CLI::App* verb = app.add_subcommand("convert", "Surface mesh to tet file (not in this build)");
  verb->allow_extras();
  verb->callback([&run] {
    run = []() -> int {
      throw Failure(ExitCode::unsupported,
                    "this build has no converter; configure with -DTETFMT_BUILD_CONVERT=ON to get one");
    };
  });
}

}  // namespace tetprep
