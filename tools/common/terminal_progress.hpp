// SPDX-License-Identifier: AGPL-3.0-or-later
// Stage names and percentages on a terminal; nothing where standard error is a file or a pipe.
#pragma once

#include <chrono>
#include <mutex>
#include <string>

#include "common/progress.hpp"

namespace tetprep {

/// Keeps one line of standard error up to date, at most ten times a second, and wipes it when destroyed. May
/// be called from several threads. One at a time: two would overwrite each other's line.
class TerminalProgress : public Progress {
 public:
  /// Active if `wanted` and standard error is a terminal.
  explicit TerminalProgress(bool wanted = true);
  ~TerminalProgress() override;
  TerminalProgress(const TerminalProgress&) = delete;
  TerminalProgress& operator=(const TerminalProgress&) = delete;

  void stage(std::string_view name) override;
  void fraction(double done) override;

 private:
  void draw(const std::string& line);

  using Clock = std::chrono::steady_clock;
  const bool active_;
  std::mutex mutex_;
  std::string stage_;
  Clock::time_point drawn_{};
};

}  // namespace tetprep
