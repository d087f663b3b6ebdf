// SPDX-License-Identifier: AGPL-3.0-or-later
// What is said of repeated measurements: median and spread.
#pragma once

#include <chrono>
#include <string>
#include <vector>

namespace tetbench {

struct Summary {
  double low = 0, median = 0, high = 0;
};

/// Of at least one value; O(n log n).
Summary summarize(std::vector<double> values);

/// Element by element: a[i] / b[i], of measurements that were made in turn, so that a drift of the machine's
/// speed meets both.
Summary ratio(const std::vector<double>& a, const std::vector<double>& b);

/// "0.83 (0.81 .. 0.86)"
std::string text(const Summary& summary, int digits);

/// Seconds that `work` takes.
template <class Work>
double seconds(Work&& work) {
  const auto start = std::chrono::steady_clock::now();
  work();
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

}  // namespace tetbench
