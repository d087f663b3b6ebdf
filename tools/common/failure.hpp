// SPDX-License-Identifier: AGPL-3.0-or-later
// How the tools fail: one exception type that carries the exit code and one line for the user.
#pragma once

#include <stdexcept>
#include <string>

namespace tetprep {

/// Exit codes of `tet`; documented in README and `tet --help`, stable.
enum class ExitCode : int {
  ok = 0,
  usage = 1,        ///< the command line is wrong
  io = 2,           ///< a file cannot be read or written
  invalid = 3,      ///< the input's contents are wrong
  runtime = 4,      ///< something that should have worked did not (TetGen died, out of memory, out of time)
  unsupported = 5,  ///< sound input that this version cannot handle
  differs = 7,      ///< a comparison found a difference
};

/// Thrown by the tools, never by libtetfmt. what() is one line: what, where (file:line or element), what to
/// do.
class Failure : public std::runtime_error {
 public:
  Failure(ExitCode code, const std::string& message) : std::runtime_error(message), code_(code) {}
  ExitCode code() const { return code_; }

 private:
  ExitCode code_;
};

}  // namespace tetprep
