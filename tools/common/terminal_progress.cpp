// SPDX-License-Identifier: AGPL-3.0-or-later
#include "common/terminal_progress.hpp"

#include <signal.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>

namespace tetprep {
namespace {

constexpr int kBarWidth = 24;

int columns_of_terminal() {
  winsize size{};
  return ioctl(STDERR_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 0 ? size.ws_col : 80;
}

/// "7 s", "3 min 20 s", "2 h 5 min": as exact as a person wants it.
std::string duration(double seconds) {
  const auto whole = static_cast<long>(seconds + 0.5);
  if (whole < 60) return std::to_string(whole) + " s";
  if (whole < 3600) return std::to_string(whole / 60) + " min " + std::to_string(whole % 60) + " s";
  return std::to_string(whole / 3600) + " h " + std::to_string(whole / 60 % 60) + " min";
}

void print(const std::string& text) {
  // Progress that cannot be shown is no error.
  [[maybe_unused]] const auto ignored = write(STDERR_FILENO, text.data(), text.size());
}

}  // namespace

std::string progress_line(const std::string& stage, double done, double seconds, int columns) {
  std::string line = stage;
  const double share = std::min(done, 1.0);
  if (share >= 0) {
    const auto filled = static_cast<std::size_t>(share * kBarWidth);
    line += "  [" + std::string(filled, '#') + std::string(kBarWidth - filled, ' ') + "] " +
            std::to_string(static_cast<int>(share * 100)) + " %";
  }
  line += "  " + duration(seconds);
  // The first moments of a stage say little of the rest.
  if (share >= 0.02 && share < 1 && seconds >= 1)
    line += ", about " + duration(seconds * (1 - share) / share) + " left";
  return line.substr(0, static_cast<std::size_t>(std::max(columns, 0)));
}

TerminalProgress::TerminalProgress(bool wanted, bool lines)
    : bar_(wanted && isatty(STDERR_FILENO) == 1), lines_(wanted && lines && !bar_) {
  if (!bar_) return;
  // Signals are for threads that somebody gave a mask.
  sigset_t all, before;
  sigfillset(&all);
  pthread_sigmask(SIG_SETMASK, &all, &before);
  thread_ = std::thread([this] { redraw_until_told(); });
  pthread_sigmask(SIG_SETMASK, &before, nullptr);
}

TerminalProgress::~TerminalProgress() {
  if (!bar_) return;
  {
    const std::lock_guard lock(mutex_);
    ending_ = true;
  }
  told_.notify_one();
  thread_.join();
  if (!stage_.empty()) print("\r\x1b[K");
}

void TerminalProgress::stage(std::string_view name) {
  if (!bar_ && !lines_) return;
  const std::lock_guard lock(mutex_);
  stage_ = name;
  done_ = -1;
  stage_started_ = Clock::now();
  if (bar_) {
    draw();
  } else {
    char time[32];
    std::snprintf(time, sizeof time, "%9.3f s  ",
                  std::chrono::duration<double>(stage_started_ - started_).count());
    print(time + stage_ + "\n");
  }
}

void TerminalProgress::fraction(double done) {
  if (!bar_) return;
  const std::lock_guard lock(mutex_);
  done_ = std::max(done, 0.0);
}

void TerminalProgress::print_line(const std::string& line) {
  const std::lock_guard lock(mutex_);
  print((bar_ ? "\r\x1b[K" : "") + line + "\n");
  if (bar_ && !stage_.empty()) draw();
}

void TerminalProgress::redraw_until_told() {
  std::unique_lock lock(mutex_);
  while (!told_.wait_for(lock, std::chrono::milliseconds(200), [this] { return ending_; }))
    if (!stage_.empty()) draw();
}

void TerminalProgress::draw() {
  const double seconds = std::chrono::duration<double>(Clock::now() - stage_started_).count();
  // To the line's start, the line, and clear what an older one leaves behind it. The last column stays free:
  // some terminals wrap there.
  print("\r" + progress_line(stage_, done_, seconds, columns_of_terminal() - 1) + "\x1b[K");
}

}  // namespace tetprep
