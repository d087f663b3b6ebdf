// SPDX-License-Identifier: AGPL-3.0-or-later
// Random numbers that are the same on every machine; the standard library's distributions are not.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <initializer_list>
#include <utility>
#include <vector>

namespace tetbench {

/// SplitMix64 (Steele, Lea and Flood 2014).
class Dice {
 public:
  /// Different streams for different lists.
  explicit Dice(std::initializer_list<std::uint64_t> seeds) {
    for (const std::uint64_t seed : seeds) state_ = next() ^ seed;
  }
  std::uint64_t next() {
    std::uint64_t z = state_ += 0x9E3779B97F4A7C15U;
    z = (z ^ z >> 30) * 0xBF58476D1CE4E5B9U;
    z = (z ^ z >> 27) * 0x94D049BB133111EBU;
    return z ^ z >> 31;
  }
  std::uint64_t below(std::uint64_t n) { return next() % n; }
  double unit() { return static_cast<double>(next() >> 11) * 0x1p-53; }
  double between(double low, double high) { return low + (high - low) * unit(); }
  /// Every order is as likely (Fisher and Yates).
  template <class T>
  void shuffle(std::vector<T>& values) {
    for (std::size_t i = values.size(); i > 1; --i) std::swap(values[i - 1], values[below(i)]);
  }
  /// Evenly on the unit sphere.
  std::array<double, 3> direction() {
    for (;;) {
      const std::array<double, 3> d = {between(-1, 1), between(-1, 1), between(-1, 1)};
      const double squared = d[0] * d[0] + d[1] * d[1] + d[2] * d[2];
      if (squared < 0.01 || squared > 1) continue;
      const double length = std::sqrt(squared);
      return {d[0] / length, d[1] / length, d[2] / length};
    }
  }

 private:
  std::uint64_t state_ = 0;
};

}  // namespace tetbench
