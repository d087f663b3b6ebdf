// SPDX-License-Identifier: AGPL-3.0-or-later
#include "trace/surface.hpp"

#include <algorithm>
#include <cmath>

namespace tetprep {
namespace {

/// (b - a) x (c - a), unit length; zero if any vertex is none.
Vec3 normal_of(std::span<const tetfmt::Vec3f> vertices, const std::array<tetfmt::Index, 3>& corners) {
  for (const tetfmt::Index v : corners) {
    if (v >= vertices.size()) return {};
  }
  const Vec3 a = vec3(vertices[corners[0]]);
  const Vec3 normal = cross(vec3(vertices[corners[1]]) - a, vec3(vertices[corners[2]]) - a);
  const double size = length(normal);
  return size > 0 ? (1 / size) * normal : Vec3{};
}

/// Values of the surface points at a hit. NaN where there are none.
template <std::size_t N>
std::array<double, N> value_at(const tetfmt::SurfaceAttributes& attributes,
                               std::span<const std::array<float, N>> values, const tetfmt::Hit& hit) {
  std::array<double, N> result;
  result.fill(std::numeric_limits<double>::quiet_NaN());
  if (hit.triangle >= attributes.corners.size()) return result;
  const auto& corners = attributes.corners[hit.triangle];
  for (const tetfmt::Index c : corners) {
    if (c >= values.size()) return result;
  }
  const auto found = tetfmt::interpolate(values, corners, hit);
  std::copy(found.begin(), found.end(), result.begin());
  return result;
}

}  // namespace

Vec3 triangle_normal(const tetfmt::FileView& view, tetfmt::Index triangle) {
  if (triangle >= view.input_triangles().size()) return {};
  return normal_of(view.vertices(), view.input_triangles()[triangle].vertices);
}

SurfacePoint surface_at(const Scene& scene, const SceneHit& hit, Vec3 direction) {
  const Part& part = *scene.parts[hit.part];
  SurfacePoint point;
  point.material = part.material_of(hit.hit.side, hit.hit.triangle);
  Material& material = point.material;

  // A partial file may not have all corners of a triangle that was cut up: the face is part of it.
  Vec3 normal = triangle_normal(part.view(), hit.hit.triangle);
  bool away = hit.hit.back;
  if (length(normal) == 0) {
    normal = normal_of(part.view().vertices(), hit.hit.face);
    if (length(normal) == 0) normal = -unit(direction);
    away = dot(normal, direction) > 0;
  }
  point.true_normal = away ? -normal : normal;
  point.normal = point.true_normal;

  const auto& attributes = part.attributes;
  if (material.smooth && !attributes.normals.empty()) {
    const Vec3 given = vec3(value_at(attributes, attributes.normals, hit.hit));
    const double size = length(given);
    // Which way it points is the triangle's word: some files have normals that point the other way.
    if (size > 0 && std::isfinite(size))
      point.normal = (dot(given, point.true_normal) < 0 ? -1 / size : 1 / size) * given;
  }
  if (material.vertex_colors != VertexColors::none && !attributes.colors.empty()) {
    const auto color = value_at(attributes, attributes.colors, hit.hit);
    const auto light = [&](double x) {
      const double share = std::clamp(x, 0.0, 1.0);
      return material.vertex_colors == VertexColors::srgb ? srgb_decode(share) : share;
    };
    if (!std::isnan(color[0] + color[1] + color[2]))
      material.color = material.color * Rgb{light(color[0]), light(color[1]), light(color[2])};
  }
  if (material.texture != nullptr && !attributes.texcoords.empty()) {
    const auto place = value_at(attributes, attributes.texcoords, hit.hit);
    const double v = material.texture_origin == TextureOrigin::top ? 1 - place[1] : place[1];
    if (!std::isnan(place[0] + v)) material.color = material.color * material.texture->at(place[0], v);
  }
  return point;
}

}  // namespace tetprep
