// SPDX-License-Identifier: AGPL-3.0-or-later
#include "trace/scene.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>

#include "common/failure.hpp"
#include "common/parse.hpp"
#include "trace/json_reader.hpp"

namespace tetprep {
namespace {

/// A material as the file has it, without its texture. Values that make no sense fall back to the default.
Material from_file(const tetfmt::Material& m) {
  const auto within = [](float x, float low, float high, double otherwise) {
    return x >= low && x <= high ? static_cast<double>(x) : otherwise;
  };
  Material result;
  result.color = {within(m.base_color[0], 0, 1, 0.8), within(m.base_color[1], 0, 1, 0.8),
                  within(m.base_color[2], 0, 1, 0.8)};
  result.emission = {within(m.emission[0], 0, 1e12f, 0), within(m.emission[1], 0, 1e12f, 0),
                     within(m.emission[2], 0, 1e12f, 0)};
  result.ior = within(m.ior, 1, 10, 1.5);
  // Of the many looks between, this tracer knows the three ends.
  if (m.transmission >= 0.5f) {
    result.finish = Finish::glass;
  } else if (m.metallic >= 0.5f && m.roughness <= 0.25f) {
    result.finish = Finish::mirror;
  }
  return result;
}

/// Opens parts and textures, each texture once.
class Opener {
 public:
  explicit Opener(Scene& scene) : scene_(scene) {}

  void materials(Part& part, FileEntry entry) {
    load(entry.change);
    for (NamedChange& named : entry.materials) load(named.change);
    for (NamedChange& named : entry.objects) load(named.change);

    const auto& attributes = part.attributes;
    std::vector<std::string_view> names;
    for (const tetfmt::Material& m : attributes.materials) names.push_back(attributes.text(m.name));
    require_names(entry.materials, names, "material", part);
    if (attributes.materials.empty()) {
      Material plain;
      // Colours at points are the file's only word on colour.
      if (!attributes.colors.empty()) plain.color = {1, 1, 1};
      part.materials.push_back(entry.change.applied_to(plain));
    }
    const bool textured = !attributes.texcoords.empty();
    const TextureOrigin texture_origin = textured ? origin_of_textures(part) : TextureOrigin::bottom;
    for (std::size_t i = 0; i < names.size(); ++i) {
      std::vector<const MaterialChange*> changes{&entry.change};
      for (const NamedChange& named : entry.materials)
        if (named.name == names[i]) changes.push_back(&named.change);
      const bool replaced = std::any_of(changes.begin(), changes.end(),
                                        [](const MaterialChange* c) { return c->color || c->texture; });
      Material material = from_file(attributes.materials[i]);
      if (!replaced && textured) material.texture = files_texture(part, attributes.materials[i]);
      material.texture_origin = texture_origin;
      for (const MaterialChange* change : changes) material = change->applied_to(material);
      part.materials.push_back(material);
    }
    objects(part, entry);
  }

 private:
  void objects(Part& part, const FileEntry& entry) {
    if (entry.objects.empty()) return;
    const auto& attributes = part.attributes;
    std::vector<std::string_view> names, sources;
    for (const tetfmt::Object& object : attributes.objects) {
      names.push_back(attributes.text(object.name));
      sources.push_back(attributes.text(object.source));
    }
    std::vector<std::string_view> known = names;
    known.insert(known.end(), sources.begin(), sources.end());
    require_names(entry.objects, known, "object", part);
    part.object_changes.resize(names.size());
    for (std::size_t i = 0; i < names.size(); ++i) {
      for (const NamedChange& named : entry.objects)
        if (named.name == names[i] || named.name == sources[i]) part.object_changes[i] = named.change;
    }
  }

  static void require_names(const std::vector<NamedChange>& changes,
                            const std::vector<std::string_view>& names, const std::string& kind,
                            const Part& part) {
    for (const NamedChange& named : changes) {
      if (std::find(names.begin(), names.end(), named.name) != names.end()) continue;
      const std::string_view near = nearest_name(named.name, names);
      throw Failure(ExitCode::invalid, named.where + ": " + part.file.path() + " has no " + kind + " '" +
                                           named.name + "'; " +
                                           (near.empty() ? "`tet info` lists those that it has"
                                                         : "did you mean '" + std::string(near) + "'?"));
    }
  }

  /// Textures are PNG with v upwards, as OBJ has it; glTF counts from the top.
  static TextureOrigin origin_of_textures(const Part& part) {
    const auto& objects = part.attributes.objects;
    const auto is_gltf = [&](const tetfmt::Object& object) {
      const std::string_view source = part.attributes.text(object.source);
      return source.ends_with(".glb") || source.ends_with(".gltf");
    };
    return !objects.empty() && std::all_of(objects.begin(), objects.end(), is_gltf) ? TextureOrigin::top
                                                                                    : TextureOrigin::bottom;
  }

  const Texture* texture(const std::string& path) {
    const Texture*& known = textures_[path];
    if (known == nullptr) {
      known = scene_.textures.emplace_back(std::make_unique<Texture>(Texture::read_png(path))).get();
      scene_.texture_files.push_back(path);
    }
    return known;
  }

  void load(MaterialChange& change) {
    if (!change.texture || change.texture->empty()) return;
    try {
      change.loaded_texture = texture(*change.texture);
    } catch (const Failure& failure) {
      throw Failure(failure.code(), change.texture_where + ": " + failure.what());
    }
  }

  /// A texture that the tet file names may have stayed behind: then there is a warning instead.
  const Texture* files_texture(const Part& part, const tetfmt::Material& material) {
    const std::string name(part.attributes.text(material.base_color_texture));
    if (name.empty()) return nullptr;
    const std::string path = (std::filesystem::path(part.file.path()).parent_path() / name).string();
    if (const auto known = textures_.find(path); known != textures_.end()) return known->second;
    try {
      return texture(path);
    } catch (const Failure& failure) {
      scene_.warnings.push_back(std::string(failure.what()) + "; the plain colour takes the texture's place");
      return textures_[path] = nullptr;
    }
  }

  Scene& scene_;
  std::map<std::string, const Texture*> textures_;
};

/// Leaves no span of what no material asks for, so that nothing can read it.
void drop_unused_attributes(Part& part, bool shaded) {
  auto& a = part.attributes;
  const auto asked = [&](auto asks) {
    return shaded && std::any_of(part.materials.begin(), part.materials.end(), asks);
  };
  // What an object changes is on top of any material.
  const auto changed = [&](auto asks) {
    return shaded && std::any_of(part.object_changes.begin(), part.object_changes.end(), asks);
  };
  if (!asked([](const Material& m) { return m.smooth; }) &&
      !changed([](const MaterialChange& c) { return c.smooth.value_or(false); }))
    a.normals = {};
  if (!asked([](const Material& m) { return m.texture != nullptr; }) &&
      !changed([](const MaterialChange& c) { return c.loaded_texture != nullptr; }))
    a.texcoords = {};
  if (!asked([](const Material& m) { return m.vertex_colors != VertexColors::none; }) &&
      !changed([](const MaterialChange& c) {
        return c.vertex_colors.value_or(VertexColors::none) != VertexColors::none;
      }))
    a.colors = {};
  if (a.normals.empty() && a.texcoords.empty() && a.colors.empty()) a.corners = {};
  if (part.object_changes.empty()) a.triangle_objects = {};
  if (part.object_changes.empty() && a.texcoords.empty()) a.objects = {};
  if (!shaded) a.materials = {};
  a.properties = {};
  a.property_values = {};
}

void add_light_triangles(Scene& scene, std::size_t index) {
  const Part& part = *scene.parts[index];
  const auto emits = [](const Material& m) { return m.emits(); };
  const bool any = std::any_of(part.materials.begin(), part.materials.end(), emits) ||
                   std::any_of(part.object_changes.begin(), part.object_changes.end(),
                               [&](const MaterialChange& c) { return emits(c.applied_to({})); });
  if (!any) return;
  const auto& view = part.view();
  const auto vertices = view.vertices();
  const auto triangles = view.triangles();
  const auto origins = view.origins();
  std::vector<bool> seen(triangles.size());
  for (tetfmt::Index s = 0; s < view.sides().size(); s += 2) {
    const tetfmt::Index piece = view.sides()[s].triangle;
    if (piece >= triangles.size() || seen[piece]) continue;
    seen[piece] = true;
    const tetfmt::Index input = origins.empty() ? piece : origins[piece];
    const Material material = part.material_of(s, input);
    const auto& corners = triangles[piece].vertices;
    const bool sound =
        std::all_of(corners.begin(), corners.end(), [&](auto v) { return v < vertices.size(); });
    if (!material.emits() || !sound) continue;
    const Vec3 a = vec3(vertices[corners[0]]);
    scene.light_triangles.push_back({index, input, a + part.offset, vec3(vertices[corners[1]]) - a,
                                     vec3(vertices[corners[2]]) - a, material.emission, 0});
  }
}

/// Triangles are drawn by their power.
void share_out(Scene& scene) {
  double total = 0;
  for (const LightTriangle& light : scene.light_triangles) {
    total += brightest(light.emission) * length(cross(light.edge1, light.edge2)) / 2;
    scene.light_shares.push_back(total);
  }
  if (!(total > 0) || !std::isfinite(total)) {
    scene.light_triangles.clear();
    scene.light_shares.clear();
    return;
  }
  for (LightTriangle& light : scene.light_triangles) light.chance = brightest(light.emission) / total;
  for (double& share : scene.light_shares) share /= total;
}

}  // namespace

Material Part::material_of(tetfmt::Index side, tetfmt::Index triangle) const {
  const tetfmt::Index number = side < view().sides().size() ? view().sides()[side].material : 0;
  Material material = materials[number < materials.size() ? number : 0];
  if (object_changes.empty()) return material;
  const tetfmt::Index object =
      triangle < attributes.triangle_objects.size() ? attributes.triangle_objects[triangle] : 0;
  return object < object_changes.size() ? object_changes[object].applied_to(material) : material;
}

std::uint64_t Part::readable_bytes() const {
  using namespace tetfmt;
  std::uint64_t sum = sizeof(FileHeader) + view().sections().size_bytes();
  for (const SectionEntry& section : view().sections()) {
    const SectionKind kind = section.kind;
    const bool walked = kind == kSources || kind == kHullFaces || kind == kVertices || kind == kTets ||
                        kind == kSides || kind == kTriangles || kind == kRegions || kind == kOrigins ||
                        kind == kInputTriangles;
    const bool shaded = ((kind == kMaterials || kind == kTexts) && !attributes.materials.empty()) ||
                        (kind == kObjects && !attributes.objects.empty()) ||
                        (kind == kTriangleObjects && !attributes.triangle_objects.empty()) ||
                        (kind == kCorners && !attributes.corners.empty()) ||
                        (kind == kNormals && !attributes.normals.empty()) ||
                        (kind == kTexcoords && !attributes.texcoords.empty()) ||
                        (kind == kColors && !attributes.colors.empty());
    if (walked || shaded) sum += section.stored_bytes;
  }
  return sum;
}

std::uint64_t Scene::readable_bytes() const {
  std::uint64_t sum = 0;
  for (const auto& part : parts) sum += part->readable_bytes();
  return sum;
}

std::uint64_t Scene::file_bytes() const {
  std::uint64_t sum = 0;
  for (const auto& part : parts) sum += part->view().bytes().size();
  return sum;
}

std::vector<tetfmt::Location> locate_everywhere(const Scene& scene, Vec3 place, const std::string& what,
                                                const std::string& where) {
  std::vector<tetfmt::Location> result;
  for (const auto& part : scene.parts) {
    const tetfmt::Location location = tetfmt::locate(part->view(), rounded(part->local(place)));
    if (location.state == tetfmt::Location::State::corrupt)
      throw Failure(ExitCode::invalid, part->file.path() + ": " + what +
                                           " cannot be located in this file; run `tet validate` on it");
    if (location.state == tetfmt::Location::State::absent) {
      const Vec3 model = place + scene.origin;
      throw Failure(where.empty() ? ExitCode::usage : ExitCode::invalid,
                    (where.empty() ? "" : where + ": ") + what + " at " + number(model.x) + "," +
                        number(model.y) + "," + number(model.z) + " is in space that the file " +
                        part->file.path() + " leaves out; place it elsewhere" +
                        (where.empty() ? " with --eye" : "") +
                        " (`tet info` lists the regions that are there), or convert with --keep all");
    }
    result.push_back(location);
  }
  return result;
}

Scene open_scene(const SceneDescription& description, bool shaded) {
  Scene scene;
  Opener opener(scene);
  for (const FileEntry& entry : description.files) {
    scene.parts.push_back(std::make_unique<Part>(entry.path));
    Part& part = *scene.parts.back();
    const Vec3 origin = vec3(part.view().header().origin);
    if (scene.parts.size() == 1) scene.origin = origin;
    part.offset = origin + entry.translate - scene.origin;
    if (shaded) opener.materials(part, entry);
    if (shaded && part.view().find(tetfmt::kDracoSurface) != nullptr)
      scene.warnings.push_back(part.file.path() +
                               ": normals, colours and texture coordinates are Draco-coded, and not shown; "
                               "convert with --surface plain");
    drop_unused_attributes(part, shaded);
  }
  scene.up = unit(description.camera.up.value_or(Vec3{0, 1, 0}));
  scene.background = description.background;
  if (!shaded) return scene;

  scene.ambient = description.ambient;
  scene.light_samples = description.light_samples;
  scene.max_bounces = description.max_bounces;
  for (std::size_t i = 0; i < scene.parts.size(); ++i) {
    const Part& part = *scene.parts[i];
    for (const Material& m : part.materials) scene.has_glass |= m.finish == Finish::glass;
    for (const MaterialChange& c : part.object_changes) scene.has_glass |= c.finish == Finish::glass;
    add_light_triangles(scene, i);
  }
  share_out(scene);
  for (const PointLight& light : description.point_lights) {
    if (!(brightest(light.intensity) > 0)) continue;
    const Vec3 position = light.position - scene.origin;
    scene.point_lights.push_back(
        {position, light.intensity, locate_everywhere(scene, position, "the light", light.where)});
  }
  return scene;
}

}  // namespace tetprep
