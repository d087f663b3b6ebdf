// SPDX-License-Identifier: AGPL-3.0-or-later
#include "sample/turn.hpp"

#include <cmath>

namespace tetprep {

CosSin turn(double turns) {
  const double quarters = std::floor(4 * turns + 0.5);
  const double x = 6.283185307179586 * (turns - quarters / 4);  // within an eighth of a turn of zero
  // Taylor's series by Horner; the first terms left out are x^18 / 18! and x^19 / 19!, below 1e-17.
  const double square = x * x;
  double cos = 1, sin = 1;
  for (int n = 16; n > 0; n -= 2) cos = 1 - square / (n * (n - 1)) * cos;
  for (int n = 17; n > 1; n -= 2) sin = 1 - square / (n * (n - 1)) * sin;
  sin *= x;
  const double quadrant = quarters - 4 * std::floor(quarters / 4);
  if (quadrant == 0) return {cos, sin};
  if (quadrant == 1) return {-sin, cos};
  if (quadrant == 2) return {-cos, -sin};
  return {sin, -cos};
}

std::uint64_t Random::next() {
  state_ += 0x9E3779B97F4A7C15u;
  std::uint64_t z = state_;
  z = (z ^ z >> 30) * 0xBF58476D1CE4E5B9u;
  z = (z ^ z >> 27) * 0x94D049BB133111EBu;
  return z ^ z >> 31;
}

}  // namespace tetprep
