// SPDX-License-Identifier: AGPL-3.0-or-later
// Position along the three-dimensional Hilbert curve, after Skilling, "Programming the Hilbert curve",
// AIP Conference Proceedings 707 (2004).
#pragma once

#include <array>
#include <cstdint>

namespace tetprep {

inline constexpr int kHilbertBits = 21;  ///< of each coordinate; three of them fit in 63

/// `x`: coordinates in [0, 2^21). Points with neighbouring results are neighbours in space.
inline std::uint64_t hilbert_position(std::array<std::uint32_t, 3> x) {
  constexpr std::uint32_t kTop = std::uint32_t{1} << (kHilbertBits - 1);
  // From the largest cubes down: undo the rotation and reflection of the curve inside each cube.
  for (std::uint32_t bit = kTop; bit > 1; bit >>= 1) {
    const std::uint32_t below = bit - 1;
    for (std::uint32_t& coordinate : x) {
      if ((coordinate & bit) != 0) {
        x[0] ^= below;
      } else {
        const std::uint32_t swapped = (x[0] ^ coordinate) & below;
        x[0] ^= swapped;
        coordinate ^= swapped;
      }
    }
  }
  // Gray code to binary, across the coordinates.
  x[1] ^= x[0];
  x[2] ^= x[1];
  std::uint32_t flip = 0;
  for (std::uint32_t bit = kTop; bit > 1; bit >>= 1)
    if ((x[2] & bit) != 0) flip ^= bit - 1;
  std::uint64_t position = 0;
  for (int i = kHilbertBits - 1; i >= 0; --i)
    for (const std::uint32_t coordinate : x) position = position << 1 | ((coordinate ^ flip) >> i & 1);
  return position;
}

}  // namespace tetprep
