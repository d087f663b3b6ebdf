// SPDX-License-Identifier: AGPL-3.0-or-later
// A scene as its file tells it, before any tet file is opened. spec/scene.schema.json describes the format.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "trace/camera.hpp"
#include "trace/material.hpp"

namespace tetprep {

/// What the scene says of one material or object of a tet file.
struct NamedChange {
  std::string name;
  MaterialChange change;
  std::string where;  ///< in the scene file, for messages
};

struct FileEntry {
  std::string path;  ///< as it can be opened: relative paths start at the scene file's folder
  Vec3 translate;    ///< where the file's origin comes to lie, in model units
  MaterialChange change;
  std::vector<NamedChange> materials, objects;  ///< go on top of `change`, objects above materials
};

struct PointLight {
  Vec3 position;        ///< model coordinates
  Rgb intensity;        ///< a surface at distance d that faces it receives intensity / d^2
  std::string where{};  ///< in the scene file, for messages
};

/// What rays see that leave the scene: a colour straight below, one straight above, blended by height.
struct Background {
  Rgb bottom, top;
};

/// Light of the background on diffuse surfaces: from every direction in which nothing is near.
struct AmbientOcclusion {
  double distance = 0;  ///< what is farther away blocks nothing; may be infinite
  int samples = 1;      ///< rays a hit
};

struct SceneDescription {
  std::vector<FileEntry> files;
  CameraWish camera;
  std::vector<PointLight> point_lights;
  Background background;
  std::optional<AmbientOcclusion> ambient;
  int light_samples = 1;  ///< rays to mesh lights a hit
  int max_bounces = 12;   ///< reflections and refractions along a path
  std::optional<int> samples;
  std::optional<std::array<int, 2>> size;
};

/// Bounds that the command's options share.
inline constexpr int kMaxSamples = 1024, kMaxEdge = 32768;
inline constexpr std::int64_t kMaxPixels = std::int64_t{1} << 28;

/// The default background: light grey, a little lighter at the top.
Background default_background();

/// The scene of nothing but one tet file.
SceneDescription scene_of(const std::string& tet_file);

/// Throws Failure (io, invalid): file, place in it, what is expected, what was found.
SceneDescription read_scene_file(const std::string& path);

}  // namespace tetprep
