// SPDX-License-Identifier: AGPL-3.0-or-later
#include "bench/provenance.hpp"

#include <fstream>
#include <thread>

#include "tetfmt/version.hpp"

namespace tetbench {
namespace {

std::string processor() {
  std::ifstream info("/proc/cpuinfo");
  for (std::string line; std::getline(info, line);)
    if (line.starts_with("model name"))
      if (const auto colon = line.find(": "); colon != std::string::npos) return line.substr(colon + 2);
  return "unknown";
}

#ifdef __clang__
constexpr const char* kCompiler = "clang " __clang_version__;
#else
constexpr const char* kCompiler = "g++ " __VERSION__;
#endif

}  // namespace

std::vector<std::pair<std::string, std::string>> provenance() {
  return {{"version", TETFMT_VERSION},
          {"commit", TETFMT_COMMIT},
          {"compiler", kCompiler},
          {"build", TETFMT_BUILD_TYPE},
          {"flags", TETFMT_FLAGS},
          {"processor", processor()},
          {"hardware_threads", std::to_string(std::thread::hardware_concurrency())}};
}

std::string provenance_text() {
  std::string text;
  for (const auto& [name, value] : provenance()) text += name + ": " + value + "\n";
  return text;
}

}  // namespace tetbench
