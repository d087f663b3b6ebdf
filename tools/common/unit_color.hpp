// SPDX-License-Identifier: AGPL-3.0-or-later
// Colour components as numbers from 0 to 1 and as bytes.
#pragma once

#include <cmath>
#include <cstdint>
#include <optional>

namespace tetprep {

/// k for the float32 nearest to k / 255, none for any other number: what came from bytes goes back to bytes.
inline std::optional<std::uint8_t> unit_byte(float value) {
  if (!(value >= 0 && value <= 1)) return std::nullopt;
  const float byte = std::nearbyint(value * 255);
  if (byte / 255 != value) return std::nullopt;
  return static_cast<std::uint8_t>(byte);
}

}  // namespace tetprep
