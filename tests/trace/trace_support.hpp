// SPDX-License-Identifier: AGPL-3.0-or-later
// Small scenes, and the light along single rays of them.
#pragma once

#include <gtest/gtest.h>
#include <stdlib.h>

#include <cstring>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "support/lattice_mesh.hpp"
#include "tetfmt/encode.hpp"
#include "trace/integrate.hpp"
#include "trace/render.hpp"

namespace tetfmt_test {

using tetprep::Rgb;
using tetprep::Vec3;

/// Each test runs in an empty folder of its own, removed at the end.
class TraceTest : public ::testing::Test {
 protected:
  void SetUp() override {
    std::string name = (std::filesystem::temp_directory_path() / "trace-test-XXXXXX").string();
    ASSERT_NE(mkdtemp(name.data()), nullptr);
    folder_ = name;
    before_ = std::filesystem::current_path();
    std::filesystem::current_path(folder_);
  }
  void TearDown() override {
    std::filesystem::current_path(before_);
    std::filesystem::remove_all(folder_);
  }
  static void write(const std::string& name, const std::string& text) {
    std::ofstream(name, std::ios::binary) << text;
  }
  static void write(const std::string& name, const tetfmt::Mesh& mesh) {
    const auto bytes = tetfmt::encode(mesh, tetfmt::Layout::tet20);
    write(name, std::string(reinterpret_cast<const char*>(bytes.data()), bytes.size()));
  }

 private:
  std::filesystem::path folder_, before_;
};

/// A lattice of 6 x 6 x 6 with these walls of the box [2, 4]^3; bit 5 is z = 4, its front towards +z.
inline tetfmt::Mesh walls_mesh(unsigned walls, float step = 1) {
  LatticeOptions options;
  options.low = 2;
  options.walls = walls;
  options.step = step;
  return lattice_mesh(6, options);
}
inline constexpr unsigned kBox = 63, kTop = 1u << 5;

template <class T>
tetfmt::OptionalSection section_of(tetfmt::SectionKind kind, const std::vector<T>& elements) {
  tetfmt::OptionalSection section{kind, sizeof(T), {}};
  section.bytes.resize(elements.size() * sizeof(T));
  std::memcpy(section.bytes.data(), elements.data(), section.bytes.size());
  return section;
}

inline tetprep::FileEntry entry(const std::string& path, const tetprep::MaterialChange& change = {},
                                Vec3 translate = {}) {
  return {path, translate, change, {}, {}};
}

inline tetprep::SceneDescription description_of(std::vector<tetprep::FileEntry> files) {
  tetprep::SceneDescription description;
  description.files = std::move(files);
  return description;
}

/// An open scene, and rays into it.
struct OpenScene {
  tetprep::Scene scene;
  tetprep::Camera camera;
  tetprep::Rays rays;

  explicit OpenScene(const tetprep::SceneDescription& description)
      : scene(tetprep::open_scene(description, true)), rays(scene, tetprep::Walks::together) {
    camera.forward = {0, 0, -1};
    camera.right = {1, 0, 0};
    camera.up = {0, 1, 0};
  }
  /// The mean of `samples` samples.
  Rgb light(Vec3 eye, Vec3 direction, std::size_t samples = 1) {
    const auto located = tetprep::locate_everywhere(scene, eye, "the eye", "");
    const std::vector<tetfmt::Vec3f> directions(samples, tetprep::rounded(direction));
    std::vector<tetprep::SceneHit> hits(samples);
    rays.first_hits(located, directions, hits);
    std::vector<tetprep::Sample> seen;
    for (std::size_t s = 0; s < samples; ++s)
      seen.push_back({directions[s], hits[s], tetprep::Dice(7, s), {}});
    tetprep::Integrator(scene, camera, rays).add_light(seen);
    Rgb sum;
    for (const tetprep::Sample& sample : seen) sum = sum + sample.light;
    return (1.0 / static_cast<double>(samples)) * sum;
  }
  std::uint64_t count(tetprep::RayKind kind) const {
    return rays.counts().rays[static_cast<std::size_t>(kind)];
  }
};

inline constexpr double kPi = 3.141592653589793;

}  // namespace tetfmt_test
