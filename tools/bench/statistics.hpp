// SPDX-License-Identifier: AGPL-3.0-or-later
// What is said of repeated measurements: median and spread.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace tetbench {

struct Summary {
  double low = 0, median = 0, high = 0;
};

/// Of at least one value; O(n log n).
Summary summarize(std::vector<double> values);

/// The median of the ratios a[i] / b[i] of measurements that were made in turn, so that a drift of the
/// machine's speed meets both; low and high are the ends of its interval of 95 % confidence by the bootstrap
/// (Efron 1979): medians of 1000 draws with replacement. The same seed, the same interval. Of few
/// measurements that is hardly narrower than their range, and no promise.
Summary ratio(const std::vector<double>& a, const std::vector<double>& b, std::uint64_t seed);

/// "0.83 (0.81 .. 0.86)"
std::string text(const Summary& summary, int digits);

/// Seconds of processor time that this thread has used: what other programs do on the machine is not counted.
double thread_seconds();

/// The same of all threads of this process.
double process_seconds();

/// Processor time that `work` takes on this thread.
template <class Work>
double seconds(Work&& work) {
  const double start = thread_seconds();
  work();
  return thread_seconds() - start;
}

/// Processor time that `work` takes, on whichever threads.
template <class Work>
double process_seconds(Work&& work) {
  const double start = process_seconds();
  work();
  return process_seconds() - start;
}

}  // namespace tetbench
