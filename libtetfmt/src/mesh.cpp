// SPDX-License-Identifier: MIT
#include "tetfmt/mesh.hpp"

#include <bit>
#include <limits>

namespace tetfmt {
namespace {

/// The exponent of the lowest set bit of a finite, non-zero float.
int lowest_bit(float value) {
  const auto bits = std::bit_cast<std::uint32_t>(value);
  const int exponent = static_cast<int>(bits >> 23 & 0xFF);
  std::uint32_t mantissa = bits & 0x7FFFFF;
  if (exponent != 0) mantissa |= 0x800000;  // the implicit bit of a normal number
  return std::countr_zero(mantissa) + (exponent == 0 ? 1 : exponent) - 150;
}

}  // namespace

int grid_exponent(const std::vector<Vec3f>& vertices) {
  int lowest = std::numeric_limits<int>::max();
  for (const Vec3f& p : vertices)
    for (const float value : {p.x, p.y, p.z})
      if (value != 0) lowest = std::min(lowest, lowest_bit(value));
  return lowest == std::numeric_limits<int>::max() ? 0 : lowest;
}

}  // namespace tetfmt
