// SPDX-License-Identifier: AGPL-3.0-or-later
// Pictures, read back by the libraries' own readers.
#include <ImfArray.h>
#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfInputFile.h>
#include <png.h>

#include "trace/trace_support.hpp"

namespace tetfmt_test {
namespace {

using namespace tetprep;

Image gradient() {
  Image image(5, 3);
  for (int y = 0; y < 3; ++y) {
    for (int x = 0; x < 5; ++x) image.at(x, y) = {0.25 * x, 0.5 * y, 10.0 * x + 0.1};
  }
  return image;
}

TEST_F(TraceTest, ExrHoldsLinearFloats) {
  const Image image = gradient();
  AtomicFile out("out.exr");
  write_exr(image, out);
  out.commit();
  Imf::InputFile file("out.exr", 0);
  const auto window = file.header().dataWindow();
  ASSERT_EQ(window.max.x - window.min.x, 4);
  ASSERT_EQ(window.max.y - window.min.y, 2);
  const std::array<const char*, 3> names{"R", "G", "B"};
  std::array<std::array<float, 15>, 3> channels{};
  Imf::FrameBuffer buffer;
  for (std::size_t c = 0; c < 3; ++c) {
    ASSERT_NE(file.header().channels().findChannel(names[c]), nullptr);
    EXPECT_EQ(file.header().channels().findChannel(names[c])->type, Imf::FLOAT);
    buffer.insert(names[c], Imf::Slice(Imf::FLOAT, reinterpret_cast<char*>(channels[c].data()), 4, 4 * 5));
  }
  file.setFrameBuffer(buffer);
  file.readPixels(0, 2);
  for (std::size_t i = 0; i < 15; ++i) {
    EXPECT_EQ(channels[0][i], static_cast<float>(image.pixels[i].r));
    EXPECT_EQ(channels[1][i], static_cast<float>(image.pixels[i].g));
    EXPECT_EQ(channels[2][i], static_cast<float>(image.pixels[i].b));
  }
}

TEST_F(TraceTest, PngHoldsScreenColours) {
  const Image image = gradient();
  AtomicFile out("out.png");
  write_png(image, out);
  out.commit();
  png_image control{};
  control.version = PNG_IMAGE_VERSION;
  ASSERT_NE(png_image_begin_read_from_file(&control, "out.png"), 0);
  control.format = PNG_FORMAT_RGB;
  std::vector<std::uint8_t> bytes(PNG_IMAGE_SIZE(control));
  ASSERT_NE(png_image_finish_read(&control, nullptr, bytes.data(), 0, nullptr), 0);
  ASSERT_EQ(bytes.size(), 45u);
  EXPECT_EQ(bytes[0], 0);
  EXPECT_EQ(bytes[3], 137);  // 0.25 linear
  EXPECT_EQ(bytes[12], 255);
  EXPECT_EQ(bytes[5], 255);   // cut off
  EXPECT_EQ(bytes[16], 188);  // 0.5 linear
}

}  // namespace
}  // namespace tetfmt_test
