// SPDX-License-Identifier: MIT
#include "tetfmt/error.hpp"

#include <array>

namespace tetfmt {
namespace {

struct Row {
  Code code;
  const char* name;
  Level level;
  const char* meaning;
};

constexpr Row kTable[] = {
#define TETFMT_ISSUE(number, name, level, meaning) {Code::name, #name, Level::level, meaning},
#include "tetfmt/issues.def"
#undef TETFMT_ISSUE
};

const Row& row(Code code) {
  for (const Row& candidate : kTable)
    if (candidate.code == code) return candidate;
  static constexpr Row kUnknown = {Code{}, "unknown", Level::structure, "not a code of this version"};
  return kUnknown;
}

}  // namespace

const char* level_name(Level level) {
  constexpr std::array<const char*, kLevelCount> kNames = {"structure", "checksum", "topology", "geometry"};
  return kNames[static_cast<std::size_t>(level)];
}

const char* code_name(Code code) {
  return row(code).name;
}
const char* code_meaning(Code code) {
  return row(code).meaning;
}
Level code_level(Code code) {
  return row(code).level;
}

std::string to_string(const Error& error) {
  return std::to_string(static_cast<int>(error.code)) + " " + code_name(error.code) + " at " +
         std::to_string(error.where) + ": " + error.text;
}

}  // namespace tetfmt
