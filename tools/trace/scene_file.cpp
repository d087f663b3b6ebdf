// SPDX-License-Identifier: AGPL-3.0-or-later
#include "trace/scene_file.hpp"

#include <filesystem>
#include <limits>

#include "trace/json_reader.hpp"

namespace tetprep {
namespace {

constexpr double kMaxLight = 1e12;  // products with areas and colours stay finite
constexpr double kMaxLength = 1e30;

/// `path` as seen from the folder of `file`.
std::string beside(const std::string& file, const std::string& path) {
  return (std::filesystem::path(file).parent_path() / path).string();
}

/// Reads one scene file; the members are its parts, from the inside out.
struct SceneReader {
  const std::string& file;

  MaterialChange change(const JsonValue& value) const {
    MaterialChange result;
    value.read_members({
        {"type",
         [&](const JsonValue& v) {
           result.finish = static_cast<Finish>(v.choice({"diffuse", "mirror", "glass"}));
         }},
        {"color", [&](const JsonValue& v) { result.color = v.color(1); }},
        {"emission", [&](const JsonValue& v) { result.emission = v.color(kMaxLight); }},
        {"ior", [&](const JsonValue& v) { result.ior = v.number(1, 10); }},
        {"absorption", [&](const JsonValue& v) { result.absorption = v.color(kMaxLight); }},
        {"texture",
         [&](const JsonValue& v) {
           if (!v.is_null() && !v.is_text()) v.expected("the path of a PNG, or null for no texture");
           result.texture = v.is_null() ? std::string() : beside(file, v.text());
           result.texture_where = v.where();
         }},
        {"texture_origin",
         [&](const JsonValue& v) {
           result.texture_origin = static_cast<TextureOrigin>(v.choice({"bottom", "top"}));
         }},
        {"vertex_colors",
         [&](const JsonValue& v) {
           result.vertex_colors = static_cast<VertexColors>(v.choice({"none", "srgb", "linear"}));
         }},
        {"smooth", [&](const JsonValue& v) { result.smooth = v.flag(); }},
    });
    return result;
  }

  std::vector<NamedChange> named_changes(const JsonValue& value) const {
    std::vector<NamedChange> result;
    value.each_member([&](const std::string& name, const JsonValue& v) {
      result.push_back({name, change(v), v.where()});
    });
    return result;
  }

  FileEntry entry(const JsonValue& value) const {
    FileEntry result;
    if (value.is_text()) {
      result.path = beside(file, value.text());
      return result;
    }
    if (!value.is_object()) value.expected("the path of a tet file, or an object with a \"path\"");
    value.read_members({
        {"path", [&](const JsonValue& v) { result.path = beside(file, v.text()); }},
        {"translate", [&](const JsonValue& v) { result.translate = v.vector(); }},
        {"material", [&](const JsonValue& v) { result.change = change(v); }},
        {"materials", [&](const JsonValue& v) { result.materials = named_changes(v); }},
        {"objects", [&](const JsonValue& v) { result.objects = named_changes(v); }},
    });
    if (result.path.empty()) value.refuse("the key \"path\" is missing; name a tet file");
    return result;
  }

  CameraWish camera(const JsonValue& value) const {
    CameraWish result;
    result.where = value.where();
    value.read_members({
        {"eye", [&](const JsonValue& v) { result.eye = v.vector(); }},
        {"look_at", [&](const JsonValue& v) { result.look_at = v.vector(); }},
        {"up",
         [&](const JsonValue& v) {
           result.up = v.vector();
           if (!(length(*result.up) > 0)) v.expected("a direction that is not zero");
         }},
        {"fov", [&](const JsonValue& v) { result.fov = v.number(0.01, 179); }},
        {"azimuth", [&](const JsonValue& v) { result.azimuth = v.number(-360, 360); }},
        {"elevation", [&](const JsonValue& v) { result.elevation = v.number(-89, 89); }},
    });
    return result;
  }

  PointLight point_light(const JsonValue& value) const {
    PointLight result;
    result.where = value.where();
    bool positioned = false, bright = false;
    value.read_members({
        {"position", [&](const JsonValue& v) { result.position = v.vector(), positioned = true; }},
        {"intensity", [&](const JsonValue& v) { result.intensity = v.color(kMaxLight), bright = true; }},
    });
    if (!positioned) value.refuse("the key \"position\" is missing: [x, y, z]");
    if (!bright) value.refuse("the key \"intensity\" is missing: a number or [r, g, b]");
    return result;
  }

  Background background(const JsonValue& value) const {
    if (!value.is_object()) {
      const Rgb color = value.color(kMaxLight);
      return {color, color};
    }
    Background result;
    value.read_members({
        {"bottom", [&](const JsonValue& v) { result.bottom = v.color(kMaxLight); }},
        {"top", [&](const JsonValue& v) { result.top = v.color(kMaxLight); }},
    });
    return result;
  }

  AmbientOcclusion ambient(const JsonValue& value) const {
    AmbientOcclusion result{std::numeric_limits<double>::infinity(), 1};
    value.read_members({
        {"distance", [&](const JsonValue& v) { result.distance = v.number(0, kMaxLength); }},
        {"samples", [&](const JsonValue& v) { result.samples = v.integer(1, kMaxSamples); }},
    });
    return result;
  }

  std::array<int, 2> size(const JsonValue& value) const {
    const auto edges = value.items();
    if (edges.size() != 2) value.expected("[width, height] in pixels");
    const std::array<int, 2> result{edges[0].integer(1, kMaxEdge), edges[1].integer(1, kMaxEdge)};
    if (std::int64_t{result[0]} * result[1] > kMaxPixels) value.expected("2^28 pixels in all at most");
    return result;
  }

  SceneDescription scene(const JsonValue& root) const {
    SceneDescription result;
    result.background = default_background();
    root.read_members({
        {"$schema", [](const JsonValue& v) { v.text(); }},
        {"description", [](const JsonValue& v) { v.text(); }},
        {"files",
         [&](const JsonValue& v) {
           for (const JsonValue& item : v.items(1)) result.files.push_back(entry(item));
           if (result.files.size() > kMaxFiles) v.expected("at most 1024 files; `tet convert` joins several");
         }},
        {"camera", [&](const JsonValue& v) { result.camera = camera(v); }},
        {"point_lights",
         [&](const JsonValue& v) {
           for (const JsonValue& item : v.items()) result.point_lights.push_back(point_light(item));
         }},
        {"background", [&](const JsonValue& v) { result.background = background(v); }},
        {"ambient_occlusion", [&](const JsonValue& v) { result.ambient = ambient(v); }},
        {"light_samples", [&](const JsonValue& v) { result.light_samples = v.integer(1, kMaxSamples); }},
        {"max_bounces", [&](const JsonValue& v) { result.max_bounces = v.integer(0, 64); }},
        {"samples", [&](const JsonValue& v) { result.samples = v.integer(1, kMaxSamples); }},
        {"size", [&](const JsonValue& v) { result.size = size(v); }},
    });
    if (result.files.empty()) root.refuse("the key \"files\" is missing: a list of tet files");
    return result;
  }

  static constexpr std::size_t kMaxFiles = 1024;
};

}  // namespace

Background default_background() {
  return {from_screen(214, 218, 224), from_screen(247, 248, 250)};
}

SceneDescription scene_of(const std::string& tet_file) {
  SceneDescription result;
  result.background = default_background();
  result.files.push_back({tet_file, {}, {}, {}, {}});
  return result;
}

SceneDescription read_scene_file(const std::string& path) {
  const JsonFile file(path);
  return SceneReader{path}.scene(file.root());
}

}  // namespace tetprep
