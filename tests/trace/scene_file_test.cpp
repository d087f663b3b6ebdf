// SPDX-License-Identifier: AGPL-3.0-or-later
// Scene files: what they say, every kind of mistake, and the published schema.
#include "trace/scene_file.hpp"

#include "common/failure.hpp"
#include "support/schema_checker.hpp"
#include "trace/json_reader.hpp"
#include "trace/trace_support.hpp"

namespace tetfmt_test {
namespace {

using namespace tetprep;
using Json = nlohmann::json;

std::vector<std::string> schema_errors(const std::string& text) {
  SchemaChecker checker(Json::parse(std::ifstream(SCENE_SCHEMA)));
  return checker.errors(Json::parse(text));
}

/// The message that reading this text ends with; empty if it can be read.
std::string complaint(const std::string& text, ExitCode code = ExitCode::invalid) {
  std::ofstream("scene.json", std::ios::binary) << text;
  try {
    read_scene_file("scene.json");
  } catch (const Failure& failure) {
    EXPECT_EQ(failure.code(), code) << failure.what();
    const std::string what = failure.what();
    EXPECT_EQ(what.find('\n'), std::string::npos) << what;
    EXPECT_EQ(what.rfind("scene.json: ", 0), 0u) << what;
    return what;
  }
  return {};
}

TEST_F(TraceTest, SceneFilesSayEverything) {
  std::filesystem::create_directory("scenes");
  const std::string text = R"({
    "$schema": "scene.schema.json", "description": "all keys",
    "files": ["a.tet", {"path": "sub/b.tet", "translate": [1, 2, 3],
      "material": {"type": "mirror", "color": 0.5},
      "materials": {"lamp": {"emission": [1, 2, 3], "smooth": false}},
      "objects": {"ball": {"type": "glass", "ior": 1.3, "absorption": [0, 1, 2], "texture": "t.png",
                           "texture_origin": "top", "vertex_colors": "linear", "color": "#ff8000"},
                  "cube": {"texture": null}}}],
    "camera": {"eye": [1, 2, 3], "look_at": [4, 5, 6], "up": [0, 0, 1], "fov": 40, "azimuth": 10, "elevation": -5},
    "point_lights": [{"position": [0, 1, 0], "intensity": 5}],
    "background": {"bottom": 0.25, "top": [1, 2, 3]},
    "ambient_occlusion": {"distance": 2.5, "samples": 3},
    "light_samples": 2, "max_bounces": 5, "samples": 16, "size": [320, 200]
  })";
  write("scenes/all.json", text);
  EXPECT_EQ(schema_errors(text), std::vector<std::string>{});
  const SceneDescription scene = read_scene_file("scenes/all.json");
  ASSERT_EQ(scene.files.size(), 2u);
  EXPECT_EQ(scene.files[0].path, "scenes/a.tet");
  EXPECT_EQ(scene.files[1].path, "scenes/sub/b.tet");
  EXPECT_EQ(scene.files[1].translate.z, 3);
  EXPECT_EQ(scene.files[1].change.finish, Finish::mirror);
  EXPECT_EQ(scene.files[1].change.color->g, 0.5);
  EXPECT_FALSE(scene.files[1].change.emission);
  EXPECT_EQ(scene.files[1].materials.at(0).name, "lamp");
  EXPECT_EQ(scene.files[1].materials.at(0).change.emission->b, 3);
  EXPECT_EQ(scene.files[1].materials.at(0).change.smooth, false);
  const MaterialChange& ball = scene.files[1].objects.at(0).change;
  EXPECT_EQ(ball.finish, Finish::glass);
  EXPECT_EQ(ball.ior, 1.3);
  EXPECT_EQ(ball.absorption->b, 2);
  EXPECT_EQ(ball.texture, "scenes/t.png");
  EXPECT_EQ(ball.texture_origin, TextureOrigin::top);
  EXPECT_EQ(ball.vertex_colors, VertexColors::linear);
  EXPECT_NEAR(ball.color->g, srgb_decode(128.0 / 255), 1e-15);
  EXPECT_EQ(scene.files[1].objects.at(1).change.texture, "");
  EXPECT_EQ(scene.camera.eye->y, 2);
  EXPECT_EQ(scene.camera.look_at->z, 6);
  EXPECT_EQ(scene.camera.up->z, 1);
  EXPECT_EQ(scene.camera.fov, 40);
  EXPECT_EQ(scene.camera.azimuth, 10);
  EXPECT_EQ(scene.camera.elevation, -5);
  EXPECT_EQ(scene.point_lights.at(0).position.y, 1);
  EXPECT_EQ(scene.point_lights.at(0).intensity.b, 5);
  EXPECT_EQ(scene.background.bottom.r, 0.25);
  EXPECT_EQ(scene.background.top.g, 2);
  EXPECT_EQ(scene.ambient->distance, 2.5);
  EXPECT_EQ(scene.ambient->samples, 3);
  EXPECT_EQ(scene.light_samples, 2);
  EXPECT_EQ(scene.max_bounces, 5);
  EXPECT_EQ(scene.samples, 16);
  EXPECT_EQ(*scene.size, (std::array<int, 2>{320, 200}));
}

TEST_F(TraceTest, EveryMistakeInASceneIsToldWhereItIs) {
  struct Mistake {
    std::string text;
    std::vector<std::string> parts;
    bool schema_sees_it = true;
  };
  const auto with_file = [](const std::string& more) { return "{\"files\": [\"a.tet\"], " + more + "}"; };
  const auto with_material = [](const std::string& material) {
    return "{\"files\": [{\"path\": \"a.tet\", \"objects\": {\"x\": " + material + "}}]}";
  };
  const std::vector<Mistake> mistakes{
      {"{}", {"$: ", "\"files\" is missing"}},
      {"[]", {"$: expected an object", "found []"}},
      {"3", {"$: expected an object", "found 3"}},
      {R"({"files": []})", {"$.files: expected a list of at least 1"}},
      {R"({"files": "a.tet"})", {"$.files: expected a list", "found \"a.tet\""}},
      {R"({"files": [7]})", {"$.files[0]: expected the path of a tet file", "found 7"}},
      {R"({"files": [""]})", {"$.files[0]: expected a text"}},
      {R"({"files": ["a.tet", {}]})", {"$.files[1]", "\"path\" is missing"}},
      {with_file(R"("camra": {})"), {"$: unknown key \"camra\"", "did you mean \"camera\"?"}},
      {with_file(R"("zebra crossing": 1)"), {"unknown key \"zebra crossing\"", "known are", "point_lights"}},
      {with_file(R"("camera": {"eyes": [0,0,0]})"),
       {"$.camera: unknown key \"eyes\"", "did you mean \"eye\"?"}},
      {with_file(R"("camera": {"eye": [0, 0]})"), {"$.camera.eye: expected three numbers", "found [0,0]"}},
      {with_file(R"("camera": {"eye": [0, 0, "z"]})"), {"$.camera.eye", "found [0,0,\"z\"]"}},
      {with_file(R"("camera": {"eye": [0, 0, 1e31]})"), {"$.camera.eye", "1e30"}},
      {with_file(R"("camera": {"up": [0, 0, 0]})"), {"$.camera.up", "not zero"}, false},
      {with_file(R"("camera": {"fov": 180})"),
       {"$.camera.fov: expected a number from 0.01 to 179, found 180"}},
      {with_file(R"("camera": {"fov": "wide"})"), {"$.camera.fov", "found \"wide\""}},
      {with_file(R"("camera": {"elevation": 90})"), {"$.camera.elevation", "-89 to 89"}},
      {with_file(R"("camera": [])"), {"$.camera: expected an object"}},
      {with_file(R"("point_lights": [{"position": [0,0,0]}])"),
       {"$.point_lights[0]", "\"intensity\" is missing"}},
      {with_file(R"("point_lights": [{"intensity": 1}])"), {"$.point_lights[0]", "\"position\" is missing"}},
      {with_file(R"("point_lights": [{"position": [0,0,0], "intensity": -1}])"),
       {"$.point_lights[0].intensity: expected a colour", "found -1"}},
      {with_file(R"("point_lights": {"position": [0,0,0], "intensity": 1})"),
       {"$.point_lights: expected a list"}},
      {with_file(R"("background": "#12345")"),
       {"$.background: expected a colour", "#rrggbb", "found \"#12345\""}},
      {with_file(R"("background": "#12345g")"), {"$.background"}},
      {with_file(R"("background": {"botom": 1})"), {"$.background", "did you mean \"bottom\"?"}},
      {with_file(R"("background": [1, 2, 1e300])"), {"$.background"}},
      {with_file(R"("ambient_occlusion": {"samples": 1.5})"),
       {"$.ambient_occlusion.samples: expected a whole number"}},
      {with_file(R"("ambient_occlusion": {"distance": -1})"), {"$.ambient_occlusion.distance"}},
      {with_file(R"("ambient_occlusion": true)"), {"$.ambient_occlusion", "found true"}},
      {with_file(R"("samples": 0)"), {"$.samples: expected a whole number from 1 to 1024, found 0"}},
      {with_file(R"("samples": 99999999999999999999)"), {"$.samples"}},
      {with_file(R"("max_bounces": 65)"), {"$.max_bounces"}},
      {with_file(R"("light_samples": null)"), {"$.light_samples", "found null"}},
      {with_file(R"("size": [1, 2, 3])"), {"$.size: expected [width, height]"}},
      {with_file(R"("size": [0, 2])"), {"$.size[0]"}},
      {with_file(R"("size": [32768, 32768])"), {"$.size", "2^28"}, false},
      {with_material("7"), {"$.files[0].objects.x: expected an object"}},
      {with_material(R"({"type": "plastic"})"),
       {"$.files[0].objects.x.type: expected \"diffuse\", \"mirror\" or \"glass\", found \"plastic\""}},
      {with_material(R"({"colour": 1})"), {"did you mean \"color\"?"}},
      {with_material(R"({"color": 1.5})"), {"$.files[0].objects.x.color", "0 to 1", "found 1.5"}},
      {with_material(R"({"color": [1, 1]})"), {"$.files[0].objects.x.color", "found [1,1]"}},
      {with_material(R"({"ior": 0.5})"), {"$.files[0].objects.x.ior", "1 to 10"}},
      {with_material(R"({"texture": 3})"), {"$.files[0].objects.x.texture", "null for no texture"}},
      {with_material(R"({"smooth": 1})"), {"$.files[0].objects.x.smooth: expected true or false, found 1"}},
      {with_material(R"({"vertex_colors": true})"), {"vertex_colors", "\"none\", \"srgb\" or \"linear\""}},
  };
  for (const Mistake& mistake : mistakes) {
    const std::string what = complaint(mistake.text);
    EXPECT_NE(what, "") << mistake.text;
    for (const std::string& part : mistake.parts)
      EXPECT_NE(what.find(part), std::string::npos) << what << " | " << part;
    EXPECT_EQ(!schema_errors(mistake.text).empty(), mistake.schema_sees_it) << mistake.text;
  }
}

TEST_F(TraceTest, WhatIsNoJsonIsToldByLine) {
  const std::vector<std::pair<std::string, std::string>> texts{
      {"", "not JSON"},
      {"{\"files\": [\"a.tet\"],\n \"samples\": nan}", "line 2"},
      {"{\"files\": [\"a.tet\"],\n\n \"camera\": {\"fov\": 1e400}}", "not JSON"},
      {"{\"files\": [\"a.tet\"}", "not JSON"},
      {"{\"files\": [\"\xff\"]}", "not JSON"},
      {std::string("{\"files\": [\"a\0b\"]}", 18), "not JSON"},
      {"{\"files\": [\"a.tet\"], \"files\": [\"b.tet\"]}", "\"files\" stands twice"},
      {"{\"files\": [\"a\\u0000b\"]}", "without zeros"},
      {std::string(100000, '['), "deeper than 64"},
      {"{\"files\": " + std::string(70, '[') + std::string(70, ']') + "}", "deeper than 64"},
      {"{\"camera\": " + std::string(1 << 20, '{'), "not JSON"},
      {std::string((16u << 20) + 1, ' '), "larger than 16 MB"},
      {"\x89TET\r\n\x1a\n", "not JSON"},
  };
  for (const auto& [text, part] : texts) {
    const std::string what = complaint(text);
    EXPECT_NE(what.find(part), std::string::npos) << what;
    EXPECT_LT(what.size(), 400u);
  }
}

TEST_F(TraceTest, ScenesThatCannotBeReadAreInputErrors) {
  std::filesystem::create_directory("scene.json");
  for (const std::string name : {"scene.json", "missing.json", "missing/scene.json"}) {
    try {
      read_scene_file(name);
      FAIL() << name;
    } catch (const Failure& failure) {
      EXPECT_EQ(failure.code(), ExitCode::io);
      EXPECT_NE(std::string(failure.what()).find(name), std::string::npos);
    }
  }
}

TEST_F(TraceTest, ASceneIsNoTetFile) {
  write("scene.json", R"({"files": ["scene.json"]})");
  try {
    open_scene(read_scene_file("scene.json"), true);
    FAIL();
  } catch (const Failure& failure) {
    EXPECT_EQ(failure.code(), ExitCode::invalid);
    EXPECT_NE(std::string(failure.what()).find("scene.json"), std::string::npos);
  }
}

TEST(SceneFile, TheExamplesFollowTheSchema) {
  int count = 0;
  for (const auto& file : std::filesystem::directory_iterator(EXAMPLE_SCENES)) {
    if (file.path().extension() != ".json") continue;
    ++count;
    std::ifstream stream(file.path());
    const std::string text{std::istreambuf_iterator<char>(stream), {}};
    EXPECT_EQ(schema_errors(text), std::vector<std::string>{}) << file.path();
    EXPECT_NO_THROW(read_scene_file(file.path().string())) << file.path();
  }
  EXPECT_GE(count, 3);
}

TEST(SceneFile, NamesThatAreNear) {
  EXPECT_EQ(nearest_name("colour", {"color", "type"}), "color");
  EXPECT_EQ(nearest_name("lok_at", {"eye", "look_at"}), "look_at");
  EXPECT_EQ(nearest_name("x", {"samples", "files"}), "");
  EXPECT_EQ(nearest_name(std::string(100000, 'a'), {"files"}), "");
}

}  // namespace
}  // namespace tetfmt_test
