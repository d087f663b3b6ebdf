// SPDX-License-Identifier: AGPL-3.0-or-later
// What each stage of the conversion cost.
#pragma once

#include <chrono>
#include <string>
#include <utility>
#include <vector>

#include "common/progress.hpp"

namespace tetprep {

struct StageCost {
  std::string name;
  double seconds = 0;
  double peak_memory_mb = 0;  ///< largest resident size of the process that did it, in units of 10^6 bytes
};

/// Largest resident size of this process since reset_peak_memory(), or since its start where the kernel does
/// not allow the reset. Units of 10^6 bytes.
double peak_memory_mb();
void reset_peak_memory();

/// Collects costs. Stages are consecutive; `begin` ends the one before.
class StageLog {
 public:
  explicit StageLog(Progress& progress) : progress_(progress) {}
  void begin(std::string name);
  void end();
  /// A stage that another process ran and measured.
  void add(StageCost cost) { costs_.push_back(std::move(cost)); }
  const std::vector<StageCost>& costs() const { return costs_; }

 private:
  using Clock = std::chrono::steady_clock;
  Progress& progress_;
  std::vector<StageCost> costs_;
  std::string name_;
  Clock::time_point started_{};
};

}  // namespace tetprep
