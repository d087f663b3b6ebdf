// SPDX-License-Identifier: AGPL-3.0-or-later
#include "bench/tally.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace tetbench {

void UlpHistogram::add(double ulps) {
  const double fine = ulps * 16;
  std::size_t bin = kFine + 63;
  if (fine < static_cast<double>(kFine)) {
    bin = static_cast<std::size_t>(std::ceil(fine));
  } else if (std::isfinite(ulps)) {
    bin = kFine + std::min<std::size_t>(62, static_cast<std::size_t>(std::ilogb(ulps)) - 5);
  }
  ++bins_[bin];
  ++count_;
  max_ = std::max(max_, ulps);
}

void UlpHistogram::add(const UlpHistogram& more) {
  for (std::size_t i = 0; i < bins_.size(); ++i) bins_[i] += more.bins_[i];
  count_ += more.count_;
  max_ = std::max(max_, more.max_);
}

double UlpHistogram::quantile(double share) const {
  const auto wanted = static_cast<std::uint64_t>(std::ceil(share * static_cast<double>(count_)));
  std::uint64_t seen = 0;
  for (std::size_t i = 0; i < bins_.size(); ++i) {
    seen += bins_[i];
    if (seen == 0 || seen < wanted) continue;
    const double upper =
        i <= kFine ? static_cast<double>(i) / 16 : std::ldexp(1.0, static_cast<int>(i - kFine) + 6);
    return std::min(upper, max_);
  }
  return 0;
}

void Tally::add(const Tally& more) {
  rays += more.rays;
  hits += more.hits;
  crossings += more.crossings;
  leaving += more.leaving;
  for (std::size_t i = 0; i < faults.size(); ++i) faults[i] += more.faults[i];
  float_wrong += more.float_wrong;
  float_lost += more.float_lost;
  steep.add(more.steep);
  shallow.add(more.shallow);
  signs.in_float += more.signs.in_float;
  signs.in_double += more.signs.in_double;
  signs.in_double2 += more.signs.in_double2;
  signs.exact += more.signs.exact;
  signs.tied += more.signs.tied;
  for (std::size_t i = 0; i < peers.size(); ++i) {
    peers[i].rays += more.peers[i].rays;
    peers[i].wrong += more.peers[i].wrong;
    peers[i].missed += more.peers[i].missed;
  }
  for (const Reproducer& example : more.examples)
    if (examples.size() < kExamples) examples.push_back(example);
  seconds += more.seconds;
}

std::uint64_t Tally::failures() const {
  return std::accumulate(faults.begin(), faults.end(), std::uint64_t{0});
}

}  // namespace tetbench
