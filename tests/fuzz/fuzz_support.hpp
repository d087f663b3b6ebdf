// SPDX-License-Identifier: AGPL-3.0-or-later
// What the harnesses share: numbers from the fuzzer's bytes, and the end of a run where something is wrong.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <span>
#include <vector>

#include "support/same.hpp"
#include "tetfmt/traverse.hpp"

namespace tetfmt_test {

/// Ends the run, saying which line of the harness asked for what does not hold.
inline void require(bool condition, const char* file = __builtin_FILE(), int line = __builtin_LINE()) {
  if (condition) return;
  std::fprintf(stderr, "%s:%d: does not hold\n", file, line);
  std::abort();
}

/// Values from bytes, front to back; zeros once they are used up.
class Reader {
 public:
  explicit Reader(std::span<const std::byte> bytes) : bytes_(bytes) {}
  bool empty() const { return bytes_.empty(); }
  template <class T>
  T take() {
    T value{};
    const std::size_t count = std::min(sizeof value, bytes_.size());
    if (count != 0) std::memcpy(&value, bytes_.data(), count);
    bytes_ = bytes_.subspan(count);
    return value;
  }
  /// Any float at all, or one of the quarters from -2 to 8: places and directions where everything ties.
  float take_float() {
    const auto how = take<std::uint8_t>();
    return how < 64 ? take<float>() : static_cast<float>(static_cast<int>(how % 41) - 8) / 4;
  }
  tetfmt::Vec3f take_vector() {
    const float x = take_float(), y = take_float(), z = take_float();
    return {x, y, z};
  }
  /// An end of an interval: any double at all, or a quarter from 0 to 15.
  double take_end() {
    const auto how = take<std::uint8_t>();
    return how < 64 ? take<double>() : static_cast<double>(how % 61) / 4;
  }

 private:
  std::span<const std::byte> bytes_;
};

/// A fan of directions around one, as many as are walked together at least.
inline std::vector<tetfmt::Vec3f> fan(const tetfmt::Vec3f& middle, Reader& reader) {
  std::vector<tetfmt::Vec3f> directions(24, middle);
  for (std::size_t i = 1; i < directions.size(); ++i) {
    const float width = i < 12 ? 0x1p-20f : 0.25f;
    directions[i].x += width * static_cast<float>(reader.take<std::int8_t>()) / 64;
    directions[i].y += width * static_cast<float>(reader.take<std::int8_t>()) / 64;
    directions[i].z += width * static_cast<float>(reader.take<std::int8_t>()) / 64;
  }
  return directions;
}

/// The same hit for a ray walked with others, whose steps are not counted, and for one walked alone.
inline bool same_but_for_steps(tetfmt::Hit a, tetfmt::Hit b) {
  a.steps = b.steps = 0;
  return same(a, b);
}

}  // namespace tetfmt_test
