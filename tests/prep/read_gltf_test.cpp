// SPDX-License-Identifier: AGPL-3.0-or-later
#include <draco/compression/encode.h>
#include <draco/mesh/triangle_soup_mesh_builder.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "prep/read_support.hpp"

namespace tetprep_test {
namespace {

using nlohmann::json;
using tetprep::ExitCode;

/// A glTF file in the making: one buffer, a view and an accessor for each list of numbers.
struct Gltf {
  json root = {{"asset", {{"version", "2.0"}}},
               {"accessors", json::array()},
               {"bufferViews", json::array()},
               {"meshes", json::array()},
               {"nodes", json::array()}};
  std::string data;

  template <class T>
  int view(const std::vector<T>& values) {
    while (data.size() % 4 != 0) data += '\0';
    const std::size_t offset = data.size();
    for (const T& value : values) data += raw(value);
    root["bufferViews"].push_back(
        {{"buffer", 0}, {"byteOffset", offset}, {"byteLength", data.size() - offset}});
    return static_cast<int>(root["bufferViews"].size()) - 1;
  }
  template <class T>
  int accessor(const std::vector<T>& values, const std::string& type, int component) {
    const std::size_t components = type == "SCALAR" ? 1 : static_cast<std::size_t>(type[3] - '0');
    root["accessors"].push_back({{"bufferView", view(values)},
                                 {"componentType", component},
                                 {"count", values.size() / components},
                                 {"type", type}});
    return static_cast<int>(root["accessors"].size()) - 1;
  }
  int floats(const std::vector<float>& values, const std::string& type) {
    return accessor(values, type, 5126);
  }
  int shorts(const std::vector<std::uint16_t>& values, const std::string& type = "SCALAR") {
    return accessor(values, type, 5123);
  }
  /// A node with a mesh of one primitive.
  void show(json primitive, json node = json::object()) {
    node["mesh"] = root["meshes"].size();
    root["meshes"].push_back({{"primitives", json::array({std::move(primitive)})}});
    root["nodes"].push_back(std::move(node));
  }

  std::string glb() const {
    json complete = root;
    complete["buffers"] = {{{"byteLength", data.size()}}};
    std::string text = complete.dump(), bin = data;
    while (text.size() % 4 != 0) text += ' ';
    while (bin.size() % 4 != 0) bin += '\0';
    const auto word = [](std::size_t value) { return raw(static_cast<std::uint32_t>(value)); };
    return "glTF" + word(2) + word(28 + text.size() + bin.size()) + word(text.size()) + "JSON" + text +
           word(bin.size()) + std::string("BIN\0", 4) + bin;
  }
  std::string gltf(const std::string& uri) const {
    json complete = root;
    complete["buffers"] = {{{"byteLength", data.size()}, {"uri", uri}}};
    return complete.dump(1);
  }
};

std::string base64(const std::string& bytes) {
  const char* digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    std::uint32_t bits = 0;
    for (std::size_t k = 0; k < 3; ++k)
      bits = bits << 8 | (i + k < bytes.size() ? static_cast<unsigned char>(bytes[i + k]) : 0u);
    for (std::size_t k = 0; k < 4; ++k)
      text += i + k <= bytes.size() ? digits[bits >> (18 - 6 * k) & 63] : '=';
  }
  return text;
}

const std::vector<float> kTriangle{0, 0, 0, 1, 0, 0, 0, 1, 0};

Gltf triangle(const json& node = json::object()) {
  Gltf file;
  const int position = file.floats(kTriangle, "VEC3"), indices = file.shorts({0, 1, 2});
  file.show({{"attributes", {{"POSITION", position}}}, {"indices", indices}}, node);
  return file;
}

TEST_F(Read, Gltf) {
  const Gltf file = triangle();
  write("a b.bin", file.data);
  std::filesystem::create_directory(path("sub"));
  write("sub/c.bin", file.data);
  for (const auto& [name, bytes] :
       {std::pair<std::string, std::string>{"a.glb", file.glb()},
        {"a.gltf", file.gltf("a%20b.bin")},
        {"b.gltf", file.gltf("./sub/../sub/c.bin")},
        {"c.gltf", file.gltf("data:application/octet-stream;base64," + base64(file.data))},
        {"d.gltf", "\xEF\xBB\xBF" + file.gltf("data:;base64," + base64(file.data))}}) {
    const auto soup = read_text(name, bytes);
    EXPECT_EQ(soup.points, kCorners) << name;
    EXPECT_EQ(soup.triangles, (Triangles{{0, 1, 2}})) << name;
    EXPECT_TRUE(soup.warnings.empty());
    ASSERT_EQ(soup.appearance.objects.size(), 1u);
    EXPECT_EQ(soup.appearance.objects[0].source, name);
  }
}

TEST_F(Read, GltfAttributes) {
  Gltf file;
  const int position = file.floats(kTriangle, "VEC3");
  const int normal = file.floats({0, 0, 1, 0, 0, 1, 0.6f, 0, 0.8f}, "VEC3");
  const int texcoord = file.shorts({0, 0, 65535, 0, 0, 13107}, "VEC2");
  file.root["accessors"].back()["normalized"] = true;
  const int color =
      file.accessor(std::vector<std::uint8_t>{255, 0, 51, 255, 0, 255, 0, 51, 0, 0, 0, 255}, "VEC4", 5121);
  file.root["accessors"].back()["normalized"] = true;
  const int paint = file.floats({1, 0, 0, 0, 1, 0, 0, 0, 0.5f}, "VEC3");
  file.show({{"attributes",
              {{"POSITION", position},
               {"NORMAL", normal},
               {"TEXCOORD_0", texcoord},
               {"COLOR_0", color},
               {"TANGENT", 9}}},
             {"material", 1}},
            {{"name", "first"}});
  file.root["meshes"][0]["primitives"][0]["attributes"].erase("TANGENT");
  file.show({{"attributes", {{"POSITION", position}, {"COLOR_0", paint}, {"TEXCOORD_1", texcoord}}}});
  file.root["meshes"][1]["name"] = "second";
  file.root["materials"] = {{{"name", "plain"}},
                            {{"name", "rich"},
                             {"alphaMode", "BLEND"},
                             {"emissiveFactor", {0.5, 0.25, 1}},
                             {"pbrMetallicRoughness",
                              {{"baseColorFactor", {0.1, 0.2, 0.3, 0.4}},
                               {"metallicFactor", 0.25},
                               {"roughnessFactor", 0.75},
                               {"baseColorTexture", {{"index", 0}}}}},
                             {"extensions",
                              {{"KHR_materials_emissive_strength", {{"emissiveStrength", 4}}},
                               {"KHR_materials_ior", {{"ior", 1.33}}},
                               {"KHR_materials_transmission", {{"transmissionFactor", 0.9}}}}}}};
  file.root["textures"] = {{{"source", 1}}};
  file.root["images"] = {{{"mimeType", "image/png"}, {"bufferView", 99}}, {{"uri", "wall%20paper.png"}}};
  const auto soup = read_text("a.glb", file.glb());
  const auto& a = soup.appearance;
  ASSERT_EQ(soup.triangles, (Triangles{{0, 1, 2}, {3, 4, 5}}));
  ASSERT_EQ(a.surface_points, 6u);
  EXPECT_EQ(a.normals[a.corners[0][2]], (std::array<float, 3>{0.6f, 0, 0.8f}));
  EXPECT_TRUE(std::isnan(a.normals[a.corners[1][0]][0]));
  EXPECT_EQ(a.texcoords[a.corners[0][1]], (std::array<float, 2>{1, 0}));
  EXPECT_EQ(a.texcoords[a.corners[0][2]], (std::array<float, 2>{0, 0.2f}));
  EXPECT_EQ(a.colors[a.corners[0][0]], (std::array<float, 4>{1, 0, 0.2f, 1}));
  EXPECT_EQ(a.colors[a.corners[0][1]], (std::array<float, 4>{0, 1, 0, 0.2f}));
  EXPECT_EQ(a.colors[a.corners[1][2]], (std::array<float, 4>{0, 0, 0.5f, 1}));
  ASSERT_EQ(a.objects.size(), 2u);
  EXPECT_EQ(a.objects[0].name, "first");
  EXPECT_EQ(a.objects[1].name, "second");
  EXPECT_EQ(a.triangle_object, (std::vector<Index>{0, 1}));
  EXPECT_EQ(a.triangle_material, (std::vector<Index>{1, 2}));
  ASSERT_EQ(a.materials.size(), 3u);
  EXPECT_EQ(a.materials[0].values.base_color, (std::array<float, 4>{1, 1, 1, 1}));
  EXPECT_EQ(a.materials[0].values.metallic, 1);
  const auto& rich = a.materials[1];
  EXPECT_EQ(rich.name, "rich");
  EXPECT_EQ(rich.values.base_color, (std::array<float, 4>{0.1f, 0.2f, 0.3f, 0.4f}));
  EXPECT_EQ(rich.values.emission, (std::array<float, 3>{2, 1, 4}));
  EXPECT_EQ(rich.values.metallic, 0.25f);
  EXPECT_EQ(rich.values.roughness, 0.75f);
  EXPECT_EQ(rich.values.ior, 1.33f);
  EXPECT_EQ(rich.values.transmission, 0.9f);
  EXPECT_EQ(rich.base_color_texture, "wall%20paper.png");
  EXPECT_EQ(a.materials[2].name, "");
  ASSERT_EQ(soup.warnings.size(), 2u);
  EXPECT_TRUE(mentions(soup.warnings[0], {"wall paper.png", "not there"}));
  EXPECT_TRUE(mentions(soup.warnings[1], {"meshes[1].primitives[0]", "TEXCOORD_1"}));
}

TEST_F(Read, GltfTransforms) {
  // Scaled by (2, 3, 4), turned a quarter about z, moved; below a parent that mirrors x.
  Gltf file;
  const int position = file.floats(kTriangle, "VEC3");
  const int normal = file.floats({0, 0, 1, 0.6f, 0.8f, 0, 0, 0, 1}, "VEC3");
  const double half = std::sqrt(0.5);
  file.show({{"attributes", {{"POSITION", position}, {"NORMAL", normal}}}},
            {{"scale", {2, 3, 4}}, {"rotation", {0, 0, half, half}}, {"translation", {10, 20, 30}}});
  file.root["nodes"].push_back(
      {{"matrix", {-1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1}}, {"children", {0}}});
  file.root["scenes"] = {{{"nodes", {0}}}, {{"nodes", {1}}}};
  file.root["scene"] = 1;
  const auto soup = read_text("a.glb", file.glb());
  const Points expected{{-10, 20, 30}, {-10, 22, 30}, {-7, 20, 30}};
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t k = 0; k < 3; ++k) EXPECT_NEAR(soup.points[i][k], expected[i][k], 1e-14);
  EXPECT_EQ(soup.triangles, (Triangles{{0, 2, 1}}));  // mirrored: what was in front stays in front
  const auto& a = soup.appearance;
  EXPECT_NEAR(a.normals[a.corners[0][0]][2], 1, 1e-7);
  // (0.6/2, 0.8/3, 0) turned and mirrored is (0.8/3, 0.6/2, 0), of unit length.
  const auto& slant = a.normals[a.corners[0][2]];
  const double x = 0.8 / 3, y = 0.3, length = std::hypot(x, y);
  EXPECT_NEAR(slant[0], x / length, 1e-6);
  EXPECT_NEAR(slant[1], y / length, 1e-6);
  EXPECT_NEAR(slant[2], 0, 1e-6);
  // Far away in double precision.
  Gltf far = triangle({{"translation", {1e8, 0, 0.1}}});
  EXPECT_EQ(read_text("far.glb", far.glb()).points[1], (std::array<double, 3>{100000001, 0, 0.1}));
}

TEST_F(Read, GltfModes) {
  Gltf file;
  const int position = file.floats({0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0, 0, 2, 0}, "VEC3");
  const json attributes = {{"POSITION", position}};
  file.show({{"attributes", attributes}, {"mode", 5}});
  file.show({{"attributes", attributes}, {"mode", 6}, {"indices", file.shorts({0, 1, 3, 2})}});
  file.show({{"attributes", attributes}, {"mode", 1}});
  file.show({{"attributes", json::object()}});
  file.show({{"attributes", attributes},
             {"indices", file.accessor(std::vector<std::uint8_t>{4, 2, 3}, "SCALAR", 5121)}});
  file.show({{"attributes", attributes},
             {"indices", file.accessor(std::vector<std::uint32_t>{1, 3, 2}, "SCALAR", 5125)}});
  const auto soup = read_text("a.glb", file.glb());
  ASSERT_EQ(soup.triangles.size(), 7u);
  EXPECT_EQ(Triangles(soup.triangles.begin(), soup.triangles.begin() + 3),
            (Triangles{{0, 1, 2}, {1, 3, 2}, {2, 3, 4}}));
  EXPECT_EQ(Triangles(soup.triangles.begin() + 3, soup.triangles.begin() + 5),
            (Triangles{{6, 8, 5}, {8, 7, 5}}));
  EXPECT_EQ(soup.points[soup.triangles[5][0]], (std::array<double, 3>{0, 2, 0}));
  EXPECT_EQ(soup.points.size(), 5u + 4 + 3 + 3);  // those that a primitive uses
  EXPECT_EQ(soup.appearance.objects.size(), 4u);
  ASSERT_EQ(soup.warnings.size(), 2u);
  EXPECT_TRUE(mentions(soup.warnings[0], {"meshes[2].primitives[0]", "points or lines"}));
}

TEST_F(Read, GltfAccessors) {
  Gltf file;
  // Interleaved: position and something else, 16 bytes each; sparse replaces the second.
  const int strided = file.view<float>({9, 9, 9, 9, 0, 0, 0, 9, 5, 5, 5, 9, 0, 1, 0, 9});
  file.root["bufferViews"][0]["byteStride"] = 16;
  file.root["accessors"].push_back(
      {{"bufferView", strided},
       {"byteOffset", 16},
       {"componentType", 5126},
       {"count", 3},
       {"type", "VEC3"},
       {"sparse",
        {{"count", 1},
         {"indices", {{"bufferView", file.view<std::uint8_t>({1})}, {"componentType", 5121}}},
         {"values", {{"bufferView", file.view<float>({1, 0, 0})}}}}}});
  file.show({{"attributes", {{"POSITION", 0}}}});
  // All sparse, without a view; whole numbers instead of floats (KHR_mesh_quantization).
  const int indices = file.view<std::uint16_t>({1, 2});
  file.root["accessors"].push_back(
      {{"componentType", 5122},
       {"count", 3.0},
       {"type", "VEC3"},
       {"normalized", false},
       {"sparse",
        {{"count", 2},
         {"indices", {{"bufferView", indices}, {"componentType", 5123}}},
         {"values", {{"bufferView", file.view<std::int16_t>({-7, 0, 0, 0, 300, 0})}}}}}});
  file.root["extensionsRequired"] = {"KHR_mesh_quantization"};
  file.show({{"attributes", {{"POSITION", 1}}}});
  const auto soup = read_text("a.glb", file.glb());
  EXPECT_EQ(soup.points, (Points{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 0}, {-7, 0, 0}, {0, 300, 0}}));
}

/// Triangles 0 1 2 and 2 1 3 of a unit square by Draco, without loss; attribute 0: position, 1: colour.
std::string draco_square() {
  draco::TriangleSoupMeshBuilder builder;
  builder.Start(2);
  const int position = builder.AddAttribute(draco::GeometryAttribute::POSITION, 3, draco::DT_FLOAT32);
  const int color = builder.AddAttribute(draco::GeometryAttribute::COLOR, 3, draco::DT_UINT8);
  const float points[4][3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}};
  const std::uint8_t paints[4][3] = {{255, 0, 0}, {0, 255, 0}, {0, 0, 255}, {51, 51, 51}};
  const int faces[2][3] = {{0, 1, 2}, {2, 1, 3}};
  for (std::uint32_t f = 0; f < 2; ++f) {
    const auto& [a, b, c] = faces[f];
    builder.SetAttributeValuesForFace(position, draco::FaceIndex(f), points[a], points[b], points[c]);
    builder.SetAttributeValuesForFace(color, draco::FaceIndex(f), paints[a], paints[b], paints[c]);
  }
  const auto mesh = builder.Finalize();
  draco::Encoder encoder;
  encoder.SetEncodingMethod(draco::MESH_SEQUENTIAL_ENCODING);
  draco::EncoderBuffer buffer;
  EXPECT_TRUE(encoder.EncodeMeshToBuffer(*mesh, &buffer).ok());
  return {buffer.data(), buffer.size()};
}

TEST_F(Read, GltfDraco) {
  Gltf file;
  const std::string compressed = draco_square();
  const int view = file.view(std::vector<char>(compressed.begin(), compressed.end()));
  file.root["extensionsUsed"] = file.root["extensionsRequired"] = {"KHR_draco_mesh_compression"};
  file.root["accessors"] = {{{"componentType", 5126}, {"count", 4}, {"type", "VEC3"}},
                            {{"componentType", 5121}, {"count", 4}, {"type", "VEC3"}, {"normalized", true}},
                            {{"componentType", 5125}, {"count", 6}, {"type", "SCALAR"}}};
  file.show({{"attributes", {{"POSITION", 0}, {"COLOR_0", 1}}},
             {"indices", 2},
             {"extensions",
              {{"KHR_draco_mesh_compression",
                {{"bufferView", view}, {"attributes", {{"POSITION", 0}, {"COLOR_0", 1}}}}}}}},
            {{"scale", {2, 2, 2}}});
  const auto soup = read_text("a.glb", file.glb());
  ASSERT_EQ(soup.triangles.size(), 2u);
  const Points expected{{0, 0, 0}, {2, 0, 0}, {0, 2, 0}, {0, 2, 0}, {2, 0, 0}, {2, 2, 0}};
  const std::vector<std::array<float, 4>> paints{{1, 0, 0, 1}, {0, 1, 0, 1}, {0, 0, 1, 1},
                                                 {0, 0, 1, 1}, {0, 1, 0, 1}, {0.2f, 0.2f, 0.2f, 1}};
  for (std::size_t i = 0; i < 6; ++i) {
    EXPECT_EQ(soup.points[soup.triangles[i / 3][i % 3]], expected[i]);
    EXPECT_EQ(soup.appearance.colors[soup.appearance.corners[i / 3][i % 3]], paints[i]);
  }
  const std::string extension = "/meshes/0/primitives/0/extensions/KHR_draco_mesh_compression";
  const auto with = [&](const std::string& pointer, const json& value) {
    Gltf copy = file;
    copy.root[json::json_pointer(extension + pointer)] = value;
    return copy.glb();
  };
  refuse("a.glb", with("/bufferView", 3), {"KHR_draco_mesh_compression.bufferView", "3"});
  refuse("a.glb", with("/attributes/POSITION", 9), {"primitives[0]", "no attribute 9"});
  refuse("a.glb", with("/attributes/POSITION", "x"), {"POSITION", "\"x\""});
  refuse("a.glb", with("/attributes", {{"POSITION", 0}}), {"primitives[0]", "COLOR_0"});
  Gltf damaged = file;
  damaged.data[0] = 'X';
  refuse("a.glb", damaged.glb(), {"primitives[0]", "Draco"});
  expect_soundness(path("a.glb"), file.glb());
}

TEST_F(Read, GltfScenes) {
  Gltf file = triangle({{"name", "a"}});
  file.root["nodes"].push_back({{"mesh", 0}, {"name", "b"}, {"translation", {5, 0, 0}}});
  file.root["nodes"].push_back({{"children", {1}}});
  EXPECT_EQ(read_text("a.glb", file.glb()).triangles.size(), 2u);  // no scene: all nodes
  file.root["scenes"] = {{{"nodes", {0}}}, {{"nodes", {2, 0}}}};
  EXPECT_EQ(read_text("a.glb", file.glb()).triangles.size(), 2u);  // no default: all scenes
  file.root["scene"] = 0;
  EXPECT_EQ(read_text("a.glb", file.glb()).triangles.size(), 1u);
  // Nested as deep as a file likes.
  Gltf deep = triangle();
  const int depth = 100000;
  for (int i = 0; i < depth; ++i)
    deep.root["nodes"].push_back({{"children", {i}}, {"translation", {1, 0, 0}}});
  deep.root["scenes"] = {{{"nodes", {depth}}}};
  EXPECT_EQ(read_text("deep.glb", deep.glb()).points[0], (std::array<double, 3>{depth, 0, 0}));
}

/// The file with one value of its JSON changed.
std::string changed(const Gltf& file, const std::string& pointer, const json& value) {
  Gltf copy = file;
  copy.root[json::json_pointer(pointer)] = value;
  return copy.glb();
}

TEST_F(Read, BadGltf) {
  const Gltf good = triangle();
  const auto bad = [&](const std::string& pointer, const json& value, std::vector<std::string> parts) {
    refuse("a.glb", changed(good, pointer, value), std::move(parts));
  };
  // accessors[0]: positions, 36 bytes; accessors[1]: indices, 6 bytes from 36 on.
  bad("/accessors/0/count", 4, {"accessors[0]", "bufferViews[0]", "36 bytes"});
  bad("/accessors/0/count", 9007199254740991, {"accessors[0]", "36 bytes"});
  bad("/accessors/0/count", 1e300, {"accessors[0].count", "out of range"});
  bad("/accessors/0/count", -3, {"accessors[0].count", "-3"});
  bad("/accessors/0/count", "3", {"accessors[0].count", "\"3\""});
  bad("/accessors/0/byteOffset", 4, {"accessors[0]", "36 bytes"});
  bad("/accessors/0/byteOffset", 9007199254740991, {"accessors[0]"});
  bad("/accessors/0/byteOffset", -4, {"accessors[0].byteOffset", "-4"});
  bad("/accessors/0/bufferView", 7, {"accessors[0].bufferView", "7", "only 2"});
  bad("/accessors/0/componentType", 5124, {"accessors[0].componentType", "5124"});
  bad("/accessors/0/type", "VEC9", {"accessors[0].type", "VEC9"});
  bad("/accessors/0/type", "VEC2", {"POSITION", "2 components"});
  bad("/accessors/1/type", "MAT4", {"accessors[1]"});
  bad("/accessors/1/componentType", 5126, {"accessors[1]"});
  bad("/accessors/1/count", 2, {"primitives[0]", "multiple of 3"});
  bad("/bufferViews/0/byteLength", 400, {"bufferViews[0].byteLength", "400"});
  bad("/bufferViews/0/byteOffset", 9007199254740991, {"bufferViews[0]"});
  bad("/bufferViews/0/buffer", 1, {"bufferViews[0].buffer", "only 1 buffers"});
  bad("/bufferViews/0/byteStride", 8, {"accessors[0]", "12 bytes"});
  bad("/bufferViews/0/byteStride", 6, {"byteStride", "6"});
  bad("/meshes/0/primitives/0/indices", 2, {"meshes[0].primitives[0].indices", "only 2"});
  bad("/meshes/0/primitives/0/material", 0, {"primitives[0].material", "only 0"});
  bad("/meshes/0/primitives/0/mode", 7, {"mode", "7"});
  bad("/meshes/0/primitives/0/attributes/POSITION", 5, {"POSITION", "5"});
  bad("/meshes/0/primitives/0/attributes/NORMAL", 1, {"NORMAL"});
  bad("/meshes/0/primitives", 3, {"meshes[0].primitives"});
  bad("/nodes/0/mesh", 1, {"nodes[0].mesh", "only 1"});
  bad("/nodes/0/children", {0}, {"cycle"});
  bad("/nodes/0/children", {7}, {"nodes[0].children", "7"});
  bad("/nodes/0/matrix", {1, 2}, {"nodes[0].matrix", "16"});
  bad("/nodes/0/matrix", {1, 0, 0, 1, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1}, {"nodes[0].matrix", "affine"});
  bad("/nodes/0/rotation", {0, 0, 0, 0}, {"nodes[0].rotation"});
  bad("/nodes/0/scale", {1, "x", 1}, {"nodes[0].scale"});
  bad("/nodes/0", 1, {"nodes[0]"});
  bad("/scenes", json::parse(R"([{"nodes": [3]}])"), {"scenes[0].nodes", "3"});
  bad("/scene", 0, {"scene", "only 0"});
  bad("/textures", json::parse(R"([{"source": 0}])"), {"textures[0].source"});
  bad("/materials", json::parse(R"([{"pbrMetallicRoughness": {"baseColorTexture": {"index": 2}}}])"),
      {"materials[0]"});
  bad("/materials", json::parse(R"([{"emissiveFactor": [1, 2]}])"), {"materials[0].emissiveFactor"});
  bad("/meshes", json::array(), {"nodes[0].mesh"});
  bad("/asset", json::object(), {"asset.version"});
  bad("/nodes", json::array(), {"no surface"});

  Gltf lines = good;
  lines.root["meshes"][0]["primitives"][0]["mode"] = 1;
  refuse("a.glb", lines.glb(), {"no triangles", "no surface"});
  const auto unsupported = [&](const std::string& pointer, const json& value,
                               std::vector<std::string> parts) {
    refuse("a.glb", changed(good, pointer, value), std::move(parts), ExitCode::unsupported);
  };
  unsupported("/extensionsRequired", {"EXT_meshopt_compression"}, {"EXT_meshopt_compression"});
  unsupported("/asset/version", "1.0", {"1.0"});
  unsupported("/asset/minVersion", "2.1", {"2.1"});
}

TEST_F(Read, BadGltfData) {
  Gltf file;
  const int position = file.floats({0, 0, 0, 1, 0, 0, 0, NAN, 0}, "VEC3");
  file.show({{"attributes", {{"POSITION", position}}}});
  refuse("a.glb", file.glb(), {"element 2", "POSITION (accessors[0])", "not finite"});

  Gltf indexed;
  const json attributes = {{"POSITION", indexed.floats(kTriangle, "VEC3")}};
  indexed.show({{"attributes", attributes}, {"indices", indexed.shorts({0, 1, 3})}});
  refuse("a.glb", indexed.glb(), {"primitives[0]", "element 2", "accessors[1]", "is 3", "only 3"});

  Gltf uneven = triangle();
  uneven.root["meshes"][0]["primitives"][0]["attributes"]["NORMAL"] =
      uneven.floats({0, 0, 1, 0, 0, 1}, "VEC3");
  refuse("a.glb", uneven.glb(), {"NORMAL (accessors[2])", "2 elements", "3 positions"});

  Gltf soft = triangle();
  soft.root["meshes"][0]["primitives"][0]["attributes"]["NORMAL"] =
      soft.floats({0, 0, 1, NAN, 0, 1, INFINITY, 0, 0}, "VEC3");
  const auto soup = read_text("a.glb", soft.glb());
  EXPECT_EQ(soup.appearance.surface_points, 1u);
  EXPECT_EQ(soup.appearance.corners, (Triangles{{0, tetprep::kNone, tetprep::kNone}}));
  ASSERT_EQ(soup.warnings.size(), 1u);
  EXPECT_TRUE(mentions(soup.warnings[0], {"2 elements", "NORMAL"}));

  Gltf sparse = triangle();
  const int number = sparse.view<std::uint16_t>({3}), value = sparse.view<float>({1, 2, 3});
  sparse.root["accessors"][0]["sparse"] = {{"count", 1},
                                           {"indices", {{"bufferView", number}, {"componentType", 5123}}},
                                           {"values", {{"bufferView", value}}}};
  refuse("a.glb", sparse.glb(), {"accessors[0]", "element 3 of 3"});
  refuse("a.glb", changed(sparse, "/accessors/0/sparse/count", 2), {"accessors[0]", "sparse"});
  refuse("a.glb", changed(sparse, "/accessors/0/sparse/values/bufferView", 9), {"sparse.values.bufferView"});
  refuse("a.glb", changed(sparse, "/accessors/0/sparse/indices/componentType", 5126), {"whole"});
}

TEST_F(Read, GltfBuffers) {
  const Gltf file = triangle();
  refuse("a.gltf", file.gltf("missing.bin"), {"missing.bin"}, ExitCode::io);
  write("short.bin", file.data.substr(1));
  refuse("a.gltf", file.gltf("short.bin"), {"buffers[0].byteLength", "only 41"});
  for (const char* uri : {"../x.bin", "/etc/passwd", "sub/../../x.bin", "%2e%2e/x.bin", "http://x/y.bin",
                          "c:\\x.bin", "..\\x.bin", "file:///etc/passwd"})
    refuse("a.gltf", file.gltf(uri), {"outside"});
  refuse("a.gltf", file.gltf(""), {"buffers[0].uri"});
  refuse("a.gltf", file.gltf("data:application/octet-stream;base64,AAAA"),
         {"buffers[0].byteLength", "only 3"});
  refuse("a.gltf", file.gltf("data:application/octet-stream;base64,AA*A"), {"buffers[0].uri", "base64"});
  refuse("a.gltf", file.gltf("data:text/plain,hello"), {"buffers[0].uri", "base64"});
  refuse("a.gltf", "{", {"JSON"});
  refuse("a.gltf", "[]", {"JSON"});
  refuse("a.gltf", "hello", {"JSON"});
  refuse("a.gltf", "{\"asset\":{\"version\":\"2.0\"},\"extras\":" + std::string(1000000, '['), {"JSON"});
  // Nested deeper than any stack, and sound.
  const std::string deep = std::string(1000000, '[') + std::string(1000000, ']');
  const std::string text = file.gltf("data:;base64," + base64(file.data));
  EXPECT_EQ(read_text("a.gltf", "{\"extras\":" + deep + "," + text.substr(1)).points, kCorners);

  const std::string good = file.glb();
  std::string old = good;
  old[4] = 1;
  refuse("a.glb", old, {"version 1"}, ExitCode::unsupported);
  refuse("a.glb", good.substr(0, 19), {"cut short"});
  refuse("a.glb", good.substr(0, good.size() - 1), {"cut short"});
  EXPECT_EQ(read_text("a.glb", good + "trailing").points, kCorners);
}

TEST_F(Read, GltfMayShowOneMeshManyTimes) {
  // A few bytes that ask for 4 * 10^8 triangles must end in an error, and soon.
  Gltf file;
  std::vector<std::uint16_t> indices(3 * 20000, 0);
  const int position = file.floats(kTriangle, "VEC3"), number = file.shorts(indices);
  const json primitive = {{"attributes", {{"POSITION", position}}}, {"indices", number}};
  file.show(primitive);
  for (int i = 0; i < 20000; ++i) file.root["nodes"].push_back({{"mesh", 0}});
  refuse("a.glb", file.glb(), {"2^26 triangles"}, ExitCode::unsupported);
  Gltf shared;
  const json same = {{"attributes", {{"POSITION", shared.floats(kTriangle, "VEC3")}}},
                     {"indices", shared.shorts(indices)}};
  shared.show(same);
  for (int i = 0; i < 20000; ++i) shared.root["meshes"][0]["primitives"].push_back(same);
  refuse("a.glb", shared.glb(), {"2^26 triangles"}, ExitCode::unsupported);
}

TEST_F(Read, DamagedGltf) {
  Gltf file = triangle({{"name", "n"}, {"rotation", {0, 0, 0, 1}}});
  auto& attributes = file.root["meshes"][0]["primitives"][0]["attributes"];
  attributes["NORMAL"] = file.floats({0, 0, 1, 0, 0, 1, 0, 0, 1}, "VEC3");
  attributes["COLOR_0"] = file.shorts({0, 0, 0, 1, 1, 1, 2, 2, 2}, "VEC3");
  file.root["scenes"] = {{{"nodes", {0}}}};
  expect_soundness(path("a.glb"), file.glb());
}

}  // namespace
}  // namespace tetprep_test
