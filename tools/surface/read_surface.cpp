// SPDX-License-Identifier: AGPL-3.0-or-later
#include "surface/read_surface.hpp"

#include <algorithm>

#include "common/failure.hpp"
#include "prep/draco_surface.hpp"
#include "tetfmt/attributes.hpp"

namespace tetprep {
namespace {

using tetfmt::FileView;
using tetfmt::SurfaceAttributes;

template <class T>
std::vector<T> copied(std::span<const T> values) {
  return {values.begin(), values.end()};
}

void read_tables(const SurfaceAttributes& stored, Appearance& appearance) {
  const auto text = [&](tetfmt::TextRef ref) { return std::string(stored.text(ref)); };
  for (tetfmt::Material material : stored.materials) {
    const std::string name = text(material.name), texture = text(material.base_color_texture);
    material.name = material.base_color_texture = kNone;
    appearance.materials.push_back({name, texture, material});
  }
  for (const tetfmt::Object& object : stored.objects)
    appearance.objects.push_back({text(object.name), text(object.source)});
  appearance.triangle_object = copied(stored.triangle_objects);
}

void read_points(const SurfaceAttributes& stored, Appearance& appearance) {
  appearance.corners = copied(stored.corners);
  appearance.normals = copied(stored.normals);
  appearance.texcoords = copied(stored.texcoords);
  appearance.colors = copied(stored.colors);
  const std::size_t properties = stored.properties.size();
  const std::size_t per_property = properties == 0 ? 0 : stored.property_values.size() / properties;
  appearance.surface_points = std::max(
      {appearance.normals.size(), appearance.texcoords.size(), appearance.colors.size(), per_property});
  for (std::size_t i = 0; i < properties; ++i) {
    const auto values = stored.property_values.subspan(i * per_property, per_property);
    appearance.properties.push_back({std::string(stored.text(stored.properties[i].name)),
                                     static_cast<tetfmt::PropertyType>(stored.properties[i].type),
                                     copied(values)});
  }
}

/// A side's material is its input triangle's.
std::vector<Index> triangle_materials(const FileView& view) {
  std::vector<Index> materials(view.input_triangles().size(), kNone);
  for (const tetfmt::Side& side : view.sides()) {
    const Index input = view.origins().empty() ? side.triangle : view.origins()[side.triangle];
    materials[input] = side.material;
  }
  return materials;
}

}  // namespace

Appearance read_appearance(const FileView& view) {
  const SurfaceAttributes stored(view);
  Appearance appearance;
  read_tables(stored, appearance);
  const auto draco = view.section(tetfmt::kDracoSurface);
  if (draco.empty()) {
    read_points(stored, appearance);
  } else {
    decode_draco(draco, appearance);
    if (appearance.corners.size() != view.input_triangles().size())
      throw Failure(ExitCode::invalid, "DRAC section: " + std::to_string(appearance.corners.size()) +
                                           " faces for " + std::to_string(view.input_triangles().size()) +
                                           " input triangles");
  }
  if (!appearance.materials.empty()) appearance.triangle_material = triangle_materials(view);
  return appearance;
}

SurfaceMesh read_surface(const tetfmt::TrustedView& file, bool pieces) {
  const FileView& view = file.view();
  SurfaceMesh mesh;
  mesh.appearance = read_appearance(view);
  mesh.input_triangle_count = view.input_triangles().size();
  const auto dropped = [](const tetfmt::Triangle& triangle) { return triangle.dropped(); };
  const auto inputs = view.input_triangles();
  mesh.left_out = static_cast<std::size_t>(std::count_if(inputs.begin(), inputs.end(), dropped));
  if (pieces) {
    mesh.appearance.surface_points = 0;
    mesh.appearance.corners.clear();
    mesh.appearance.normals.clear();
    mesh.appearance.texcoords.clear();
    mesh.appearance.colors.clear();
    mesh.appearance.properties.clear();
  }

  const auto& origin = view.header().origin;
  std::vector<Index> numbers(view.vertices().size(), kNone);  // of each vertex among the points
  const auto number_of = [&](Index vertex) {
    Index& number = numbers[vertex];
    if (number == kNone) {
      number = static_cast<Index>(mesh.points.size());
      const auto& [x, y, z] = view.vertices()[vertex];
      mesh.points.push_back({origin[0] + static_cast<double>(x), origin[1] + static_cast<double>(y),
                             origin[2] + static_cast<double>(z)});
    }
    return number;
  };
  const auto triangles = pieces ? view.triangles() : inputs;
  for (Index i = 0; i < triangles.size(); ++i) {
    if (triangles[i].dropped()) continue;
    std::array<Index, 3> corners{};
    for (std::size_t k = 0; k < 3; ++k) corners[k] = number_of(triangles[i].vertices[k]);
    mesh.triangles.push_back(corners);
    mesh.input_triangle.push_back(pieces && !view.origins().empty() ? view.origins()[i] : i);
  }
  return mesh;
}

}  // namespace tetprep
