// SPDX-License-Identifier: AGPL-3.0-or-later
// Answers that are the same to the last bit.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <vector>

#include "tetfmt/traverse.hpp"

namespace tetfmt_test {

/// Every field the same, bit by bit (so that NaN equals NaN).
inline bool same(const tetfmt::Hit& a, const tetfmt::Hit& b) {
  const auto bits = [](double value) { return std::bit_cast<std::uint64_t>(value); };
  return a.outcome == b.outcome && a.back == b.back && a.triangle == b.triangle && bits(a.t) == bits(b.t) &&
         bits(a.u) == bits(b.u) && bits(a.v) == bits(b.v) && a.side == b.side && a.tet == b.tet &&
         a.neighbor == b.neighbor && a.steps == b.steps && bits(a.side_u) == bits(b.side_u) &&
         bits(a.side_v) == bits(b.side_v) && a.face == b.face;
}
inline bool same(const std::vector<tetfmt::Hit>& a, const std::vector<tetfmt::Hit>& b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(),
                    [](const tetfmt::Hit& x, const tetfmt::Hit& y) { return same(x, y); });
}
inline bool same(const tetfmt::Location& a, const tetfmt::Location& b) {
  using Bits = std::array<std::uint64_t, 3>;
  return a.state == b.state && std::bit_cast<Bits>(a.position) == std::bit_cast<Bits>(b.position) &&
         a.cell == b.cell && a.positive == b.positive && a.face == b.face &&
         a.entrance_count == b.entrance_count && a.entrances == b.entrances;
}
inline bool same(tetfmt::Outcome a, tetfmt::Outcome b) {
  return a == b;
}
inline bool same(const std::vector<tetfmt::Outcome>& a, const std::vector<tetfmt::Outcome>& b) {
  return a == b;
}

}  // namespace tetfmt_test
