// SPDX-License-Identifier: AGPL-3.0-or-later
#include <algorithm>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <optional>
#include <unordered_map>

#include "common/buffered_file.hpp"
#include "surface/formats.hpp"

namespace tetprep {
namespace {

/// The values of surface points, each once.
template <std::size_t N>
struct DistinctValues {
  std::vector<std::array<float, N>> values;
  std::vector<Index> of_point;  ///< kNone where a point has none; empty if none has any

  explicit DistinctValues(const std::vector<std::array<float, N>>& all) {
    using Bits = std::array<std::uint32_t, N>;
    struct Hash {
      std::size_t operator()(const Bits& bits) const {
        std::uint64_t hash = 0;
        for (const std::uint32_t word : bits) hash = (hash ^ word) * 0x9E3779B97F4A7C15u + (hash >> 29);
        return static_cast<std::size_t>(hash ^ hash >> 32);
      }
    };
    std::unordered_map<Bits, Index, Hash> numbers;
    of_point.reserve(all.size());
    for (const auto& value : all) {
      if (std::any_of(value.begin(), value.end(), [](float x) { return std::isnan(x); })) {
        of_point.push_back(kNone);
        continue;
      }
      Bits bits;
      std::memcpy(bits.data(), value.data(), sizeof bits);
      const auto [place, is_new] = numbers.try_emplace(bits, static_cast<Index>(values.size()));
      if (is_new) values.push_back(value);
      of_point.push_back(place->second);
    }
  }

  Index at(Index surface_point) const {
    return of_point.empty() || surface_point == kNone ? kNone : of_point[surface_point];
  }
};

/// One triangle in OBJ's three kinds of numbers, from 0. kNone in one corner means kNone in all three.
struct Face {
  std::array<Index, 3> v, vt, vn;
};

/// A comment, and a line that goes on.
constexpr std::string_view kSpecial = "#\\";

bool all_there(const std::array<Index, 3>& numbers) {
  return std::find(numbers.begin(), numbers.end(), kNone) == numbers.end();
}

class ObjWriter final : public SurfaceWriter {
 public:
  explicit ObjWriter(const std::string& path) : path_(path), out_(path) {}

  std::vector<std::string> write(const SurfaceMesh& mesh) override {
    const Appearance& look = mesh.appearance;
    out_.text("# made by tet extract\n");
    if (!look.materials.empty()) {
      const std::string path = material_path(path_);
      BufferedFile materials(path);
      write_materials(mesh, materials);
      out_.text("mtllib ").text(printable(std::filesystem::path(path).filename().string())).text("\n");
      write_surface(mesh);
      materials.commit();
    } else {
      write_surface(mesh);
    }
    out_.commit();
    tell_losses(look);
    return std::move(losses_);
  }

 private:
  template <std::size_t N>
  void write_values(const char* keyword, const std::vector<std::array<float, N>>& values) {
    for (const auto& value : values) {
      out_.text(keyword);
      for (const float x : value) out_.text(" ").number(x);
      out_.text("\n");
    }
  }

  void write_surface(const SurfaceMesh& mesh) {
    const DistinctValues<4> colors(mesh.appearance.colors);
    const DistinctValues<2> texcoords(mesh.appearance.texcoords);
    const DistinctValues<3> normals(mesh.appearance.normals);
    const std::vector<Face> faces = write_vertices(mesh, colors, texcoords, normals);
    write_values("vt", texcoords.values);
    write_values("vn", normals.values);
    write_faces(mesh, faces);
  }

  /// A vertex is a place and a colour.
  std::vector<Face> write_vertices(const SurfaceMesh& mesh, const DistinctValues<4>& colors,
                                   const DistinctValues<2>& texcoords, const DistinctValues<3>& normals) {
    std::unordered_map<std::uint64_t, Index> numbers;
    numbers.reserve(mesh.points.size());
    std::size_t without_texcoords = 0, without_normals = 0;
    std::vector<Face> faces(mesh.triangles.size());
    for (std::size_t i = 0; i < faces.size(); ++i) {
      Face& face = faces[i];
      for (std::size_t k = 0; k < 3; ++k) {
        const Index point = mesh.triangles[i][k], surface = surface_point(mesh, i, k);
        const Index color = colors.at(surface);
        const auto [place, is_new] =
            numbers.try_emplace(std::uint64_t{point} << 32 | color, static_cast<Index>(numbers.size()));
        if (is_new) {
          out_.text("v");
          for (const double x : mesh.points[point]) out_.text(" ").number(x);
          if (color != kNone)
            for (std::size_t c = 0; c < 3; ++c) out_.text(" ").number(colors.values[color][c]);
          out_.text("\n");
        }
        face.v[k] = place->second;
        face.vt[k] = texcoords.at(surface);
        face.vn[k] = normals.at(surface);
      }
      without_texcoords += uniform(face.vt);
      without_normals += uniform(face.vn);
    }
    const auto lost = [&](std::size_t triangles, const char* what) {
      if (triangles > 0)
        losses_.push_back(std::to_string(triangles) +
                          (triangles == 1 ? " triangle has " : " triangles have ") + what +
                          " at some corners only, which OBJ cannot say: left out there");
    };
    lost(without_texcoords, "texture coordinates");
    lost(without_normals, "normals");
    return faces;
  }

  /// None for all if there is none for one. True if that lost something.
  static bool uniform(std::array<Index, 3>& numbers) {
    if (all_there(numbers)) return false;
    const bool lost = numbers != std::array{kNone, kNone, kNone};
    numbers.fill(kNone);
    return lost;
  }

  void write_faces(const SurfaceMesh& mesh, const std::vector<Face>& faces) {
    const Appearance& look = mesh.appearance;
    const std::vector<std::string> objects = object_names(look);
    const char* keyword = objects_are_runs(mesh) ? "o " : "g ";
    Index object = kNone;
    std::optional<Index> material;
    for (std::size_t i = 0; i < faces.size(); ++i) {
      if (!objects.empty() && object != of_triangle(look.triangle_object, mesh, i)) {
        object = of_triangle(look.triangle_object, mesh, i);
        out_.text(keyword).text(objects[object]).text("\n");
      }
      if (!look.materials.empty() && material != of_triangle(look.triangle_material, mesh, i)) {
        material = of_triangle(look.triangle_material, mesh, i);
        out_.text("usemtl ").text(material_names_[*material == kNone ? look.materials.size() : *material]);
        out_.text("\n");
      }
      write_face(faces[i]);
    }
  }

  void write_face(const Face& face) {
    out_.text("f");
    for (std::size_t k = 0; k < 3; ++k) {
      out_.text(" ").number(face.v[k] + std::uint64_t{1});
      if (face.vt[k] != kNone || face.vn[k] != kNone) out_.text("/");
      if (face.vt[k] != kNone) out_.number(face.vt[k] + std::uint64_t{1});
      if (face.vn[k] != kNone) out_.text("/").number(face.vn[k] + std::uint64_t{1});
    }
    out_.text("\n");
  }

  /// OBJ has one name for an object: its own, or else that of the file that it came from.
  static std::vector<std::string> object_names(const Appearance& look) {
    std::vector<std::string> names;
    for (const Object& object : look.objects)
      names.push_back(object.name.empty() ? object.source : object.name);
    return distinct_names(names, "object_", kSpecial);
  }

  /// "o" begins an object; "g" may come back to one.
  static bool objects_are_runs(const SurfaceMesh& mesh) {
    std::vector<bool> ended(mesh.appearance.objects.size(), false);
    for (std::size_t i = 1; i < mesh.triangles.size(); ++i) {
      const Index before = of_triangle(mesh.appearance.triangle_object, mesh, i - 1);
      const Index now = of_triangle(mesh.appearance.triangle_object, mesh, i);
      if (before == now) continue;
      ended[before] = true;
      if (ended[now]) return false;
    }
    return true;
  }

  void write_materials(const SurfaceMesh& mesh, BufferedFile& out) {
    const Appearance& look = mesh.appearance;
    std::vector<std::string> names;
    for (const Material& material : look.materials) names.push_back(material.name);
    names.emplace_back("unknown");
    material_names_ = distinct_names(names, "material_", kSpecial);
    const auto color = [&](const char* keyword, const float* values) {
      out.text(keyword);
      for (std::size_t k = 0; k < 3; ++k) out.text(" ").number(values[k]);
      out.text("\n");
    };
    const auto factor = [&](const char* keyword, float value) {
      out.text(keyword).text(" ").number(value).text("\n");
    };
    out.text("# made by tet extract\n");
    for (std::size_t i = 0; i < look.materials.size(); ++i) {
      const tetfmt::Material& values = look.materials[i].values;
      out.text("newmtl ").text(material_names_[i]).text("\n");
      color("Kd", values.base_color.data());
      factor("d", values.base_color[3]);
      color("Ke", values.emission.data());
      factor("Ni", values.ior);
      factor("Pm", values.metallic);
      factor("Pr", values.roughness);
      if (values.transmission > 0) {
        const std::array transmitted = {values.transmission, values.transmission, values.transmission};
        color("Tf", transmitted.data());
        out.text("illum 6\n");  // refraction: without it, readers take Tf for leftovers
      }
      if (!look.materials[i].base_color_texture.empty())
        out.text("map_Kd ").text(printable(look.materials[i].base_color_texture)).text("\n");
    }
    const auto& of = look.triangle_material;
    const bool unknown = std::any_of(mesh.input_triangle.begin(), mesh.input_triangle.end(),
                                     [&](Index t) { return !of.empty() && of[t] == kNone; });
    if (unknown) out.text("newmtl ").text(material_names_.back()).text("\n");
  }

  void tell_losses(const Appearance& look) {
    if (!look.properties.empty())
      losses_.push_back(
          std::to_string(look.properties.size()) +
          " properties of vertices left out, for which OBJ has no place; write a .ply to keep them");
    if (std::any_of(look.colors.begin(), look.colors.end(), [](const auto& color) { return color[3] < 1; }))
      losses_.emplace_back("opacity of vertex colours left out, for which OBJ has no place");
    if (std::any_of(look.colors.begin(), look.colors.end(), [](const auto& color) {
          return std::any_of(color.begin(), color.end(), [](float x) { return x > 1; });
        }))
      losses_.emplace_back("some vertex colours are above 1: readers may take all of them for 0 to 255");
  }

  std::string path_;
  BufferedFile out_;
  std::vector<std::string> material_names_;  ///< and one more, for triangles whose material is not known
  std::vector<std::string> losses_;
};

}  // namespace

std::unique_ptr<SurfaceWriter> make_obj_writer(const std::string& path) {
  return std::make_unique<ObjWriter>(path);
}

}  // namespace tetprep
