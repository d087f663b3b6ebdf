// SPDX-License-Identifier: AGPL-3.0-or-later
#include "prep/draco_surface.hpp"

#include <draco/compression/decode.h>
#include <draco/compression/expert_encode.h>
#include <draco/mesh/mesh.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <new>
#include <stdexcept>

#include "common/failure.hpp"
#include "common/unit_color.hpp"
#include "prep/read_soup.hpp"

namespace tetprep {
namespace {

using draco::GeometryAttribute;

constexpr std::uint8_t kNoNormal = 1, kNoTexcoord = 2, kNoColor = 4, kNoPoint = 0x80;
constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();
/// Draco counts how often every integer between the least and the largest occurs, in a table of that length.
constexpr double kMaxIntegerRange = 1 << 20;

template <std::size_t N>
bool finite(const std::array<float, N>& value) {
  return std::all_of(value.begin(), value.end(), [](float x) { return std::isfinite(x); });
}

bool has_direction(const std::array<float, 3>& normal) {
  return finite(normal) && normal != std::array<float, 3>{};
}

// ------------------------------------------------------------------------------------------------- encoding

/// The mesh in the making, and how its attributes are to be quantised.
class Builder {
 public:
  explicit Builder(std::size_t points) { mesh_.set_num_points(static_cast<std::uint32_t>(points)); }

  /// `values` are all points' components, point after point. Returns the attribute's id.
  template <class T>
  int add(GeometryAttribute::Type type, draco::DataType data, std::uint8_t components,
          const std::vector<T>& values, bool normalized = false) {
    GeometryAttribute attribute;
    const auto stride = static_cast<std::int64_t>(sizeof(T)) * components;
    attribute.Init(type, nullptr, components, data, normalized, stride, 0);
    const auto count = static_cast<std::uint32_t>(values.size() / components);
    const int id = mesh_.AddAttribute(attribute, true, count);
    mesh_.attribute(id)->buffer()->Write(0, values.data(), values.size() * sizeof(T));
    return id;
  }

  /// Floats that come back within their range / 2^(bits + 1), or exactly if float32 cannot hold the range.
  void add_quantized(GeometryAttribute::Type type, std::uint8_t components, const std::vector<float>& values,
                     int bits) {
    const int id = add(type, draco::DT_FLOAT32, components, values);
    const auto [low, high] = std::minmax_element(values.begin(), values.end());
    if (values.empty() || !std::isfinite(*high - *low)) return;
    quantization_.emplace_back(id, bits);
  }

  draco::Mesh& mesh() { return mesh_; }

  std::vector<std::byte> encode() const {
    draco::ExpertEncoder encoder(mesh_);
    encoder.SetEncodingMethod(draco::MESH_SEQUENTIAL_ENCODING);  // the only one that keeps the faces' order
    encoder.SetSpeedOptions(5, 5);
    encoder.options().SetGlobalBool("compress_connectivity", true);
    for (const auto& [id, bits] : quantization_) encoder.SetAttributeQuantization(id, bits);
    draco::EncoderBuffer buffer;
    const draco::Status status = encoder.EncodeToBuffer(&buffer);
    if (!status.ok())
      throw Failure(ExitCode::runtime, "Draco cannot encode the surface's attributes (" +
                                           status.error_msg_string() + "); convert without it");
    const auto bytes = std::as_bytes(std::span(buffer.data(), buffer.size()));
    return {bytes.begin(), bytes.end()};
  }

  void quantize(int id, int bits) { quantization_.emplace_back(id, bits); }

 private:
  draco::Mesh mesh_;
  std::vector<std::pair<int, int>> quantization_;
};

/// All components one after the other for `points` points; zero (or `filler`) where `has` says that there is
/// none, which the mask is told.
template <std::size_t N, class Has>
std::vector<float> flattened(const std::vector<std::array<float, N>>& values, std::size_t points, Has has,
                             std::uint8_t bit, const std::array<float, N>& filler,
                             std::vector<std::uint8_t>& mask) {
  std::vector<float> flat;
  flat.reserve(N * points);
  for (std::size_t i = 0; i < points; ++i) {
    const bool present = i < values.size() && has(values[i]);
    if (!present) mask[i] |= bit;
    const auto& value = present ? values[i] : filler;
    flat.insert(flat.end(), value.begin(), value.end());
  }
  return flat;
}

/// A value that exists, for points without one: quantisation is over the range of all values.
template <std::size_t N, class Has>
std::array<float, N> some_value(const std::vector<std::array<float, N>>& values, Has has,
                                std::array<float, N> otherwise) {
  const auto found = std::find_if(values.begin(), values.end(), has);
  return found == values.end() ? otherwise : *found;
}

void add_colors(Builder& builder, const std::vector<float>& colors) {
  std::vector<std::uint8_t> bytes;
  for (const float value : colors) {
    const auto byte = unit_byte(value);
    if (!byte) return builder.add_quantized(GeometryAttribute::COLOR, 4, colors, kDracoColorBits);
    bytes.push_back(*byte);
  }
  builder.add(GeometryAttribute::COLOR, draco::DT_UINT8, 4, bytes, true);
}

template <class T>
bool all_are(const std::vector<double>& values) {
  return std::all_of(values.begin(), values.end(), [](double x) {
    return std::isnan(x) || (std::abs(x) <= static_cast<double>(std::numeric_limits<T>::max()) &&
                             static_cast<double>(static_cast<T>(x)) == x);
  });
}

bool small_integers(const std::vector<double>& values) {
  const auto [low, high] = std::minmax_element(values.begin(), values.end());
  return std::none_of(values.begin(), values.end(),
                      [](double x) { return std::isnan(x) || (x == 0 && std::signbit(x)); }) &&
         all_are<std::int32_t>(values) && *high - *low < kMaxIntegerRange;
}

void add_property(Builder& builder, const PointProperty& property, std::size_t points) {
  std::vector<double> values = property.values;
  values.resize(points, values.back());
  int id = 0;
  if (small_integers(values)) {
    const std::vector<std::int32_t> narrow(values.begin(), values.end());
    id = builder.add(GeometryAttribute::GENERIC, draco::DT_INT32, 1, narrow);
  } else if (all_are<float>(values)) {
    const std::vector<float> narrow(values.begin(), values.end());
    id = builder.add(GeometryAttribute::GENERIC, draco::DT_FLOAT32, 1, narrow);
  } else {
    id = builder.add(GeometryAttribute::GENERIC, draco::DT_FLOAT64, 1, values);
  }
  auto metadata = std::make_unique<draco::AttributeMetadata>();
  if (!property.name.empty()) metadata->AddEntryString("name", property.name);
  metadata->AddEntryInt("type", static_cast<std::int32_t>(property.type));
  builder.mesh().AddAttributeMetadata(id, std::move(metadata));
}

// ------------------------------------------------------------------------------------------------- decoding

[[noreturn]] void refuse(const std::string& what) {
  throw Failure(ExitCode::invalid, "DRAC section: " + what);
}

/// Calls `use(point, values)` for the first `points` points, with the attribute's components as T.
template <class T, std::size_t N, class Use>
void for_each_point(const draco::PointAttribute& attribute, std::size_t points, Use use) {
  for (std::uint32_t i = 0; i < points; ++i) {
    // An attribute that is coded on its own may map points to values that do not exist.
    const bool mapped = attribute.is_mapping_identity() || i < attribute.indices_map_size();
    const auto index = mapped ? attribute.mapped_index(draco::PointIndex(i))
                              : draco::AttributeValueIndex(std::numeric_limits<std::uint32_t>::max());
    std::array<T, N> value{};
    if (index.value() >= attribute.size() ||
        !attribute.ConvertValue<T, static_cast<int>(N)>(index, value.data()))
      refuse("the value of point " + std::to_string(i) + " is missing");
    use(i, value);
  }
}

template <std::size_t N>
std::vector<std::array<float, N>> named_values(const draco::Mesh& mesh, GeometryAttribute::Type type,
                                               const char* name, std::uint8_t bit,
                                               const std::vector<std::uint8_t>& mask, std::size_t points) {
  std::vector<std::array<float, N>> values;
  const draco::PointAttribute* attribute = mesh.GetNamedAttribute(type);
  if (attribute == nullptr) return values;
  if (attribute->num_components() != static_cast<int>(N))
    refuse(std::string(name) + " of " + std::to_string(attribute->num_components()) + " components");
  values.reserve(points);
  for_each_point<float, N>(*attribute, points, [&](std::uint32_t i, std::array<float, N> value) {
    if ((mask[i] & bit) != 0) value.fill(kNaN);
    values.push_back(value);
  });
  return values;
}

std::vector<std::uint8_t> decode_mask(const draco::Mesh& mesh) {
  const draco::PointAttribute* attribute = mesh.GetNamedAttribute(GeometryAttribute::GENERIC, 0);
  if (attribute == nullptr || attribute->data_type() != draco::DT_UINT8 || attribute->num_components() != 1)
    refuse("no mask of points");
  std::vector<std::uint8_t> mask;
  for_each_point<std::uint8_t, 1>(*attribute, mesh.num_points(),
                                  [&](std::uint32_t, const auto& value) { mask.push_back(value[0]); });
  return mask;
}

PointProperty decode_property(const draco::Mesh& mesh, int number, std::size_t points) {
  const int id = mesh.GetNamedAttributeId(GeometryAttribute::GENERIC, number);
  const draco::PointAttribute& attribute = *mesh.attribute(id);
  PointProperty property;
  std::int32_t type = -1;
  if (const auto* metadata = mesh.GetAttributeMetadataByAttributeId(id)) {
    metadata->GetEntryString("name", &property.name);
    metadata->GetEntryInt("type", &type);
  }
  if (type < 0 || type > static_cast<std::int32_t>(tetfmt::PropertyType::float64))
    refuse("property " + std::to_string(number - 1) + " is of no known type");
  if (attribute.num_components() != 1)
    refuse("property " + std::to_string(number - 1) + " has more than one component");
  property.type = static_cast<tetfmt::PropertyType>(type);
  property.values.reserve(points);
  for_each_point<double, 1>(attribute, points,
                            [&](std::uint32_t, const auto& value) { property.values.push_back(value[0]); });
  return property;
}

std::unique_ptr<draco::Mesh> decode_mesh(std::span<const std::byte> bytes) {
  // As for .drc files: a lie about counts must not take the machine down.
  const MemoryCeiling ceiling((std::uint64_t{1} << 30) + 2048 * std::uint64_t{bytes.size()});
  draco::DecoderBuffer buffer;
  buffer.Init(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  const auto kind = draco::Decoder::GetEncodedGeometryType(&buffer);
  if (!kind.ok() || kind.value() != draco::TRIANGULAR_MESH) refuse("no Draco mesh");
  try {
    draco::Decoder decoder;
    auto mesh = decoder.DecodeMeshFromBuffer(&buffer);
    if (!mesh.ok()) refuse("damaged (" + mesh.status().error_msg_string() + ")");
    return std::move(mesh).value();
  } catch (const std::bad_alloc&) {
  } catch (const std::length_error&) {
  }
  refuse("damaged (it claims more than its bytes can hold)");
}

}  // namespace

std::vector<std::byte> encode_draco(const Appearance& appearance) {
  const bool partial = std::any_of(appearance.corners.begin(), appearance.corners.end(), [](const auto& c) {
    return std::find(c.begin(), c.end(), kNone) != c.end();
  });
  const std::size_t points = appearance.surface_points + (partial ? 1 : 0);
  Builder builder(points);
  builder.mesh().SetNumFaces(appearance.corners.size());
  for (std::uint32_t i = 0; i < appearance.corners.size(); ++i) {
    draco::Mesh::Face face;
    for (std::size_t k = 0; k < 3; ++k)
      face[k] = std::min(appearance.corners[i][k], static_cast<Index>(appearance.surface_points));
    builder.mesh().SetFace(draco::FaceIndex(i), face);
  }

  std::vector<std::uint8_t> mask(points, 0);
  if (partial) mask.back() = kNoPoint;
  if (!appearance.normals.empty()) {
    std::vector<float> normals = flattened(appearance.normals, points, has_direction, kNoNormal,
                                           some_value(appearance.normals, has_direction, {0, 0, 1}), mask);
    builder.quantize(builder.add(GeometryAttribute::NORMAL, draco::DT_FLOAT32, 3, normals), kDracoNormalBits);
  }
  if (!appearance.texcoords.empty()) {
    builder.add_quantized(GeometryAttribute::TEX_COORD, 2,
                          flattened(appearance.texcoords, points, finite<2>, kNoTexcoord,
                                    some_value(appearance.texcoords, finite<2>, {}), mask),
                          kDracoTexcoordBits);
  }
  if (!appearance.colors.empty()) {
    add_colors(builder, flattened(appearance.colors, points, finite<4>, kNoColor,
                                  some_value(appearance.colors, finite<4>, {}), mask));
  }
  builder.add(GeometryAttribute::GENERIC, draco::DT_UINT8, 1, mask);
  for (const PointProperty& property : appearance.properties) add_property(builder, property, points);
  return builder.encode();
}

void decode_draco(std::span<const std::byte> bytes, Appearance& appearance) {
  const std::unique_ptr<draco::Mesh> mesh = decode_mesh(bytes);
  const std::vector<std::uint8_t> mask = decode_mask(*mesh);
  const bool partial = !mask.empty() && (mask.back() & kNoPoint) != 0;
  const std::size_t points = mask.size() - (partial ? 1 : 0);

  appearance.surface_points = points;
  appearance.corners.clear();
  appearance.corners.reserve(mesh->num_faces());
  for (std::uint32_t i = 0; i < mesh->num_faces(); ++i) {
    const auto& face = mesh->face(draco::FaceIndex(i));
    std::array<Index, 3> corners{};
    for (std::size_t k = 0; k < 3; ++k) {
      if (face[k].value() >= mask.size())
        refuse("a corner of face " + std::to_string(i) + " names point " + std::to_string(face[k].value()) +
               " of " + std::to_string(mask.size()));
      corners[k] = face[k].value() < points ? face[k].value() : kNone;
    }
    appearance.corners.push_back(corners);
  }
  appearance.normals = named_values<3>(*mesh, GeometryAttribute::NORMAL, "normals", kNoNormal, mask, points);
  appearance.texcoords =
      named_values<2>(*mesh, GeometryAttribute::TEX_COORD, "texture coordinates", kNoTexcoord, mask, points);
  appearance.colors = named_values<4>(*mesh, GeometryAttribute::COLOR, "colours", kNoColor, mask, points);
  appearance.properties.clear();
  const int generic = mesh->NumNamedAttributes(GeometryAttribute::GENERIC);
  for (int k = 1; k < generic; ++k) appearance.properties.push_back(decode_property(*mesh, k, points));
}

}  // namespace tetprep
