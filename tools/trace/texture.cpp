// SPDX-License-Identifier: AGPL-3.0-or-later
#include "trace/texture.hpp"

#include <png.h>

#include <array>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <memory>

#include "common/failure.hpp"

namespace tetprep {
namespace {

constexpr std::uint64_t kMaxPixels = std::uint64_t{1} << 28;

std::array<double, 256> decoding_table() {
  std::array<double, 256> table{};
  for (std::size_t i = 0; i < table.size(); ++i) table[i] = srgb_decode(static_cast<double>(i) / 255);
  return table;
}

}  // namespace

Texture Texture::read_png(const std::string& path) {
  // A pipe would make us wait, a device never end.
  std::error_code error;
  if (!std::filesystem::is_regular_file(path, error))
    throw Failure(ExitCode::io, path + ": not there, or not a file; name a PNG");
  const std::unique_ptr<std::FILE, int (*)(std::FILE*)> file(std::fopen(path.c_str(), "rb"), &std::fclose);
  if (!file) throw Failure(ExitCode::io, path + ": cannot be opened; check its permissions");

  png_image control{};
  control.version = PNG_IMAGE_VERSION;
  const std::unique_ptr<png_image, void (*)(png_image*)> cleanup(&control, &png_image_free);
  const auto check = [&](int done) {
    if (done == 0) throw Failure(ExitCode::invalid, path + ": " + control.message + "; textures are PNG");
  };
  check(png_image_begin_read_from_stdio(&control, file.get()));
  if (std::uint64_t{control.width} * control.height > kMaxPixels)
    throw Failure(ExitCode::unsupported, path + ": more than 2^28 pixels; make it smaller");
  control.format = PNG_FORMAT_RGBA;
  std::vector<std::uint8_t> rgba(PNG_IMAGE_SIZE(control));
  check(png_image_finish_read(&control, nullptr, rgba.data(), 0, nullptr));

  Texture texture(static_cast<int>(control.width), static_cast<int>(control.height));
  texture.bytes_.reserve(rgba.size() / 4 * 3);
  for (std::size_t i = 0; i < rgba.size(); i += 4)
    texture.bytes_.insert(texture.bytes_.end(), {rgba[i], rgba[i + 1], rgba[i + 2]});
  return texture;
}

Rgb Texture::texel(int x, int y) const {
  static const std::array<double, 256> kDecoded = decoding_table();
  const auto wrap = [](int i, int n) { return static_cast<std::size_t>(i < 0 ? i + n : i < n ? i : i - n); };
  const std::uint8_t* p =
      &bytes_[3 * (wrap(y, height_) * static_cast<std::size_t>(width_) + wrap(x, width_))];
  return {kDecoded[p[0]], kDecoded[p[1]], kDecoded[p[2]]};
}

Rgb Texture::at(double u, double v) const {
  if (!std::isfinite(u) || !std::isfinite(v)) return {};
  // Pixel (i, j) stands for the colour in its middle, at ((i + 0.5) / width, ...).
  const double x = (u - std::floor(u)) * width_ - 0.5, y = (1 - (v - std::floor(v))) * height_ - 0.5;
  const double left = std::floor(x), above = std::floor(y);
  const int i = static_cast<int>(left), j = static_cast<int>(above);
  return mix(mix(texel(i, j), texel(i + 1, j), x - left), mix(texel(i, j + 1), texel(i + 1, j + 1), x - left),
             y - above);
}

}  // namespace tetprep
