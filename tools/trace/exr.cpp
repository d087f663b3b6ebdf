// SPDX-License-Identifier: AGPL-3.0-or-later
#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfOutputFile.h>
#include <ImfStdIO.h>

#include <array>
#include <exception>

#include "common/failure.hpp"
#include "trace/image.hpp"

namespace tetprep {

void write_exr(const Image& image, AtomicFile& file) {
  std::vector<std::array<float, 3>> pixels;
  pixels.reserve(image.pixels.size());
  for (const Rgb& p : image.pixels)
    pixels.push_back({static_cast<float>(p.r), static_cast<float>(p.g), static_cast<float>(p.b)});

  // OpenEXR goes back to fill in its table of lines, which a stream in memory lets it do.
  Imf::StdOSStream stream;
  try {
    Imf::Header header(image.width, image.height);
    header.compression() = Imf::ZIP_COMPRESSION;
    Imf::FrameBuffer buffer;
    constexpr std::array<const char*, 3> kChannels{"R", "G", "B"};
    for (std::size_t c = 0; c < 3; ++c) {
      header.channels().insert(kChannels[c], Imf::Channel(Imf::FLOAT));
      buffer.insert(kChannels[c],
                    Imf::Slice(Imf::FLOAT, reinterpret_cast<char*>(pixels.data()) + c * sizeof(float),
                               sizeof pixels[0], sizeof pixels[0] * static_cast<std::size_t>(image.width)));
    }
    Imf::OutputFile output(stream, header, 0);
    output.setFrameBuffer(buffer);
    output.writePixels(image.height);
  } catch (const std::bad_alloc&) {
    throw;
  } catch (const std::exception& error) {
    throw Failure(ExitCode::runtime, std::string("OpenEXR: ") + error.what());
  }
  file.write(stream.str());
}

}  // namespace tetprep
