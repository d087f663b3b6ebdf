// SPDX-License-Identifier: MIT
// Where the checks put what they find.
#pragma once

#include <string>
#include <utility>

#include "tetfmt/validate.hpp"

namespace tetfmt::detail {

/// Counts every problem and writes out the first few of each code. `make_text` is only called for those, so
/// that a file with a million problems costs a million increments, not a million strings.
template <class MakeText>
void add_issue(Report& report, Code code, std::uint64_t where, MakeText&& make_text) {
  IssueGroup& group = report.issues[code];
  ++group.count;
  if (group.examples.size() < Report::kExamples) group.examples.push_back({code, where, make_text()});
}

/// The problem that a function which returns only one should return: the first of the lowest code.
inline Error first_issue(const Report& report) {
  return report.issues.begin()->second.examples.front();
}

inline std::string str(std::uint64_t value) {
  return std::to_string(value);
}

}  // namespace tetfmt::detail
