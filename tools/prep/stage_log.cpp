// SPDX-License-Identifier: AGPL-3.0-or-later
#include "prep/stage_log.hpp"

#include <fstream>

namespace tetprep {

double peak_memory_mb() {
  std::ifstream status("/proc/self/status");
  std::string key;
  while (status >> key) {
    double kib = 0;
    if (key == "VmHWM:" && status >> kib) return kib * 1024e-6;
    std::getline(status, key);
  }
  return 0;
}

void reset_peak_memory() {
  std::ofstream("/proc/self/clear_refs") << '5';
}

void StageLog::begin(std::string name) {
  end();
  progress_.stage(name);
  name_ = std::move(name);
  reset_peak_memory();
  started_ = Clock::now();
}

void StageLog::end() {
  if (name_.empty()) return;
  const std::chrono::duration<double> spent = Clock::now() - started_;
  costs_.push_back({std::exchange(name_, {}), spent.count(), peak_memory_mb()});
}

}  // namespace tetprep
