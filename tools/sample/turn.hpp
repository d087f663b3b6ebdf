// SPDX-License-Identifier: AGPL-3.0-or-later
// Sine and cosine, and random numbers, that are the same on every machine.
#pragma once

#include <cstdint>

namespace tetprep {

struct CosSin {
  double cos, sin;
};

/// Of an angle in turns (1 is a full circle), |turns| < 2^50. Only additions, multiplications and exact
/// reductions, in a fixed order: unlike the C library's, the result does not depend on the library. Error
/// below 1e-15.
CosSin turn(double turns);

/// SplitMix64 (Steele, Lea and Flood 2014): a stream of well-mixed 64-bit numbers from any seed.
class Random {
 public:
  explicit Random(std::uint64_t seed) : state_(seed) {}
  std::uint64_t next();
  /// In [0, 1), 53 bits.
  double uniform() { return static_cast<double>(next() >> 11) * 0x1p-53; }

 private:
  std::uint64_t state_;
};

}  // namespace tetprep
