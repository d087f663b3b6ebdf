// SPDX-License-Identifier: AGPL-3.0-or-later
#include "common/terminal_progress.hpp"

#include <unistd.h>

#include <algorithm>
#include <iostream>

namespace tetprep {

TerminalProgress::TerminalProgress(bool wanted) : active_(wanted && isatty(STDERR_FILENO) == 1) {}

TerminalProgress::~TerminalProgress() {
  if (active_ && !stage_.empty()) draw("");
}

void TerminalProgress::stage(std::string_view name) {
  if (!active_) return;
  const std::lock_guard lock(mutex_);
  stage_ = name;
  drawn_ = Clock::now();
  draw(stage_ + " ...");
}

void TerminalProgress::fraction(double done) {
  if (!active_) return;
  const std::lock_guard lock(mutex_);
  const auto now = Clock::now();
  if (now - drawn_ < std::chrono::milliseconds(100)) return;
  drawn_ = now;
  draw(stage_ + " " + std::to_string(static_cast<int>(std::clamp(done, 0.0, 1.0) * 100)) + " %");
}

void TerminalProgress::draw(const std::string& line) {
  std::cerr << "\r\x1b[K" << line << std::flush;  // to the line's start, and clear to its end
}

}  // namespace tetprep
