// SPDX-License-Identifier: AGPL-3.0-or-later
// Draco's compressed meshes. Draco quantises when it encodes: what it decodes is what the file says.
#include <draco/compression/decode.h>
#include <draco/core/decoder_buffer.h>
#include <draco/mesh/mesh.h>

#include "prep/read_soup.hpp"

namespace tetprep {

PolygonSoup read_drc(const SourceFile& file) {
  // A regular mesh may take less than a bit a triangle, so the file's size bounds little; a lie must still
  // not take the machine down.
  const MemoryCeiling ceiling((std::uint64_t{1} << 30) + 2048 * std::uint64_t{file.text.size()});
  draco::DecoderBuffer buffer;
  buffer.Init(file.text.data(), file.text.size());
  const auto kind = draco::Decoder::GetEncodedGeometryType(&buffer);
  if (!kind.ok()) file.fail(0, "not a Draco file (" + kind.status().error_msg_string() + ")");
  if (kind.value() != draco::TRIANGULAR_MESH)
    file.fail(0, "a Draco file of points without faces: there is no surface in it");
  draco::Decoder decoder;
  auto decoded = decoder.DecodeMeshFromBuffer(&buffer);
  if (!decoded.ok()) file.fail(0, "damaged Draco file (" + decoded.status().error_msg_string() + ")");
  const draco::Mesh& mesh = *decoded.value();
  const draco::PointAttribute* positions = mesh.GetNamedAttribute(draco::GeometryAttribute::POSITION);
  if (positions == nullptr || positions->num_components() != 3)
    file.fail(0, "a Draco file without three-dimensional positions");

  PolygonSoup soup;
  soup.points.reserve(positions->size());
  for (std::uint32_t i = 0; i < positions->size(); ++i) {
    Point point{};
    if (!positions->ConvertValue<double>(draco::AttributeValueIndex(i), 3, point.data()))
      file.fail(0, "position " + std::to_string(i) + " cannot be decoded");
    soup.points.push_back(point);
  }
  for (draco::FaceIndex face(0); face < mesh.num_faces(); ++face) {
    for (const draco::PointIndex& corner : mesh.face(face)) {
      // A damaged file may name points that do not exist: mapped_index() would read beyond its table.
      soup.corners.push_back(corner.value() < mesh.num_points()
                                 ? positions->mapped_index(corner).value()
                                 : std::uint64_t{corner.value()} + positions->size());
    }
    soup.ends.push_back(soup.corners.size());
  }
  return soup;
}

}  // namespace tetprep
