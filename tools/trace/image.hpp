// SPDX-License-Identifier: AGPL-3.0-or-later
// Colours, what a camera collects, and the picture that comes of it.
#pragma once

#include <algorithm>
#include <string>
#include <vector>

#include "common/atomic_file.hpp"

namespace tetprep {

/// Linear light, for each of sRGB's primaries; 1 is as bright as a PNG can be.
struct Rgb {
  double r = 0, g = 0, b = 0;
};
constexpr Rgb operator+(Rgb a, Rgb b) {
  return {a.r + b.r, a.g + b.g, a.b + b.b};
}
constexpr Rgb operator*(double s, Rgb a) {
  return {s * a.r, s * a.g, s * a.b};
}
/// What is left of light `a` where a share `b` is let through or thrown back.
constexpr Rgb operator*(Rgb a, Rgb b) {
  return {a.r * b.r, a.g * b.g, a.b * b.b};
}
constexpr Rgb mix(Rgb a, Rgb b, double t) {
  return (1 - t) * a + t * b;
}
constexpr double brightest(Rgb a) {
  return std::max({a.r, a.g, a.b});
}

/// Between linear light and the numbers that files and screens use, 0 to 1 (IEC 61966-2-1).
double srgb_encode(double linear);
double srgb_decode(double encoded);
/// A colour given as screens show it, 0 to 255.
Rgb from_screen(double r, double g, double b);

/// Linear light, row by row from the top.
struct Image {
  int width = 0, height = 0;
  std::vector<Rgb> pixels;

  Image(int w, int h)
      : width(w), height(h), pixels(static_cast<std::size_t>(w) * static_cast<std::size_t>(h)) {}
  Rgb& at(int x, int y) {
    return pixels[static_cast<std::size_t>(y) * static_cast<std::size_t>(width) +
                  static_cast<std::size_t>(x)];
  }
};

/// Writes a PNG of 8 bits a channel that declares itself sRGB, without a time stamp, and leaves commit() to
/// the caller. What is brighter than 1 is cut off. Throws Failure.
void write_png(const Image& image, AtomicFile& file);

/// Writes an OpenEXR file: R, G and B as linear float32, compressed without loss. Otherwise as write_png.
void write_exr(const Image& image, AtomicFile& file);

}  // namespace tetprep
