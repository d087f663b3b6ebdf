// SPDX-License-Identifier: AGPL-3.0-or-later
// What surfaces are made of, as far as this tracer knows.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "trace/image.hpp"
#include "trace/texture.hpp"

namespace tetprep {

enum class Finish : std::uint8_t {
  diffuse,  ///< scatters light evenly (Lambert), both sides alike
  mirror,   ///< reflects the share `color`
  glass,    ///< reflects and refracts (Fresnel); the front is outside, in air, the back inside
};
enum class VertexColors : std::uint8_t { none, srgb, linear };  ///< what a file's colours are taken for
enum class TextureOrigin : std::uint8_t { bottom, top };        ///< where v = 0 is

struct Material {
  Finish finish = Finish::diffuse;
  Rgb color{0.8, 0.8, 0.8};  ///< share of light that is scattered, reflected, or let through at each crossing
  Rgb emission;              ///< radiance, from both sides
  double ior = 1.5;          ///< index of refraction
  Rgb absorption;            ///< of glass: of each model unit inside, the share exp(-absorption) is left
  const Texture* texture = nullptr;  ///< multiplies `color`
  TextureOrigin texture_origin = TextureOrigin::bottom;
  VertexColors vertex_colors = VertexColors::srgb;  ///< multiply `color`
  bool smooth = true;                               ///< shade by the file's normals, where it has any

  bool emits() const { return brightest(emission) > 0; }
};

/// What a scene says differently.
struct MaterialChange {
  std::optional<Finish> finish;
  std::optional<Rgb> color;  ///< replaces the texture and the file's colours too, unless those are given here
  std::optional<Rgb> emission;
  std::optional<double> ior;
  std::optional<Rgb> absorption;
  std::optional<std::string> texture;       ///< the path of a PNG; empty: none
  std::string texture_where;                ///< in the scene file, for messages
  const Texture* loaded_texture = nullptr;  ///< of `texture`, once it is read
  std::optional<TextureOrigin> texture_origin;
  std::optional<VertexColors> vertex_colors;
  std::optional<bool> smooth;

  Material applied_to(Material material) const;
};

inline Material MaterialChange::applied_to(Material material) const {
  const auto set = [](auto& target, const auto& change) {
    if (change) target = *change;
  };
  if (color) {
    material.texture = nullptr;
    material.vertex_colors = VertexColors::none;
  }
  if (texture) {
    material.texture = loaded_texture;
    if (loaded_texture != nullptr && !color) material.color = {1, 1, 1};
  }
  set(material.finish, finish);
  set(material.color, color);
  set(material.emission, emission);
  set(material.ior, ior);
  set(material.absorption, absorption);
  set(material.texture_origin, texture_origin);
  set(material.vertex_colors, vertex_colors);
  set(material.smooth, smooth);
  return material;
}

}  // namespace tetprep
