// SPDX-License-Identifier: AGPL-3.0-or-later
#include "common/same_file.hpp"

#include <filesystem>

#include "common/failure.hpp"

namespace tetprep {

bool same_file(const std::string& a, const std::string& b) {
  if (a.empty() || b.empty() || a == "-" || b == "-") return false;
  namespace fs = std::filesystem;
  std::error_code error;
  if (fs::is_other(fs::status(b, error))) return false;
  if (fs::equivalent(a, b, error) && !error) return true;
  const auto absolute = [&](const std::string& path) {
    return fs::weakly_canonical(fs::absolute(path), error);
  };
  const fs::path first = absolute(a);
  if (error) return false;
  const fs::path second = absolute(b);
  return !error && first == second;
}

void refuse_same_file(const std::string& input, const std::string& output) {
  if (same_file(input, output))
    throw Failure(ExitCode::usage, output + ": is the input itself; name another output");
}

}  // namespace tetprep
