// SPDX-License-Identifier: AGPL-3.0-or-later
// Colours, what a camera collects, and the picture that comes of it.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "common/atomic_file.hpp"

namespace tetprep {

/// Linear light, 0 to 1 for each of sRGB's primaries.
struct Rgb {
  double r = 0, g = 0, b = 0;
};
constexpr Rgb operator+(Rgb a, Rgb b) {
  return {a.r + b.r, a.g + b.g, a.b + b.b};
}
constexpr Rgb operator*(double s, Rgb a) {
  return {s * a.r, s * a.g, s * a.b};
}
constexpr Rgb mix(Rgb a, Rgb b, double t) {
  return (1 - t) * a + t * b;
}

/// Between linear light and the numbers that files and screens use, 0 to 1 (IEC 61966-2-1).
double srgb_encode(double linear);
double srgb_decode(double encoded);
/// A colour given as screens show it, 0 to 255.
Rgb from_screen(double r, double g, double b);

/// Eight-bit sRGB, row by row from the top.
struct Image {
  int width = 0, height = 0;
  std::vector<std::uint8_t> bytes;  ///< r, g, b; width * height * 3

  Image(int w, int h)
      : width(w),
        height(h),
        bytes(std::size_t{3} * static_cast<std::size_t>(w) * static_cast<std::size_t>(h)) {}
  void set(int x, int y, Rgb colour);
};

/// Writes a PNG that declares itself sRGB, without a time stamp, and leaves commit() to the caller. Throws
/// Failure.
void write_png(const Image& image, AtomicFile& file);

}  // namespace tetprep
