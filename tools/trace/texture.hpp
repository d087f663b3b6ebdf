// SPDX-License-Identifier: AGPL-3.0-or-later
// A picture on a surface.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "trace/image.hpp"

namespace tetprep {

/// Eight-bit sRGB, in memory as it is on disk; decoded where it is looked up.
class Texture {
 public:
  /// Reads a PNG; transparency is ignored. Throws Failure: io if it cannot be read, invalid if it is no sound
  /// PNG, unsupported above 2^28 pixels.
  static Texture read_png(const std::string& path);

  /// The colour at (u, v), which repeats with period 1; (0, 0) is the lower left corner and v points up.
  /// Between pixels, linearly. Black for coordinates that are no numbers.
  Rgb at(double u, double v) const;

 private:
  Texture(int width, int height) : width_(width), height_(height) {}
  Rgb texel(int x, int y) const;

  int width_, height_;
  std::vector<std::uint8_t> bytes_;
};

}  // namespace tetprep
