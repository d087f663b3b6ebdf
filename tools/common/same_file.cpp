// SPDX-License-Identifier: AGPL-3.0-or-later
#include "common/same_file.hpp"

#include <filesystem>

#include "common/failure.hpp"

namespace tetprep {

void refuse_same_file(const std::string& input, const std::string& output) {
  if (input == "-" || output == "-") return;
  std::error_code error;
  if (std::filesystem::equivalent(input, output, error) && !error)
    throw Failure(ExitCode::usage, output + ": is the input itself; name another output");
}

}  // namespace tetprep
