// SPDX-License-Identifier: AGPL-3.0-or-later
// Position along the three-dimensional Hilbert curve, after Skilling, "Programming the Hilbert curve",
// AIP Conference Proceedings 707 (2004).
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace tetprep {

inline constexpr int kHilbertBits = 21;  ///< of each coordinate; three of them fit in 63

namespace hilbert {

/// From the largest cubes down, what happens to all smaller ones is an exchange and a reflection of the axes,
/// so a table has an entry for each of those (6 * 8, and twice as many for Skilling's Gray code, whose carry
/// is one bit) and each of a cube's eight parts.
struct Step {
  std::uint8_t next;   ///< state, for the part's own parts
  std::uint8_t digit;  ///< the part's place along the curve
};
inline constexpr std::size_t kStates = 96;
inline constexpr std::array<std::array<std::uint8_t, 3>, 6> kExchanges{
    {{0, 1, 2}, {0, 2, 1}, {1, 0, 2}, {1, 2, 0}, {2, 0, 1}, {2, 1, 0}}};

constexpr std::array<std::array<Step, 8>, kStates> make_steps() {
  std::array<std::array<Step, 8>, kStates> steps{};
  for (std::size_t state = 0; state < kStates; ++state) {
    const std::size_t carry = state & 1;
    for (std::size_t part = 0; part < 8; ++part) {  // its bits: whether it is in the upper half of x, y, z
      // Axis k of the curve is axis from[k] of space, reflected if flip[k].
      std::array<std::uint8_t, 3> from = kExchanges[state >> 4];
      std::array<std::uint8_t, 3> flip{};
      for (std::size_t k = 0; k < 3; ++k) flip[k] = state >> (k + 1) & 1;
      std::array<std::size_t, 3> bit{};
      for (std::size_t k = 0; k < 3; ++k) bit[k] = (part >> from[k] & 1) ^ flip[k];
      // Skilling's loop over the axes, on `from` and `flip` in place of the lower bits.
      for (std::size_t k = 0; k < 3; ++k) {
        if (bit[k] != 0) {
          flip[0] ^= 1;
        } else {
          const auto f = from[0], r = flip[0];
          from[0] = from[k];
          flip[0] = flip[k];
          from[k] = f;
          flip[k] = r;
        }
      }
      // Gray code to binary, across the axes and (by the carry) down the levels.
      const std::size_t a = bit[0], b = a ^ bit[1], c = b ^ bit[2];
      const std::size_t digit = (a << 2 | b << 1 | c) ^ (carry != 0 ? 7 : 0);
      std::size_t exchange = 0;
      while (kExchanges[exchange] != from) ++exchange;
      const std::size_t next = exchange << 4 | std::size_t{flip[2]} << 3 | std::size_t{flip[1]} << 2 |
                               std::size_t{flip[0]} << 1 | (carry ^ c);
      steps[state][part] = {static_cast<std::uint8_t>(next), static_cast<std::uint8_t>(digit)};
    }
  }
  return steps;
}
inline constexpr auto kSteps = make_steps();

}  // namespace hilbert

/// `x`: coordinates in [0, 2^21). Points with neighbouring results are neighbours in space.
inline std::uint64_t hilbert_position(const std::array<std::uint32_t, 3>& x) {
  std::uint64_t position = 0;
  std::size_t state = 0;
  for (int i = kHilbertBits - 1; i >= 0; --i) {
    const std::size_t part = (x[0] >> i & 1) | (x[1] >> i & 1) << 1 | (x[2] >> i & 1) << 2;
    const hilbert::Step step = hilbert::kSteps[state][part];
    position = position << 3 | step.digit;
    state = step.next;
  }
  return position;
}

}  // namespace tetprep
