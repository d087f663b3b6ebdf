// SPDX-License-Identifier: AGPL-3.0-or-later
// Standard output that notices when writing fails: a full disk is an error, a closed pipe a quiet end.
#pragma once

#include <string>
#include <string_view>

namespace tetprep {

/// Thrown when the reader of a pipe has gone. Not a Failure: main() ends the process quietly.
struct OutputClosed {};

/// A file descriptor to write data to, unbuffered (hand it large pieces). Needs SIGPIPE ignored.
class Output {
 public:
  static Output standard() { return Output(1, "standard output"); }
  /// Does not own `descriptor`. `name` is used in messages.
  Output(int descriptor, std::string name) : descriptor_(descriptor), name_(std::move(name)) {}

  /// Writes all of `data`. Throws Failure (io) with the system's reason, or OutputClosed.
  void write(std::string_view data) const;

 private:
  int descriptor_;
  std::string name_;
};

/// `text` with control characters escaped as \xNN, so that a message stays on one line whatever a file is
/// named.
std::string one_line(std::string_view text);

}  // namespace tetprep
