// SPDX-License-Identifier: AGPL-3.0-or-later
// What long work shows of itself: a bar on a terminal, lines elsewhere if asked for.
#pragma once

#include <chrono>
#include <condition_variable>
#include <mutex>
#include <string>
#include <thread>

#include "common/progress.hpp"

namespace tetprep {

/// On a terminal: keeps one line of standard error up to date (stage, bar where the share is known, time
/// spent in the stage and an estimate of what is left), redrawn a few times a second even when nothing is
/// reported, and wipes it when destroyed. Elsewhere: nothing, or a line a stage.
///
/// May be called from several threads. One at a time: two would overwrite each other's line. Its own thread
/// takes no lock but its own, so that a process may be forked meanwhile.
class TerminalProgress : public Progress {
 public:
  /// `lines`: where standard error is no terminal, a line at the start of each stage.
  explicit TerminalProgress(bool wanted = true, bool lines = false);
  ~TerminalProgress() override;
  TerminalProgress(const TerminalProgress&) = delete;
  TerminalProgress& operator=(const TerminalProgress&) = delete;

  void stage(std::string_view name) override;
  void fraction(double done) override;

  /// A line of standard error that stays, whatever is shown or not.
  void print_line(const std::string& line);

 private:
  using Clock = std::chrono::steady_clock;
  void redraw_until_told();
  void draw();

  const bool bar_, lines_;
  const Clock::time_point started_ = Clock::now();
  std::mutex mutex_;
  std::condition_variable told_;
  bool ending_ = false;
  std::string stage_;
  double done_ = -1;  ///< of the stage; negative: not known
  Clock::time_point stage_started_{};
  std::thread thread_;  ///< last: it uses the members above
};

/// The line's text, at most `columns` characters: "name  [####    ] 50 %  3 s, about 3 s left". `done` is
/// negative where it is not known.
std::string progress_line(const std::string& stage, double done, double seconds, int columns);

}  // namespace tetprep
