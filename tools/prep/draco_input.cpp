// SPDX-License-Identifier: AGPL-3.0-or-later
#include "prep/draco_input.hpp"

#include <draco/compression/decode.h>
#include <draco/core/decoder_buffer.h>

namespace tetprep {

std::uint64_t draco_ceiling(std::uint64_t bytes) {
  return (std::uint64_t{1} << 30) + 2048 * bytes;
}

std::unique_ptr<draco::Mesh> decode_draco_mesh(const SourceFile& file, std::string_view bytes,
                                               const std::string& where) {
  draco::DecoderBuffer buffer;
  buffer.Init(bytes.data(), bytes.size());
  const auto kind = draco::Decoder::GetEncodedGeometryType(&buffer);
  if (!kind.ok()) file.fail(0, where + "not Draco data (" + kind.status().error_msg_string() + ")");
  if (kind.value() != draco::TRIANGULAR_MESH)
    file.fail(0, where + "Draco data of points without faces: there is no surface in it");
  draco::Decoder decoder;
  auto decoded = decoder.DecodeMeshFromBuffer(&buffer);
  if (!decoded.ok()) file.fail(0, where + "damaged Draco data (" + decoded.status().error_msg_string() + ")");
  return std::move(decoded).value();
}

std::array<double, 4> draco_row(const draco::PointAttribute& attribute, std::uint32_t row) {
  std::array<double, 4> values{};
  if (!attribute.ConvertValue<double>(draco::AttributeValueIndex(row), 4, values.data()))
    throw std::runtime_error("a Draco attribute that cannot be decoded");
  return values;
}

double draco_scale(const draco::PointAttribute& attribute) {
  if (attribute.normalized()) return 1;  // Draco scales them itself
  switch (attribute.data_type()) {
    case draco::DT_INT8:
      return 127;
    case draco::DT_UINT8:
      return 255;
    case draco::DT_INT16:
      return 32767;
    case draco::DT_UINT16:
      return 65535;
    case draco::DT_UINT32:
      return 4294967295.0;
    default:
      return 1;
  }
}

}  // namespace tetprep
