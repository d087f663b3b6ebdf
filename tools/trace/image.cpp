// SPDX-License-Identifier: AGPL-3.0-or-later
#include "trace/image.hpp"

#include <png.h>

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "common/failure.hpp"

namespace tetprep {

double srgb_encode(double linear) {
  return linear <= 0.0031308 ? 12.92 * linear : 1.055 * std::pow(linear, 1 / 2.4) - 0.055;
}

double srgb_decode(double encoded) {
  return encoded <= 0.04045 ? encoded / 12.92 : std::pow((encoded + 0.055) / 1.055, 2.4);
}

Rgb from_screen(double r, double g, double b) {
  return {srgb_decode(r / 255), srgb_decode(g / 255), srgb_decode(b / 255)};
}

void write_png(const Image& image, AtomicFile& file) {
  std::vector<std::uint8_t> bytes;
  bytes.reserve(3 * image.pixels.size());
  for (const Rgb& pixel : image.pixels) {
    for (const double channel : {pixel.r, pixel.g, pixel.b})
      bytes.push_back(
          static_cast<std::uint8_t>(std::lround(255 * srgb_encode(std::clamp(channel, 0.0, 1.0)))));
  }
  // libpng's simplified interface reports errors by its return value, where the full one would jump over
  // destructors.
  png_image control{};
  control.version = PNG_IMAGE_VERSION;
  control.width = static_cast<png_uint_32>(image.width);
  control.height = static_cast<png_uint_32>(image.height);
  control.format = PNG_FORMAT_RGB;
  const auto check = [&control](int done) {
    if (done == 0) throw Failure(ExitCode::runtime, std::string("libpng: ") + control.message);
  };
  png_alloc_size_t size = PNG_IMAGE_PNG_SIZE_MAX(control);
  std::vector<std::byte> encoded(size);
  check(png_image_write_to_memory(&control, encoded.data(), &size, 0, bytes.data(), 0, nullptr));
  file.write(std::span(encoded).first(size));
}

}  // namespace tetprep
