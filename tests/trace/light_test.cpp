// SPDX-License-Identifier: AGPL-3.0-or-later
// Light on diffuse surfaces, against what geometry says.
#include "trace/trace_support.hpp"

namespace tetfmt_test {
namespace {

using namespace tetprep;

MaterialChange painted(double share, double emission = 0) {
  MaterialChange change;
  change.color = Rgb{share, share, share};
  change.emission = Rgb{emission, emission, emission};
  return change;
}

/// The floor [4, 20]^2 at z = 20, and a square [11, 13]^2 at z = 24 over its middle, whose front is up.
std::vector<FileEntry> floor_and_screen(double screen_z = 24) {
  return {entry("floor.tet", painted(0.5)), entry("square.tet", painted(0.5), {9, 9, screen_z - 4})};
}

class LightTest : public TraceTest {
 protected:
  void SetUp() override {
    TraceTest::SetUp();
    LatticeOptions options;
    options.low = 1;
    options.walls = kTop;
    options.step = 4;
    write("floor.tet", lattice_mesh(6, options));
    write("square.tet", walls_mesh(kTop));
  }
};

TEST_F(LightTest, PointLightsFollowTheInverseSquareAndTheCosine) {
  SceneDescription description = description_of({entry("floor.tet", painted(0.5))});
  description.point_lights = {{{12, 12, 23}, {10, 20, 30}}};
  OpenScene open(description);
  for (const double x : {12.0, 13.0, 16.0}) {
    const double d2 = 9 + (x - 12) * (x - 12);
    const Rgb light = open.light({x, 12, 21}, {0, 0, -1});
    EXPECT_NEAR(light.r, 0.5 / kPi * 10 * 3 / (d2 * std::sqrt(d2)), 1e-7);
    EXPECT_NEAR(light.b, 3 * light.r, 1e-12);
  }
  // From behind, nothing.
  EXPECT_EQ(open.light({12, 12, 19}, {0, 0, 1}).r, 0);
  EXPECT_EQ(open.count(RayKind::shadow), 3u);
}

TEST_F(LightTest, TheEdgeOfAShadowIsWhereItMustBe) {
  SceneDescription description = description_of(floor_and_screen());
  description.point_lights = {{{12, 12, 30}, {100, 100, 100}}};
  OpenScene open(description);
  const double half = 10.0 / 6;  // 1 * (30 - 20) / (30 - 24)
  for (const double sign : {-1.0, 1.0}) {
    for (const double along : {-1.2, 0.1, 1.1}) {
      EXPECT_EQ(open.light({12 + sign * (half - 1e-5), 12 + along, 22}, {0, 0, -1}).r, 0);
      EXPECT_GT(open.light({12 + sign * (half + 1e-5), 12 + along, 22}, {0, 0, -1}).r, 0.1);
      EXPECT_EQ(open.light({12 + along, 12 + sign * (half - 1e-5), 22}, {0, 0, -1}).r, 0);
      EXPECT_GT(open.light({12 + along, 12 + sign * (half + 1e-5), 22}, {0, 0, -1}).r, 0.1);
    }
  }
}

TEST_F(LightTest, ASquareLampGivesItsFormFactor) {
  auto files = floor_and_screen();
  files[1].change = painted(0, 7);
  OpenScene open(description_of(files));
  // Under the middle: four quarters, each a rectangle over its corner (any text on radiative transfer).
  const double a = 1.0 / 4, w = std::sqrt(1 + a * a);
  const double form_factor = 4 * (2 * a / w * std::atan(a / w)) / (2 * kPi);
  EXPECT_NEAR(open.light({12, 12, 21}, {0, 0, -1}, 4000).r, 0.5 * 7 * form_factor, 2e-4);
  // The lamp itself, from both sides.
  EXPECT_EQ(open.light({12.1, 12.2, 23}, {0, 0, 1}).r, 7);
  EXPECT_EQ(open.light({12.1, 12.2, 25}, {0, 0, -1}).r, 7);
  EXPECT_EQ(open.count(RayKind::light), 4000u);
}

TEST_F(LightTest, InTheMiddleOfAPenumbraHalfOfTheLampIsSeen) {
  auto files = floor_and_screen(30);  // the lamp: [11, 13]^2 at z = 30
  files[1].change = painted(0, 50);
  OpenScene clear(description_of(files));
  // A screen [12, 14] x [11, 13] halfway up: its edge x = 12 is over the floor's middle.
  files.push_back(entry("square.tet", painted(0.5), {10, 9, 21}));
  OpenScene shaded(description_of(files));
  const double whole = clear.light({12, 12, 21}, {0, 0, -1}, 4000).r;
  EXPECT_NEAR(shaded.light({12, 12, 21}, {0, 0, -1}, 4000).r, whole / 2, 0.01 * whole);
  // At x = 12.5 the edge hides what is right of 11.5: a quarter is left. The lamp's edge ends the umbra
  // at 13.
  const double right = clear.light({12.5, 12, 21}, {0, 0, -1}, 4000).r;
  EXPECT_NEAR(shaded.light({12.5, 12, 21}, {0, 0, -1}, 4000).r, right / 4, 0.02 * right);
  EXPECT_EQ(shaded.light({13.01, 12, 21}, {0, 0, -1}, 500).r, 0);
}

TEST_F(LightTest, AmbientOcclusionOfAFloorByAWall) {
  // The inside of a room of two walls: floor z = 8 with its inner side up, wall x = 8 (both 8 wide).
  LatticeOptions options;
  options.low = 2;
  options.walls = 1u << 0 | 1u << 4;
  options.step = 4;
  write("corner.tet", lattice_mesh(6, options));
  SceneDescription description = description_of({entry("corner.tet", painted(0.5))});
  description.background = {{1, 1, 1}, {1, 1, 1}};
  for (const double c : {0.25, 0.5, 0.9, 1.1}) {
    const double distance = 1;
    description.ambient = AmbientOcclusion{distance, 8};
    OpenScene open(description);
    // Directions whose part towards the wall is at least c: a segment of the unit disc (Nusselt's analogue).
    const double hidden = c < 1 ? (std::acos(c) - c * std::sqrt(1 - c * c)) / kPi : 0;
    EXPECT_NEAR(open.light({8 + c * distance, 12, 9}, {0, 0, -1}, 1000).r, 0.5 * (1 - hidden), 1e-3) << c;
    EXPECT_EQ(open.count(RayKind::ambient), 8000u);
    EXPECT_EQ(open.count(RayKind::shadow) + open.count(RayKind::light), 0u);
  }
}

TEST_F(LightTest, AConvexSolidUnderAnEvenSkyHasItsOwnColour) {
  write("box.tet", walls_mesh(kBox));
  SceneDescription description = description_of({entry("box.tet", painted(0.6))});
  description.background = {{1, 1, 1}, {1, 1, 1}};
  description.ambient = AmbientOcclusion{std::numeric_limits<double>::infinity(), 4};
  OpenScene open(description);
  for (int i = 0; i < 200; ++i)
    EXPECT_NEAR(open.light({2.01 + 0.0099 * i, 2.5, 5}, {0, 0.1, -1}).r, 0.6, 1e-12);
}

TEST_F(LightTest, LightThatChangesNothingCostsRaysOnly) {
  SceneDescription description = description_of(floor_and_screen());
  description.background = {{0.5, 0.5, 0.5}, {1, 1, 1}};
  description.ambient = AmbientOcclusion{3, 1};
  description.camera.eye = Vec3{20, 14, 40};
  const auto take = [&] {
    const Scene scene = open_scene(description, true);
    RenderOptions options;
    options.width = options.height = 40;
    options.shade = Shade::scene;
    Progress silent;
    return render(scene, make_camera(description.camera, scene, 1), options, silent);
  };
  const Rendering dark = take();
  description.point_lights = {{{12, 12, 30}, {1e-30, 1e-30, 1e-30}}};
  const Rendering lit = take();
  for (std::size_t i = 0; i < dark.image.pixels.size(); ++i)
    ASSERT_NEAR(dark.image.pixels[i].g, lit.image.pixels[i].g, 1e-15);
  const auto shadow = static_cast<std::size_t>(RayKind::shadow);
  EXPECT_EQ(dark.statistics.counts.rays[shadow], 0u);
  EXPECT_GT(lit.statistics.counts.rays[shadow], 1000u);
  EXPECT_EQ(dark.statistics.counts.total() + lit.statistics.counts.rays[shadow],
            lit.statistics.counts.total());
  // A light of no intensity is none.
  description.point_lights = {{{12, 12, 30}, {0, 0, 0}}};
  EXPECT_EQ(take().statistics.counts.total(), dark.statistics.counts.total());
}

TEST_F(LightTest, WithoutLightTheCameraBringsItsOwn) {
  OpenScene open(description_of({entry("floor.tet", painted(0.5))}));
  const Rgb expected = 0.5 * camera_light({0, 0, 1}, open.camera);
  const Rgb light = open.light({12, 12, 21}, {0, 0, -1});
  EXPECT_EQ(light.r, expected.r);
  EXPECT_EQ(light.b, expected.b);
  EXPECT_EQ(open.rays.counts().total(), 1u);
}

TEST_F(LightTest, FilesInOneSceneAreSeenTogether) {
  // The screen hides the floor from above, and the floor the screen from below.
  SceneDescription description = description_of(floor_and_screen());
  description.files[0].change = painted(0, 1);
  description.files[1].change = painted(0, 2);
  for (const bool swapped : {false, true}) {
    if (swapped) std::swap(description.files[0], description.files[1]);
    OpenScene open(description);
    const Vec3 origin = open.scene.parts[0]->offset;
    EXPECT_EQ(open.light({12.1, 12.2, 26}, {0, 0, -1}).r, 2) << origin.x;
    EXPECT_EQ(open.light({12.1, 12.2, 22}, {0, 0, -1}).r, 1);
    EXPECT_EQ(open.light({12.1, 12.2, 18}, {0, 0, 1}).r, 1);
    EXPECT_EQ(open.light({9, 9, 26}, {0, 0, -1}).r, 1);
  }
}

}  // namespace
}  // namespace tetfmt_test
