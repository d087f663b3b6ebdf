// SPDX-License-Identifier: AGPL-3.0-or-later
#include "bench/statistics.hpp"

#include <time.h>

#include <algorithm>
#include <cstdio>

namespace tetbench {

Summary summarize(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  const std::size_t n = values.size();
  return {values.front(), (values[(n - 1) / 2] + values[n / 2]) / 2, values.back()};
}

Summary ratio(const std::vector<double>& a, const std::vector<double>& b) {
  std::vector<double> ratios;
  for (std::size_t i = 0; i < a.size(); ++i) ratios.push_back(a[i] / b[i]);
  return summarize(std::move(ratios));
}

std::string text(const Summary& summary, int digits) {
  char buffer[96];
  std::snprintf(buffer, sizeof(buffer), "%.*f (%.*f .. %.*f)", digits, summary.median, digits, summary.low,
                digits, summary.high);
  return buffer;
}

double thread_seconds() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

}  // namespace tetbench
