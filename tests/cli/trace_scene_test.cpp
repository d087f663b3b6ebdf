// SPDX-License-Identifier: AGPL-3.0-or-later
// `tet trace SCENE.json`: what a person sees of it. The light itself is tested in tests/trace.
#include <fstream>

#include "cli/cli_support.hpp"
#include "support/region_mesh.hpp"

namespace tetfmt_test {
namespace {

/// Everything at once, small (these boxes have hundreds of hull faces, and rays from outside look at all):
/// glass, a mirror, a point light, a mesh light, ambient occlusion, two files.
constexpr const char* kScene = R"({
  "files": [
    {"path": "box.tet", "material": {"type": "glass", "ior": 1.4, "absorption": [0.5, 0, 0]}},
    {"path": "box.tet", "translate": [-3, 0, 0], "material": {"type": "mirror", "color": 0.8}},
    {"path": "box.tet", "translate": [0, -3, 0], "material": {"color": "#c08040"}},
    {"path": "box.tet", "translate": [3, 4, 2], "material": {"emission": [5, 4, 3]}}
  ],
  "camera": {"eye": [20, 26, 45], "look_at": [12, 22, 33]},
  "point_lights": [{"position": [20, 30, 40], "intensity": 150}],
  "background": {"bottom": 0.1, "top": 0.8},
  "ambient_occlusion": {"distance": 4, "samples": 2},
  "samples": 4, "size": [32, 24]
})";

RunResult trace_scene(const std::vector<std::string>& more, const std::string& output = "out.png") {
  std::vector<std::string> arguments{"trace", "scene.json", "-o", output};
  arguments.insert(arguments.end(), more.begin(), more.end());
  const RunResult result = tet(arguments);
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_EQ(result.out, "");
  return result;
}

TEST_F(CliTest, ScenesAreTheSameForAnyNumberOfThreads) {
  write_mesh("box.tet", box_mesh());
  write_bytes("scene.json", kScene);
  for (const std::string output : {"out.png", "out.exr"}) {
    std::string expected;
    for (const std::string threads : {"1", "2", "3"}) {
      const RunResult result = trace_scene({"--threads", threads}, output);
      EXPECT_TRUE(is_one_line(result.err, "tet trace",
                              {output, "32 x 24", "3072 camera", "shadow", "light", "reflection",
                               "refraction", "ambient occlusion", "ns of a thread a ray", "% hit",
                               "tets visited a camera ray, walked together", "read at most"}));
      const std::string bytes = read_bytes(output);
      if (expected.empty()) expected = bytes;
      EXPECT_EQ(bytes, expected) << threads;
    }
    EXPECT_GT(expected.size(), 500u);
  }
  EXPECT_EQ(read_bytes("out.exr").substr(0, 4), "\x76\x2f\x31\x01");
}

TEST_F(CliTest, OptionsGoBeforeTheScene) {
  write_mesh("box.tet", box_mesh());
  write_bytes("scene.json", kScene);
  EXPECT_TRUE(is_one_line(trace_scene({"--size", "31x17", "--samples", "1"}).err, "tet trace",
                          {"31 x 17", "527 camera"}));
  trace_scene({});
  const std::string plain = read_bytes("out.png");
  for (const std::vector<std::string>& options : {std::vector<std::string>{"--eye", "5,26,45"},
                                                  {"--look-at", "13,22,33"},
                                                  {"--up", "1,0,0"},
                                                  {"--fov", "20"},
                                                  {"--azimuth", "10"},
                                                  {"--elevation", "40"},
                                                  {"--shade", "normal"},
                                                  {"--shade", "depth"},
                                                  {"--shade", "steps"},
                                                  {"--shade", "lambert"}}) {
    trace_scene(options);
    EXPECT_NE(read_bytes("out.png"), plain) << options[0] << ' ' << options[1];
  }
  trace_scene({"--shade", "scene", "--kernel", "exact"});
  EXPECT_EQ(read_bytes("out.png"), plain);
  trace_scene({"--kernel", "float"});  // what it may get wrong is told of, and ends
}

TEST_F(CliTest, ATetFileCanBeShownAsAScene) {
  write_mesh("box.tet", box_mesh());
  write_bytes("scene.json", R"({"files": ["box.tet"]})");
  trace_scene({"--size", "40x30"});
  const std::string scene = read_bytes("out.png");
  EXPECT_EQ(tet({"trace", "box.tet", "-o", "out.png", "--size", "40x30", "--shade", "scene"}).exit_code, 0);
  EXPECT_EQ(read_bytes("out.png"), scene);
  trace_scene({"--size", "40x30", "--shade", "lambert"});
  const std::string clay = read_bytes("out.png");
  EXPECT_EQ(tet({"trace", "box.tet", "-o", "out.png", "--size", "40x30"}).exit_code, 0);
  EXPECT_EQ(read_bytes("out.png"), clay);
}

TEST_F(CliTest, MistakesInScenesAreOneLineAndLeaveNothing) {
  write_mesh("box.tet", box_mesh());
  const std::vector<std::tuple<std::string, int, std::vector<std::string>>> mistakes{
      {R"({"files": ["box.tet"], "camera": {"eye": [1, 2]}})",
       3,
       {"scene.json: $.camera.eye", "found [1,2]"}},
      {R"({"files": ["box.tet"], "sampels": 4})", 3, {"scene.json: $", "did you mean \"samples\"?"}},
      {R"({"files": ["box.tet"],})", 3, {"scene.json: not JSON", "line 1"}},
      {R"({"files": ["missing.tet"]})", 2, {"missing.tet"}},
      {R"({"files": ["scene.json"]})", 3, {"scene.json", "tet convert"}},
      {R"({"files": ["."]})", 2, {"."}},
      {R"({"files": [{"path": "box.tet", "materials": {"x": {}}}]})",
       3,
       {"$.files[0].materials.x", "no material 'x'"}},
      {R"({"files": [{"path": "box.tet", "material": {"texture": "no.png"}}]})",
       2,
       {"scene.json: $.files[0].material.texture", "no.png"}},
      {R"({"files": [{"path": "box.tet", "material": {"texture": "box.tet"}}]})",
       3,
       {"scene.json: $.files[0].material.texture", "box.tet", "PNG"}},
      {R"({"files": ["box.tet"], "camera": {"eye": [1, 2, 3], "look_at": [1, 2, 3]}})",
       3,
       {"scene.json: $.camera", "same point"}},
      {R"({"files": ["box.tet"], "camera": {"eye": [1, 2, 3], "look_at": [1, 3, 3], "up": [0, 1, 0]}})",
       3,
       {"scene.json: $.camera", "parallel"}},
      {std::string(1 << 16, '['), 3, {"scene.json", "deeper"}},
  };
  for (const auto& [text, code, parts] : mistakes) {
    write_bytes("scene.json", text);
    const RunResult result = tet({"trace", "scene.json", "-o", "out.png", "--size", "8x8"});
    EXPECT_EQ(result.exit_code, code) << text.substr(0, 100) << result.err;
    EXPECT_TRUE(is_one_line(result.err, "tet trace", parts)) << text.substr(0, 100);
    EXPECT_EQ(listing(), (std::vector<std::string>{"box.tet", "scene.json"}));
  }
}

TEST_F(CliTest, WhatIsInLeftOutSpaceIsTheFaultOfWhoPutItThere) {
  write_mesh("box.tet", with_regions(box_mesh(), {0}));  // the inside is left out
  const auto refused = [this](const std::string& scene, const std::vector<std::string>& more, int code,
                              const std::vector<std::string>& parts) {
    write_bytes("scene.json", scene);
    std::vector<std::string> arguments{"trace", "scene.json", "-o", "out.png", "--size", "9x9"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    const RunResult result = tet(arguments);
    EXPECT_EQ(result.exit_code, code) << result.err;
    EXPECT_TRUE(is_one_line(result.err, "tet trace", parts)) << result.err;
    EXPECT_EQ(listing(), (std::vector<std::string>{"box.tet", "scene.json"}));
  };
  const std::string inside = "[12.9, 23.1, 33]";
  refused(R"({"files": ["box.tet"], "camera": {"eye": )" + inside + "}}", {}, 3,
          {"scene.json: $.camera", "leaves out", "--keep all"});
  refused(R"({"files": ["box.tet"], "camera": {"eye": [20, 26, 45]}})", {"--eye", "12.9,23.1,33"}, 1,
          {"leaves out", "--eye", "--keep all"});
  refused(R"({"files": ["box.tet"], "point_lights": [{"position": [20, 26, 45], "intensity": 1},)"
          R"( {"position": )" +
              inside + R"(, "intensity": 1}]})",
          {}, 3, {"scene.json: $.point_lights[1]", "the light", "leaves out", "--keep all"});
  refused(R"({"files": [{"path": "box.tet", "material": {"type": "glass"}}]})", {}, 3,
          {"box.tet", "leaves out", "--keep all"});
}

TEST_F(CliTest, ScenesOfHugeAndTinyNumbersEnd) {
  write_mesh("box.tet", box_mesh());
  for (const std::string camera :
       {"[1e30, 1e30, -1e30]", "[-1e30, 0, 0]", "[1e-300, 1e-45, 0]", "[13, 23, 33]"}) {
    for (const std::string light : {"[1e30, 0, 0]", "[13, 23, 33]", "[13, 23, 34]", "[12, 22, 32]"}) {
      write_bytes("scene.json",
                  R"({"files": [{"path": "box.tet", "material": {"emission": 1e12}},)"
                  R"( {"path": "box.tet", "translate": [1e30, -1e30, 1e-30], "material": {"type": "glass"}},)"
                  R"( {"path": "box.tet", "translate": [1e-7, 0, 0], "material": {"type": "glass"}}],)"
                  R"( "camera": {"eye": )" +
                      camera +
                      R"(, "look_at": [1, 1, 1], "fov": 179},)"
                      R"( "point_lights": [{"position": )" +
                      light +
                      R"(, "intensity": 1e12}],)"
                      R"( "ambient_occlusion": {"distance": 1e30}, "background": 1e12})");
      trace_scene({"--size", "12x9", "--samples", "1"});
    }
  }
}

TEST_F(CliTest, ScenesNeverWriteOverTheirInputs) {
  write_mesh("box.tet", box_mesh());
  write_bytes("scene.json", kScene);
  for (const std::string output : {"box.tet", "scene.json", "./scene.json"}) {
    const std::string before = read_bytes(output);
    const RunResult result = tet({"trace", "scene.json", "-o", output});
    EXPECT_EQ(result.exit_code, 1);
    EXPECT_TRUE(is_one_line(result.err, "tet trace", {output, "the input itself"}));
    EXPECT_EQ(read_bytes(output), before);
  }
}

TEST_F(CliTest, ScenesNeverWriteOverTheirTextures) {
  write_mesh("box.tet", box_mesh());
  ASSERT_EQ(tet({"trace", "box.tet", "-o", "wood.png", "--size", "8x8"}).exit_code, 0);
  write_bytes("scene.json", R"({"files": [{"path": "box.tet", "material": {"texture": "wood.png"}}]})");
  const std::string before = read_bytes("wood.png");
  const RunResult result = tet({"trace", "scene.json", "-o", "./wood.png", "--size", "9x9"});
  EXPECT_EQ(result.exit_code, 1);
  EXPECT_TRUE(result.err.find("the input itself") != std::string::npos) << result.err;
  EXPECT_EQ(read_bytes("wood.png"), before);
}

TEST_F(CliTest, BrokenTetFilesEndScenesWithAnErrorOrAPicture) {
  write_bytes("scene.json", kScene);
  const std::string whole = read_bytes(write_mesh("box.tet", box_mesh()));
  int refused = 0, traced = 0;
  for (std::size_t at = 128; at < whole.size(); at += whole.size() / 97) {
    std::string broken = whole;
    for (std::size_t i = at; i < std::min(at + 4, broken.size()); ++i)
      broken[i] = static_cast<char>(~broken[i]);
    write_bytes("box.tet", broken);
    const RunResult result =
        tet({"trace", "scene.json", "-o", "out.png", "--size", "12x9", "--samples", "1"});
    EXPECT_TRUE(result.exit_code == 0 || result.exit_code == 1 || result.exit_code == 3 ||
                result.exit_code == 5)
        << at << ' ' << result.exit_code << ' ' << result.err;
    (result.exit_code == 0 ? traced : refused) += 1;
  }
  EXPECT_GT(refused, 0);
  EXPECT_GT(traced, 0);
}

}  // namespace
}  // namespace tetfmt_test
