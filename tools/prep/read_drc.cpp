// SPDX-License-Identifier: AGPL-3.0-or-later
// Draco's compressed meshes. Draco quantises when it encodes: what it decodes is what the file says.
#include <algorithm>
#include <optional>

#include "prep/draco_input.hpp"

namespace tetprep {
namespace {

using draco::GeometryAttribute;
using tetfmt::PropertyType;

std::optional<PropertyType> type_of(draco::DataType type) {
  switch (type) {
    case draco::DT_INT8:
      return PropertyType::int8;
    case draco::DT_UINT8:
    case draco::DT_BOOL:
      return PropertyType::uint8;
    case draco::DT_INT16:
      return PropertyType::int16;
    case draco::DT_UINT16:
      return PropertyType::uint16;
    case draco::DT_INT32:
      return PropertyType::int32;
    case draco::DT_UINT32:
      return PropertyType::uint32;
    case draco::DT_FLOAT32:
      return PropertyType::float32;
    case draco::DT_FLOAT64:
      return PropertyType::float64;
    default:
      return std::nullopt;
  }
}

class DrcReader {
 public:
  explicit DrcReader(const SourceFile& file)
      : file_(file), warnings_(file.path), mesh_(decode_draco_mesh(file, file.text, {})) {}

  PolygonSoup read() {
    read_positions();
    bool normals = false, texcoords = false, colors = false;
    for (std::int32_t i = 0; i < mesh_->num_attributes(); ++i) {
      const draco::PointAttribute& attribute = *mesh_->attribute(i);
      const int components = attribute.num_components();
      if (attribute.attribute_type() == GeometryAttribute::NORMAL && components == 3 &&
          !std::exchange(normals, true))
        fill(soup_.normals, attribute, 1);
      else if (attribute.attribute_type() == GeometryAttribute::TEX_COORD && components == 2 &&
               !std::exchange(texcoords, true))
        fill(soup_.texcoords, attribute, 1);
      else if (attribute.attribute_type() == GeometryAttribute::COLOR &&
               (components == 3 || components == 4) && !std::exchange(colors, true))
        fill(soup_.colors, attribute, draco_scale(attribute));
      else if (attribute.attribute_type() == GeometryAttribute::GENERIC && components == 1 &&
               type_of(attribute.data_type()))
        fill_property(attribute);
      else if (attribute.attribute_type() != GeometryAttribute::POSITION)
        warnings_.add(0, "attribute " + std::to_string(attribute.unique_id()) + " (" +
                             GeometryAttribute::TypeToString(attribute.attribute_type()) + ", " +
                             std::to_string(components) + " components) is left out");
    }
    warnings_.append_to(soup_.warnings);
    return std::move(soup_);
  }

 private:
  void read_positions() {
    const draco::PointAttribute* positions = mesh_->GetNamedAttribute(GeometryAttribute::POSITION);
    if (positions == nullptr || positions->num_components() != 3)
      file_.fail(0, "a Draco file without three-dimensional positions");
    soup_.points.reserve(positions->size());
    for (std::uint32_t i = 0; i < positions->size(); ++i) {
      const auto row = draco_row(*positions, i);
      soup_.points.push_back({row[0], row[1], row[2]});
    }
    soup_.corners.reserve(3 * std::size_t{mesh_->num_faces()});
    soup_.ends.reserve(mesh_->num_faces());
    for (draco::FaceIndex face(0); face < mesh_->num_faces(); ++face) {
      for (const draco::PointIndex& corner : mesh_->face(face)) {
        // A damaged file may name points that do not exist: mapped_index() would read beyond its table.
        soup_.corners.push_back(corner.value() < mesh_->num_points()
                                    ? positions->mapped_index(corner).value()
                                    : std::uint64_t{corner.value()} + positions->size());
      }
      soup_.ends.push_back(soup_.corners.size());
    }
  }

  /// The row of each corner.
  template <class T>
  void map_corners(Channel<T>& channel, const draco::PointAttribute& attribute) {
    channel.of_corner.reserve(soup_.corners.size());
    for (draco::FaceIndex face(0); face < mesh_->num_faces(); ++face) {
      for (const draco::PointIndex& corner : mesh_->face(face)) {
        const Index row =
            corner.value() < mesh_->num_points() ? attribute.mapped_index(corner).value() : kNone;
        channel.of_corner.push_back(row < channel.rows.size() ? row : kNone);
      }
    }
  }

  template <std::size_t N>
  void fill(Channel<std::array<float, N>>& channel, const draco::PointAttribute& attribute, double scale) {
    for (std::uint32_t i = 0; i < attribute.size(); ++i) {
      const auto row = draco_row(attribute, i);
      std::array<float, N> values{};
      for (std::size_t k = 0; k < N; ++k) values[k] = static_cast<float>(row[k] / scale);
      if (N == 4 && attribute.num_components() == 3) values[N - 1] = 1;  // opaque
      channel.rows.push_back(values);
    }
    map_corners(channel, attribute);
  }

  void fill_property(const draco::PointAttribute& attribute) {
    PropertyChannel property;
    const auto* metadata =
        mesh_->GetAttributeMetadataByAttributeId(mesh_->GetAttributeIdByUniqueId(attribute.unique_id()));
    if (metadata == nullptr || !metadata->GetEntryString("name", &property.name) || property.name.empty())
      property.name = "generic_" + std::to_string(attribute.unique_id());
    property.type = *type_of(attribute.data_type());
    for (const PropertyChannel& other : soup_.properties)
      if (other.name == property.name) property.name += "_" + std::to_string(attribute.unique_id());
    for (std::uint32_t i = 0; i < attribute.size(); ++i)
      property.values.rows.push_back(draco_row(attribute, i)[0]);
    map_corners(property.values, attribute);
    soup_.properties.push_back(std::move(property));
  }

  const SourceFile& file_;
  Warnings warnings_;
  std::unique_ptr<draco::Mesh> mesh_;
  PolygonSoup soup_;
};

}  // namespace

PolygonSoup read_drc(const SourceFile& file) {
  const MemoryCeiling ceiling(draco_ceiling(file.text.size()));
  return DrcReader(file).read();
}

}  // namespace tetprep
