// SPDX-License-Identifier: AGPL-3.0-or-later
// Rays that are walked together make the same pictures, to the last bit, as rays that are walked one by one.
#include "trace/trace_support.hpp"

namespace tetfmt_test {
namespace {

using namespace tetprep;

enum Thing { kGlassBox, kMirrorBox, kPaintedBox, kLamp, kFloor };

/// Each is a file of its own. The boxes stand over the floor.
FileEntry file_of(Thing which) {
  MaterialChange change;
  change.color = Rgb{0.8, 0.6, 0.4};
  if (which == kGlassBox) {
    change.finish = Finish::glass;
    change.ior = 1.4;
    change.absorption = Rgb{0.5, 0, 0.1};
  }
  if (which == kMirrorBox) change.finish = Finish::mirror;
  if (which == kLamp) change.emission = Rgb{5, 4, 3};
  const std::array<Vec3, 5> places{Vec3{0, 0, 0}, {-3, 0.25, 0}, {0.5, -3, 0}, {3, 4, 2}, {-9, -10, -15}};
  return entry(which == kFloor ? "floor.tet" : "box.tet", change, places[which]);
}

SceneDescription scene_of_things(const std::vector<Thing>& things) {
  SceneDescription description;
  for (const Thing which : things) description.files.push_back(file_of(which));
  description.camera.eye = Vec3{10, 6, 15};
  description.camera.look_at = Vec3{2, 2, 3};
  description.background = {{0.1, 0.1, 0.1}, {0.8, 0.9, 1}};
  return description;
}

Rendering picture(const SceneDescription& description, RenderOptions options) {
  const Scene scene = open_scene(description, options.shade == Shade::scene);
  Progress silent;
  const double aspect = static_cast<double>(options.width) / options.height;
  return render(scene, make_camera(description.camera, scene, aspect), options, silent);
}

void expect_same(const Rendering& a, const Rendering& b, const std::string& what) {
  ASSERT_EQ(a.image.pixels.size(), b.image.pixels.size());
  std::size_t different = 0;
  for (std::size_t i = 0; i < a.image.pixels.size(); ++i) {
    const Rgb &p = a.image.pixels[i], &q = b.image.pixels[i];
    different += p.r != q.r || p.g != q.g || p.b != q.b;
  }
  EXPECT_EQ(different, 0u) << what;
  EXPECT_EQ(a.statistics.counts.rays, b.statistics.counts.rays) << what;
  EXPECT_EQ(a.statistics.counts.hits, b.statistics.counts.hits) << what;
}

class TogetherTest : public TraceTest {
 protected:
  void SetUp() override {
    TraceTest::SetUp();
    write("box.tet", walls_mesh(kBox));
    write("floor.tet", walls_mesh(kTop, 4));  // 8 x 8, at z = 1 once it is placed
  }
  /// `samples` that fit squares of 16 and ones that do not; a picture whose last tiles are partial.
  static void compare(const SceneDescription& description, Shade shade, std::vector<int> samples) {
    for (const int count : samples) {
      RenderOptions options;
      options.width = 45;
      options.height = 35;
      options.samples = count;
      options.shade = shade;
      options.walks = Walks::one_by_one;
      options.threads = 1;
      const Rendering alone = picture(description, options);
      EXPECT_GT(alone.statistics.counts.most_steps, 0u);
      options.walks = Walks::together;
      for (const int threads : {1, 2}) {
        options.threads = threads;
        const Rendering together = picture(description, options);
        expect_same(alone, together, std::to_string(count) + " samples");
        EXPECT_LT(2 * together.statistics.counts.visits, alone.statistics.counts.visits);
        EXPECT_EQ(together.statistics.counts.most_steps, 0u);
      }
    }
  }
};

TEST_F(TogetherTest, CameraRays) {
  compare(scene_of_things({kPaintedBox}), Shade::lambert, {1, 4, 5});
  compare(scene_of_things({kPaintedBox}), Shade::normal, {5});
  compare(scene_of_things({kPaintedBox}), Shade::depth, {9});
  compare(scene_of_things({kGlassBox, kMirrorBox, kPaintedBox, kFloor}), Shade::lambert, {5});
}

TEST_F(TogetherTest, PointLightsAndAmbientOcclusion) {
  for (const auto& things :
       {std::vector<Thing>{kPaintedBox}, {kFloor, kPaintedBox}, {kMirrorBox, kPaintedBox, kFloor}}) {
    SceneDescription description = scene_of_things(things);
    description.point_lights = {{{9, 9, 9}, {150, 150, 100}}, {{3, 3, 7}, {10, 10, 30}}};
    compare(description, Shade::scene, {1, 9});
    description.ambient = AmbientOcclusion{4, 3};
    compare(description, Shade::scene, {1, 4});
  }
}

TEST_F(TogetherTest, MeshLights) {
  SceneDescription description = scene_of_things({kPaintedBox, kLamp, kMirrorBox, kFloor});
  description.light_samples = 2;
  compare(description, Shade::scene, {1, 4});
}

TEST_F(TogetherTest, GlassAndAllKindsOfLight) {
  SceneDescription description = scene_of_things({kGlassBox, kMirrorBox, kPaintedBox, kLamp, kFloor});
  compare(description, Shade::scene, {4});
  description.point_lights = {{{9, 9, 9}, {150, 150, 100}}};
  description.ambient = AmbientOcclusion{4, 2};
  compare(description, Shade::scene, {1, 6});
}

TEST_F(TogetherTest, AFullQueueIsAnsweredInBetween) {
  // Up to 1024 samples a square, 64 questions a hit.
  SceneDescription description = scene_of_things({kFloor, kPaintedBox});
  description.ambient = AmbientOcclusion{4, 64};
  compare(description, Shade::scene, {4});
}

/// From every vertex of the lattice to one of them, and back: the lines run through edges and vertices.
TEST_F(TogetherTest, EveryWalkHasItsExactAndItsFloatSigns) {
  const tetfmt::Mesh mesh = walls_mesh(kBox);
  const auto bytes = tetfmt::encode(mesh, tetfmt::Layout::tet20);
  const auto view = tetfmt::FileView::open(bytes);
  ASSERT_TRUE(view);
  std::vector<tetfmt::Location> places;
  std::vector<tetfmt::Vec3f> directions;
  std::vector<tetfmt::BatchRay> rays;
  const tetfmt::Vec3f target{1, 1, 1};
  const tetfmt::Location to = tetfmt::locate(*view, target);
  for (const tetfmt::Vec3f& v : mesh.vertices) {
    if (v.x == 1 && v.y == 1 && v.z == 1) continue;
    rays.push_back({static_cast<std::uint32_t>(places.size()), {1 - v.x, 1 - v.y, 1 - v.z}, {0, 1}});
    places.push_back(tetfmt::locate(*view, v));
    directions.push_back({v.x - 1, v.y - 1, v.z - 1});
  }
  const std::size_t count = rays.size();
  using tetfmt::Outcome;
  std::vector<std::array<Outcome, 4>> answers[3];
  for (const Walks walks : {Walks::together, Walks::one_by_one, Walks::float_signs}) {
    std::vector<tetfmt::Hit> from_one(count), from_many(count);
    std::vector<Outcome> in_the_way(count), to_a_target(count);
    first_hits(walks, *view, to, directions, from_one);
    first_hits(walks, *view, places, rays, from_many);
    occlusions(walks, *view, places, rays, in_the_way);
    occlusions(walks, *view, places, to, to_a_target);
    for (std::size_t i = 0; i < count; ++i)
      answers[static_cast<std::size_t>(walks)].push_back(
          {from_one[i].outcome, from_many[i].outcome, in_the_way[i], to_a_target[i]});
  }
  std::array<int, 4> wrong{};
  for (std::size_t i = 0; i < count; ++i) {
    EXPECT_EQ(answers[0][i], answers[1][i]) << i;
    EXPECT_EQ(answers[0][i][1], answers[0][i][2]) << i;
    for (std::size_t k = 0; k < 4; ++k) wrong[k] += answers[2][i][k] != answers[1][i][k];
  }
  for (const int count_of_one_walk : wrong) EXPECT_GT(count_of_one_walk, 0);
}

TEST_F(TogetherTest, FloatSignsErrAtEdgesOnly) {
  SceneDescription description = scene_of_things({kMirrorBox, kPaintedBox, kLamp, kFloor});
  description.point_lights = {{{9.1, 9.2, 9.3}, {150, 150, 100}}};
  description.ambient = AmbientOcclusion{4, 1};
  RenderOptions options;
  options.width = options.height = 32;
  options.samples = 1;
  options.shade = Shade::scene;
  const Rendering exact = picture(description, options);
  options.walks = Walks::float_signs;
  const Rendering floats = picture(description, options);
  std::size_t different = 0;
  for (std::size_t i = 0; i < exact.image.pixels.size(); ++i)
    different += std::abs(exact.image.pixels[i].g - floats.image.pixels[i].g) > 1e-3;
  EXPECT_LT(different, exact.image.pixels.size() / 50);
}

}  // namespace
}  // namespace tetfmt_test
