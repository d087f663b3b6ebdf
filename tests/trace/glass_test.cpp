// SPDX-License-Identifier: AGPL-3.0-or-later
// Mirrors and glass: light along single rays, against what optics says exactly.
#include "common/failure.hpp"
#include "support/region_mesh.hpp"
#include "trace/optics.hpp"
#include "trace/trace_support.hpp"

namespace tetfmt_test {
namespace {

using namespace tetprep;

MaterialChange glass(double ior) {
  MaterialChange change;
  change.finish = Finish::glass;
  change.color = Rgb{1, 1, 1};
  change.ior = ior;
  return change;
}
MaterialChange mirror(double share) {
  MaterialChange change;
  change.finish = Finish::mirror;
  change.color = Rgb{share, share, share};
  return change;
}
MaterialChange painted(double share) {
  MaterialChange change;
  change.color = Rgb{share, share, share};
  return change;
}

TEST_F(TraceTest, AGlassFaceReflectsAndRefractsAsFresnelAndSnellSay) {
  write("wall.tet", walls_mesh(kTop));
  SceneDescription description = description_of({entry("wall.tet", glass(1.5))});
  description.background = {{0, 0, 0}, {1, 1, 1}};
  description.camera.up = Vec3{1, 0, 0};  // what is seen of the background tells the x of a direction
  OpenScene open(description);
  const auto seen = [](double x) { return 0.5 + 0.5 * x; };
  for (const double degrees : {0.0, 20.0, 50.0, 75.0}) {
    const double sine = std::sin(degrees * kPi / 180), cosine = std::cos(degrees * kPi / 180);
    const Vec3 eye{3.1 - 0.5 * sine / cosine, 3.2, 4.5};
    const double back = reflectance(cosine, 1 / 1.5);
    EXPECT_NEAR(open.light(eye, {sine, 0, -cosine}).r, back * seen(sine) + (1 - back) * seen(sine / 1.5),
                2e-7)
        << degrees;
  }
  EXPECT_EQ(open.count(RayKind::reflection), open.count(RayKind::refraction));
  // From inside of the glass: beyond 41.8 degrees all is reflected.
  for (const double degrees : {10.0, 41.0, 42.0, 60.0}) {
    const double sine = std::sin(degrees * kPi / 180), cosine = std::cos(degrees * kPi / 180);
    const Vec3 eye{3.1 - 0.5 * sine / cosine, 3.2, 3.5};
    const double back = reflectance(cosine, 1.5);
    EXPECT_EQ(back == 1, degrees > 41.82);
    EXPECT_NEAR(open.light(eye, {sine, 0, cosine}).r,
                back * seen(sine) + (1 - back) * seen(back < 1 ? 1.5 * sine : 0), 4e-7)
        << degrees;
  }
}

TEST_F(TraceTest, GlassReflectsFourPercentAtNormalIncidence) {
  write("box.tet", walls_mesh(kBox));
  SceneDescription description = description_of({entry("box.tet", glass(1.5))});
  description.background = {{0, 0, 0}, {1, 1, 1}};
  description.camera.up = Vec3{0, 0, 1};
  description.max_bounces = 1;  // what enters is lost
  EXPECT_NEAR(OpenScene(description).light({3.1, 3.2, 5}, {0, 0, -1}).r, 0.04, 1e-9);
  description.max_bounces = 64;  // between two faces: 2 F / (1 + F)
  EXPECT_NEAR(OpenScene(description).light({3.1, 3.2, 5}, {0, 0, -1}, 4096).r, 0.08 / 1.04, 2e-3);
}

TEST_F(TraceTest, GlassUnderAnEvenSkyIsInvisible) {
  write("box.tet", walls_mesh(kBox));
  SceneDescription description = description_of({entry("box.tet", glass(1.5))});
  description.background = {{1, 1, 1}, {1, 1, 1}};
  description.max_bounces = 64;
  OpenScene open(description);
  for (int i = 0; i < 100; ++i) {
    const double x = 2.05 + 0.019 * i;
    EXPECT_NEAR(open.light({x, 3.3, 5.5}, {0.2, 0.01 * i - 0.5, -1}).g, 1, 1e-12);
  }
  EXPECT_EQ(open.count(RayKind::shadow) + open.count(RayKind::light) + open.count(RayKind::ambient), 0u);
}

TEST_F(TraceTest, GlassDimsByItsThickness) {
  write("box.tet", walls_mesh(kBox));
  MaterialChange green = glass(1);
  green.absorption = Rgb{1, 0, 0.5};
  SceneDescription description = description_of({entry("box.tet", green)});
  description.background = {{1, 1, 1}, {1, 1, 1}};
  OpenScene open(description);
  const Rgb straight = open.light({3.1, 3.2, 5}, {0, 0, -2});
  EXPECT_NEAR(straight.r, std::exp(-2.0), 1e-12);
  EXPECT_EQ(straight.g, 1);
  EXPECT_NEAR(straight.b, std::exp(-1.0), 1e-12);
  const Rgb tilted = open.light({3.1, 3.2, 5}, {0, 0.25, -1});  // in at 3.45, out at 3.95
  EXPECT_NEAR(tilted.r, std::exp(-2 * std::sqrt(1.0625)), 1e-7);
}

TEST_F(TraceTest, GlassOfIndexOneIsInvisiblePixelForPixel) {
  write("box.tet", walls_mesh(kBox));
  for (const bool mesh_light : {false, true}) {
    MaterialChange lamp = painted(0);
    lamp.emission = Rgb{3, 2, 1};
    std::vector<FileEntry> files{entry("box.tet", painted(0.7))};
    if (mesh_light) files.push_back(entry("box.tet", lamp, {-3, 4, 2}));
    const std::size_t without = files.size();
    files.push_back(entry("box.tet", glass(1), {0.25, 0.25, 2.5}));
    std::vector<Image> images;
    for (const std::size_t count : {without, files.size()}) {
      SceneDescription description =
          description_of({files.begin(), files.begin() + static_cast<std::ptrdiff_t>(count)});
      description.background = {{0.2, 0.2, 0.2}, {0.4, 0.5, 0.6}};
      if (!mesh_light) description.point_lights = {{{2, 3, 8}, {40, 40, 40}}};
      description.ambient = AmbientOcclusion{3, 1};
      description.camera.eye = Vec3{4, 4.5, 11};
      description.camera.look_at = Vec3{3, 3, 3};
      const Scene scene = open_scene(description, true);
      RenderOptions options;
      options.width = options.height = 48;
      options.samples = 1;
      options.shade = Shade::scene;
      Progress silent;
      images.push_back(render(scene, make_camera(description.camera, scene, 1), options, silent).image);
    }
    double least = 1, most = 0;
    for (std::size_t i = 0; i < images[0].pixels.size(); ++i) {
      EXPECT_NEAR(images[0].pixels[i].r, images[1].pixels[i].r, 1e-6) << i;
      EXPECT_NEAR(images[0].pixels[i].b, images[1].pixels[i].b, 1e-6) << i;
      least = std::min(least, images[0].pixels[i].r);
      most = std::max(most, images[0].pixels[i].r);
    }
    EXPECT_GT(most - least, 0.1);  // there is something to see
  }
}

TEST_F(TraceTest, AMirrorBoxAddsUpItsReflections) {
  write("box.tet", walls_mesh(kBox));
  MaterialChange glowing = mirror(0.9);
  glowing.emission = Rgb{1, 2, 0};
  for (const int bounces : {0, 1, 10, 64}) {
    SceneDescription description = description_of({entry("box.tet", glowing)});
    description.max_bounces = bounces;
    OpenScene open(description);
    for (const Vec3 direction : {Vec3{1, 0, 0}, Vec3{0.3, 0.5, -0.7}, Vec3{1, 1, 1}}) {
      double expected = 0;
      for (int i = 0; i <= bounces; ++i) expected += std::pow(0.9, i);
      EXPECT_NEAR(open.light({3, 3, 3}, direction).r, expected, 1e-9);
      EXPECT_NEAR(open.light({3, 3, 3}, direction).g, 2 * expected, 1e-9);
    }
    EXPECT_EQ(open.count(RayKind::reflection), static_cast<std::uint64_t>(6 * bounces));
    EXPECT_EQ(open.count(RayKind::refraction), 0u);
  }
}

TEST_F(TraceTest, GlassNeedsTheSpaceInside) {
  write("box.tet", with_regions(walls_mesh(kBox), {0}));
  OpenScene open(description_of({entry("box.tet", glass(1.5))}));
  try {
    open.light({3.1, 3.2, 5}, {0, 0, -1});
    FAIL() << "the inside was left out";
  } catch (const Failure& failure) {
    EXPECT_EQ(failure.code(), ExitCode::invalid);
    EXPECT_NE(std::string(failure.what()).find("--keep all"), std::string::npos);
  }
  // What is opaque does not mind.
  EXPECT_GT(OpenScene(description_of({entry("box.tet", painted(0.5))})).light({3.1, 3.2, 5}, {0, 0, -1}).r,
            0);
}

TEST_F(TraceTest, ShadowsOfGlassAreTinted) {
  write("box.tet", walls_mesh(kBox));
  MaterialChange red = glass(1);
  red.absorption = Rgb{0, 1, 1};
  SceneDescription description =
      description_of({entry("box.tet", painted(1)), entry("box.tet", red, {0, 0, 3})});
  description.point_lights = {{{3.1, 3.2, 9}, {kPi, kPi, kPi}}};
  OpenScene open(description);
  // The lower box's top, z = 4, is 5 below the light; the glass between is 2 thick.
  const Rgb light = open.light({3.1, 3.2, 4.5}, {0, 0, -1});
  EXPECT_NEAR(light.r, 1.0 / 25, 1e-6);
  EXPECT_NEAR(light.g, std::exp(-2.0) / 25, 1e-6);
}

}  // namespace
}  // namespace tetfmt_test
