// SPDX-License-Identifier: AGPL-3.0-or-later
#include "bench/statistics.hpp"

#include <time.h>

#include <algorithm>
#include <cstdio>

#include "bench/dice.hpp"

namespace tetbench {

Summary summarize(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  const std::size_t n = values.size();
  return {values.front(), (values[(n - 1) / 2] + values[n / 2]) / 2, values.back()};
}

Summary ratio(const std::vector<double>& a, const std::vector<double>& b, std::uint64_t seed) {
  constexpr std::size_t kDraws = 1000;
  std::vector<double> ratios;
  for (std::size_t i = 0; i < a.size(); ++i) ratios.push_back(a[i] / b[i]);
  Dice dice({seed});
  std::vector<double> medians, drawn(ratios.size());
  for (std::size_t k = 0; k < kDraws; ++k) {
    for (double& value : drawn) value = ratios[dice.below(ratios.size())];
    medians.push_back(summarize(drawn).median);
  }
  std::sort(medians.begin(), medians.end());
  return {medians[kDraws / 40], summarize(std::move(ratios)).median, medians[kDraws - 1 - kDraws / 40]};
}

std::string text(const Summary& summary, int digits) {
  char buffer[96];
  std::snprintf(buffer, sizeof(buffer), "%.*f (%.*f .. %.*f)", digits, summary.median, digits, summary.low,
                digits, summary.high);
  return buffer;
}

namespace {

double seconds_of(clockid_t clock) {
  timespec now{};
  clock_gettime(clock, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

}  // namespace

double thread_seconds() {
  return seconds_of(CLOCK_THREAD_CPUTIME_ID);
}
double process_seconds() {
  return seconds_of(CLOCK_PROCESS_CPUTIME_ID);
}

}  // namespace tetbench
