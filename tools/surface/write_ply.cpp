// SPDX-License-Identifier: AGPL-3.0-or-later
#include <algorithm>
#include <cmath>
#include <limits>
#include <unordered_map>

#include "common/buffered_file.hpp"
#include "common/unit_color.hpp"
#include "surface/formats.hpp"

namespace tetprep {
namespace {

using tetfmt::PropertyType;

constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();

const char* type_name(PropertyType type) {
  constexpr std::array kNames = {"char", "uchar", "short", "ushort", "int", "uint", "float", "double"};
  return kNames[static_cast<std::size_t>(type)];
}

template <class T>
bool holds(double value) {
  if constexpr (std::is_floating_point_v<T>) {
    // Beyond its range, a cast to float would be undefined.
    return std::isnan(value) || std::isinf(value) ||
           (std::abs(value) <= static_cast<double>(std::numeric_limits<T>::max()) &&
            static_cast<double>(static_cast<T>(value)) == value);
  } else {
    return value >= static_cast<double>(std::numeric_limits<T>::min()) &&
           value <= static_cast<double>(std::numeric_limits<T>::max()) && std::trunc(value) == value;
  }
}

/// Calls `use` with a value of the C++ type that `type` stands for.
template <class Use>
auto with_type(PropertyType type, Use use) {
  switch (type) {
    case PropertyType::int8:
      return use(std::int8_t{});
    case PropertyType::uint8:
      return use(std::uint8_t{});
    case PropertyType::int16:
      return use(std::int16_t{});
    case PropertyType::uint16:
      return use(std::uint16_t{});
    case PropertyType::int32:
      return use(std::int32_t{});
    case PropertyType::uint32:
      return use(std::uint32_t{});
    case PropertyType::float32:
      return use(float{});
    case PropertyType::float64:
      break;
  }
  return use(double{});
}

/// Values of one element, one after the other, as text or bytes.
class Row {
 public:
  Row(BufferedFile& out, bool ascii) : out_(out), ascii_(ascii) {}
  template <class T>
  Row& put(T value) {
    if (!ascii_) {
      out_.raw(value);
      return *this;
    }
    if (!first_) out_.text(" ");
    first_ = false;
    std::string text;
    if constexpr (std::is_floating_point_v<T>) {
      append_number(text, value);
    } else {
      append_number(text, static_cast<long long>(value));
    }
    out_.text(text);
    return *this;
  }
  void end() {
    if (ascii_) out_.text("\n");
    first_ = true;
  }

 private:
  BufferedFile& out_;
  bool ascii_, first_ = true;
};

/// A place and what it looks like there.
struct Vertex {
  Index point, surface_point;
};

class PlyWriter final : public SurfaceWriter {
 public:
  PlyWriter(const std::string& path, const SurfaceWriterOptions& options) : out_(path), options_(options) {}

  std::vector<std::string> write(const SurfaceMesh& mesh) override {
    const std::vector<std::array<Index, 3>> faces = make_vertices(mesh);
    choose_types(mesh.appearance);
    write_header(mesh, faces.size());
    write_vertices(mesh);
    write_faces(mesh, faces);
    out_.commit();
    return {};
  }

 private:
  /// Vertices in order of first use, and the faces by them.
  std::vector<std::array<Index, 3>> make_vertices(const SurfaceMesh& mesh) {
    std::unordered_map<std::uint64_t, Index> numbers;
    if (!mesh.appearance.corners.empty()) numbers.reserve(mesh.appearance.surface_points);
    std::vector<std::array<Index, 3>> faces(mesh.triangles.size());
    for (std::size_t i = 0; i < faces.size(); ++i) {
      for (std::size_t k = 0; k < 3; ++k) {
        const Vertex vertex{mesh.triangles[i][k], surface_point(mesh, i, k)};
        bare_vertices_ = bare_vertices_ || vertex.surface_point == kNone;
        const std::uint64_t key = std::uint64_t{vertex.point} << 32 | vertex.surface_point;
        const auto [place, is_new] = numbers.try_emplace(key, static_cast<Index>(vertices_.size()));
        if (is_new) vertices_.push_back(vertex);
        faces[i][k] = place->second;
      }
    }
    return faces;
  }

  void choose_types(const Appearance& look) {
    byte_colors_ = !bare_vertices_;
    alpha_ = false;
    for (const auto& color : look.colors) {
      for (const float component : color) byte_colors_ = byte_colors_ && unit_byte(component).has_value();
      alpha_ = alpha_ || !(color[3] == 1);
    }
    for (const PointProperty& property : look.properties) {
      const bool fits = with_type(property.type, [&](auto zero) {
        using T = decltype(zero);
        return (std::is_floating_point_v<T> || !bare_vertices_) &&
               std::all_of(property.values.begin(), property.values.end(), holds<T>);
      });
      types_.push_back(fits ? property.type : PropertyType::float64);
    }
  }

  void write_header(const SurfaceMesh& mesh, std::size_t faces) {
    const Appearance& look = mesh.appearance;
    out_.text("ply\nformat ").text(options_.ascii ? "ascii" : "binary_little_endian").text(" 1.0\n");
    out_.text("comment made by tet extract\n");
    std::vector<std::string> names;
    for (const Material& material : look.materials) names.push_back(material.name);
    write_names("material", names);
    for (const Material& material : look.materials) {
      textures_.push_back(material.base_color_texture.empty() ? -1 : texture_count_++);
      if (textures_.back() >= 0)
        out_.text("comment TextureFile ").text(printable(material.base_color_texture)).text("\n");
    }
    names.clear();
    for (const Object& object : look.objects)
      names.push_back(object.source.empty() ? object.name : object.name + " of " + object.source);
    write_names("object", names);

    out_.text("element vertex ").number(std::uint64_t{vertices_.size()}).text("\n");
    const auto properties = [&](const char* type, std::initializer_list<const char*> list) {
      for (const char* name : list) out_.text("property ").text(type).text(" ").text(name).text("\n");
    };
    properties("double", {"x", "y", "z"});
    if (!look.normals.empty()) properties("float", {"nx", "ny", "nz"});
    if (!look.texcoords.empty()) properties("float", {"s", "t"});
    if (!look.colors.empty()) {
      properties(byte_colors_ ? "uchar" : "float", {"red", "green", "blue"});
      if (alpha_) properties(byte_colors_ ? "uchar" : "float", {"alpha"});
    }
    names.clear();
    for (const PointProperty& property : look.properties) names.push_back(property.name);
    names = distinct_names(names, "property_", " ",
                           {"x", "y", "z", "nx", "ny", "nz", "s", "t", "red", "green", "blue", "alpha"});
    for (std::size_t i = 0; i < names.size(); ++i) properties(type_name(types_[i]), {names[i].c_str()});

    out_.text("element face ").number(std::uint64_t{faces}).text("\n");
    properties("list uchar int", {"vertex_indices"});
    if (!look.materials.empty()) properties("int", {"material"});
    if (texture_count_ > 0) properties("int", {"texnumber"});
    if (!look.objects.empty()) properties("int", {"object"});
    if (options_.input_triangles) properties("int", {"input_triangle"});
    out_.text("end_header\n");
  }

  void write_names(const char* what, const std::vector<std::string>& names) {
    for (std::size_t i = 0; i < names.size(); ++i) {
      out_.text("comment ").text(what).text(" ").number(std::uint64_t{i}).text(" ");
      out_.text(printable(names[i])).text("\n");
    }
  }

  void write_vertices(const SurfaceMesh& mesh) {
    const Appearance& look = mesh.appearance;
    Row row(out_, options_.ascii);
    for (const auto& [point, surface] : vertices_) {
      const bool bare = surface == kNone;
      for (const double x : mesh.points[point]) row.put(x);
      if (!look.normals.empty())
        for (std::size_t k = 0; k < 3; ++k) row.put(bare ? kNaN : look.normals[surface][k]);
      if (!look.texcoords.empty())
        for (std::size_t k = 0; k < 2; ++k) row.put(bare ? kNaN : look.texcoords[surface][k]);
      if (!look.colors.empty()) {
        for (std::size_t k = 0; k < (alpha_ ? 4 : 3); ++k) {
          if (byte_colors_) {
            row.put(*unit_byte(look.colors[surface][k]));
          } else {
            row.put(bare ? kNaN : look.colors[surface][k]);
          }
        }
      }
      for (std::size_t i = 0; i < types_.size(); ++i) {
        const double value =
            bare ? std::numeric_limits<double>::quiet_NaN() : look.properties[i].values[surface];
        with_type(types_[i], [&](auto zero) { row.put(static_cast<decltype(zero)>(value)); });
      }
      row.end();
    }
  }

  void write_faces(const SurfaceMesh& mesh, const std::vector<std::array<Index, 3>>& faces) {
    const Appearance& look = mesh.appearance;
    Row row(out_, options_.ascii);
    for (std::size_t i = 0; i < faces.size(); ++i) {
      row.put(std::uint8_t{3});
      for (const Index vertex : faces[i]) row.put(static_cast<std::int32_t>(vertex));
      const Index material = of_triangle(look.triangle_material, mesh, i);
      if (!look.materials.empty()) row.put(static_cast<std::int32_t>(material));  // kNone reads as -1
      if (texture_count_ > 0) row.put(material == kNone ? -1 : textures_[material]);
      if (!look.objects.empty())
        row.put(static_cast<std::int32_t>(of_triangle(look.triangle_object, mesh, i)));
      if (options_.input_triangles) row.put(static_cast<std::int32_t>(mesh.input_triangle[i]));
      row.end();
    }
  }

  BufferedFile out_;
  SurfaceWriterOptions options_;
  std::vector<Vertex> vertices_;
  std::vector<std::int32_t> textures_;  ///< of each material: which TextureFile, or -1
  std::int32_t texture_count_ = 0;
  bool bare_vertices_ = false;  ///< some have no surface point, so every type must have room for nan
  bool byte_colors_ = false, alpha_ = false;
  std::vector<PropertyType> types_;  ///< of the properties
};

}  // namespace

std::unique_ptr<SurfaceWriter> make_ply_writer(const std::string& path, const SurfaceWriterOptions& options) {
  return std::make_unique<PlyWriter>(path, options);
}

}  // namespace tetprep
