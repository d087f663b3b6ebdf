// SPDX-License-Identifier: AGPL-3.0-or-later
// A scene, open and ready to be traced: tet files side by side, what they are made of, and their light.
//
// Every tet file is a box of tetrahedra of its own, with coordinates of its own. So a ray has as many walks
// as there are files whose box it meets, and the nearest of their hits counts. That is exact within a file.
// From one file to another a place is rounded to the float32 of the other's coordinates: surfaces of
// different files that touch or cut each other may let rays through, or block them, within that rounding.
// What touches belongs into one file: `tet convert` joins several meshes.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "common/tet_file.hpp"
#include "tetfmt/attributes.hpp"
#include "tetfmt/traverse.hpp"
#include "trace/camera.hpp"
#include "trace/scene_file.hpp"

namespace tetprep {

/// A tet file in a scene. World coordinates are the local ones of the first file, if it is not translated.
struct Part {
  explicit Part(const std::string& path) : file(path), attributes(file.view()) {}

  TetFile file;
  Vec3 offset;                           ///< world = local + offset
  tetfmt::SurfaceAttributes attributes;  ///< with empty spans for what this scene does not need
  std::vector<Material> materials;       ///< of each material of the file, as the scene has it
  /// Of each object of the file, what the scene says; empty if it says nothing of any.
  std::vector<MaterialChange> object_changes;

  const tetfmt::FileView& view() const { return file.view(); }
  Vec3 local(Vec3 world) const { return world - offset; }
  /// The material of a side, as the scene has it. Any indices are safe.
  Material material_of(tetfmt::Index side, tetfmt::Index triangle) const;
  /// Bytes that tracing may read: what the walk needs, and the attributes above. Nothing else is touched.
  std::uint64_t readable_bytes() const;
};

/// A triangle that sends out light, world coordinates.
struct LightTriangle {
  std::size_t part = 0;
  tetfmt::Index triangle = 0;  ///< of the input, as hits have it
  Vec3 corner, edge1, edge2;
  Rgb emission;
  double chance = 0;  ///< of being drawn, per unit of area
};

struct LocatedLight {
  Vec3 position;  ///< world
  Rgb intensity;
  std::vector<tetfmt::Location> locations;  ///< in each part
};

struct Scene {
  std::vector<std::unique_ptr<Part>> parts;
  Vec3 origin;  ///< model = world + origin
  Vec3 up{0, 1, 0};
  std::vector<LocatedLight> point_lights;
  std::vector<LightTriangle> light_triangles;
  std::vector<double> light_shares;  ///< of their power, added up: the last is 1
  Background background;
  std::optional<AmbientOcclusion> ambient;
  int light_samples = 1, max_bounces = 12;
  /// Else nothing of refraction is computed. A switch at run time: an integrator compiled without glass made
  /// no ray of an opaque scene measurably faster (834 and 858 ns, the fastest of six runs each).
  bool has_glass = false;
  std::vector<std::unique_ptr<Texture>> textures;
  std::vector<std::string> texture_files;  ///< that they were read from
  std::vector<std::string> warnings;

  bool lit() const { return !point_lights.empty() || !light_triangles.empty() || ambient; }
  std::uint64_t readable_bytes() const;
  std::uint64_t file_bytes() const;
};

/// Opens what the description names. `shaded`: whether pictures show materials and light; else nothing but
/// the files is opened and located. Throws Failure with the path and the reason. O(lights * walk), and
/// O(sides) if a material sends out light.
Scene open_scene(const SceneDescription& description, bool shaded);

/// `place` (world) in every part. Throws Failure if it is in space that a file leaves out (invalid; usage if
/// `where` is empty), and if a file is none (invalid). `what` is "the camera" or "the light", `where` its
/// place in the scene file; empty: the command line's, or nobody's.
std::vector<tetfmt::Location> locate_everywhere(const Scene& scene, Vec3 place, const std::string& what,
                                                const std::string& where);

}  // namespace tetprep
