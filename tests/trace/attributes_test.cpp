// SPDX-License-Identifier: AGPL-3.0-or-later
// What files say of their surface: normals, colours, textures, materials, objects; and that nothing is read
// which a scene does not need.
#include <png.h>
#include <sys/mman.h>

#include "common/failure.hpp"
#include "trace/trace_support.hpp"

namespace tetfmt_test {
namespace {

using namespace tetprep;
using tetfmt::Index;

/// Texts, one after the other, and where they start.
struct Texts {
  std::string bytes;
  tetfmt::TextRef add(const std::string& text) {
    const auto start = static_cast<tetfmt::TextRef>(bytes.size());
    bytes += text + '\0';
    return start;
  }
  tetfmt::OptionalSection section() const {
    return section_of(tetfmt::kTexts, std::vector<char>(bytes.begin(), bytes.end()));
  }
};

/// The square [2, 4]^2 at z = 4, of two triangles, with four points of its own: their normals, colours and
/// texture coordinates are those of their corner. `padding` more points make the sections larger.
tetfmt::Mesh decorated(const std::string& texture = {}, std::size_t padding = 0) {
  tetfmt::Mesh mesh = walls_mesh(kTop);
  std::vector<std::array<Index, 3>> corners;
  std::vector<Index> points;
  for (const tetfmt::Triangle& triangle : mesh.triangles) {
    std::array<Index, 3> own{};
    for (std::size_t k = 0; k < 3; ++k) {
      const auto found = std::find(points.begin(), points.end(), triangle.vertices[k]);
      own[k] = static_cast<Index>(found - points.begin());
      if (found == points.end()) points.push_back(triangle.vertices[k]);
    }
    corners.push_back(own);
  }
  std::vector<std::array<float, 3>> normals;
  std::vector<std::array<float, 2>> texcoords;
  std::vector<std::array<float, 4>> colors;
  for (const Index v : points) {
    const float x = (mesh.vertices[v].x - 2) / 2, y = (mesh.vertices[v].y - 2) / 2;
    normals.push_back({x, 0, 1});
    texcoords.push_back({x, y});
    colors.push_back({x, y, 1, 1});
  }
  normals.resize(normals.size() + padding);
  texcoords.resize(texcoords.size() + padding);
  colors.resize(colors.size() + padding);
  Texts texts;
  std::vector<tetfmt::Material> materials(1);
  materials[0].base_color = {1, 1, 1, 1};
  materials[0].name = texts.add("paint");
  if (!texture.empty()) materials[0].base_color_texture = texts.add(texture);
  const std::vector<tetfmt::Object> objects{{texts.add("left"), texts.add("two.obj")},
                                            {texts.add("right"), texts.add("two.obj")}};
  mesh.optional = {texts.section(),
                   section_of(tetfmt::kMaterials, materials),
                   section_of(tetfmt::kObjects, objects),
                   section_of(tetfmt::kTriangleObjects, std::vector<Index>{0, 1}),
                   section_of(tetfmt::kCorners, corners),
                   section_of(tetfmt::kNormals, normals),
                   section_of(tetfmt::kTexcoords, texcoords),
                   section_of(tetfmt::kColors, colors)};
  return mesh;
}

void write_png_file(const std::string& name, int width, int height, std::vector<std::uint8_t> rgb) {
  png_image control{};
  control.version = PNG_IMAGE_VERSION;
  control.width = static_cast<png_uint_32>(width);
  control.height = static_cast<png_uint_32>(height);
  control.format = PNG_FORMAT_RGB;
  ASSERT_NE(png_image_write_to_file(&control, name.c_str(), 0, rgb.data(), 0, nullptr), 0);
}

/// All light there is comes evenly from everywhere, so a surface shows its own colour.
SceneDescription evenly_lit(const FileEntry& file) {
  SceneDescription description = description_of({file});
  description.background = {{1, 1, 1}, {1, 1, 1}};
  description.ambient = AmbientOcclusion{};
  return description;
}
Rgb color_at(OpenScene& open, double x, double y) {
  return open.light({x, y, 5}, {0, 0, -1});
}

TEST_F(TraceTest, ColoursOfPointsAreInterpolatedAsTheSceneTakesThem) {
  write("square.tet", decorated());
  OpenScene screen(evenly_lit(entry("square.tet")));
  EXPECT_NEAR(color_at(screen, 3, 2.5).r, srgb_decode(0.5), 1e-6);
  EXPECT_NEAR(color_at(screen, 3, 2.5).g, srgb_decode(0.25), 1e-6);
  EXPECT_NEAR(color_at(screen, 3, 2.5).b, 1, 1e-12);
  MaterialChange change;
  change.vertex_colors = VertexColors::linear;
  OpenScene linear(evenly_lit(entry("square.tet", change)));
  EXPECT_NEAR(color_at(linear, 3, 2.5).g, 0.25, 1e-6);
  change.vertex_colors = VertexColors::none;
  OpenScene none(evenly_lit(entry("square.tet", change)));
  EXPECT_NEAR(color_at(none, 3, 2.5).g, 1, 1e-12);
  // A colour of the scene's takes their place.
  MaterialChange painted;
  painted.color = Rgb{0.1, 0.2, 0.3};
  OpenScene own(evenly_lit(entry("square.tet", painted)));
  EXPECT_NEAR(color_at(own, 3, 2.5).g, 0.2, 1e-12);
}

TEST_F(TraceTest, ObjectsChangeAboveMaterialsAboveFiles) {
  write("square.tet", decorated());
  FileEntry file = entry("square.tet");
  file.change.color = Rgb{0.1, 0.1, 0.1};
  MaterialChange material, object;
  material.color = Rgb{0.2, 0.2, 0.2};
  object.color = Rgb{0.3, 0.3, 0.3};
  const auto seen = [&] {
    OpenScene open(evenly_lit(file));
    return std::array<double, 2>{color_at(open, 3.5, 2.5).r, color_at(open, 2.5, 3.5).r};
  };
  EXPECT_NEAR(seen()[0], 0.1, 1e-12);
  file.materials = {{"paint", material, "here"}};
  EXPECT_NEAR(seen()[0], 0.2, 1e-12);
  file.objects = {{"left", object, "here"}};  // one of the two triangles
  EXPECT_NEAR(seen()[0] + seen()[1], 0.5, 1e-12);
  file.objects = {{"two.obj", object, "here"}};  // both, by their file
  EXPECT_NEAR(seen()[0] + seen()[1], 0.6, 1e-12);
  file.objects = {{"lefft", object, "scene.json: $.files[0].objects.lefft"}};
  try {
    seen();
    FAIL() << "there is no such object";
  } catch (const Failure& failure) {
    const std::string text = failure.what();
    EXPECT_EQ(failure.code(), ExitCode::invalid);
    for (const char* part : {"scene.json: $.files[0].objects.lefft", "square.tet", "did you mean 'left'?"})
      EXPECT_NE(text.find(part), std::string::npos) << text;
  }
}

TEST_F(TraceTest, TexturesLieOnTheSurface) {
  // Red and green above, blue and white below.
  write_png_file("four.png", 2, 2, {255, 0, 0, 0, 255, 0, 0, 0, 255, 255, 255, 255});
  std::filesystem::create_directory("models");
  write("models/square.tet", decorated("../four.png"));
  MaterialChange change;
  change.vertex_colors = VertexColors::none;
  OpenScene open(evenly_lit(entry("models/square.tet", change)));
  EXPECT_TRUE(open.scene.warnings.empty());
  const auto is = [](Rgb light, double r, double g, double b) {
    EXPECT_NEAR(light.r, r, 1e-6);
    EXPECT_NEAR(light.g, g, 1e-6);
    EXPECT_NEAR(light.b, b, 1e-6);
  };
  is(color_at(open, 2.5, 3.5), 1, 0, 0);  // the middles of the four pixels
  is(color_at(open, 3.5, 3.5), 0, 1, 0);
  is(color_at(open, 2.5, 2.5), 0, 0, 1);
  is(color_at(open, 3.5, 2.5), 1, 1, 1);
  is(color_at(open, 3, 3.5), 0.5, 0.5, 0);
  change.texture_origin = TextureOrigin::top;
  OpenScene turned(evenly_lit(entry("models/square.tet", change)));
  is(color_at(turned, 2.5, 3.5), 0, 0, 1);
  change.texture = "";
  OpenScene none(evenly_lit(entry("models/square.tet", change)));
  is(color_at(none, 2.5, 3.5), 1, 1, 1);
}

TEST_F(TraceTest, TexturesThatAreNotThereAreWarnedOfOnceOrRefused) {
  write("broken.png", "no picture");
  for (const std::string name :
       {"missing.png", "broken.png", "/dev/zero", ".", "data:image/png;base64,AAAA"}) {
    write("square.tet", decorated(name));
    const Scene scene = open_scene(description_of({entry("square.tet")}), true);
    ASSERT_EQ(scene.warnings.size(), 1u) << name;
    EXPECT_NE(scene.warnings[0].find("plain colour"), std::string::npos);
    MaterialChange change;
    change.texture = name;
    EXPECT_THROW(open_scene(description_of({entry("square.tet", change)}), true), Failure) << name;
  }
}

TEST_F(TraceTest, SmoothNormalsShadeAndMirror) {
  write("square.tet", decorated());
  MaterialChange change;
  change.finish = Finish::mirror;
  change.color = Rgb{1, 1, 1};
  SceneDescription description = description_of({entry("square.tet", change)});
  description.background = {{0, 0, 0}, {1, 1, 1}};
  description.camera.up = Vec3{1, 0, 0};
  OpenScene open(description);
  for (const double x : {2.25, 3.0, 3.75}) {
    // The normal leans towards +x by atan(s), the reflection by twice that.
    const double s = (x - 2) / 2;
    EXPECT_NEAR(open.light({x, 2.5, 5}, {0, 0, -1}).r, 0.5 + 0.5 * std::sin(2 * std::atan(s)), 1e-6);
  }
  // A ray that the interpolated normal would send below the surface stays above, and still meets nothing.
  const double s = 0.9;
  const Vec3 in = unit({-1, 0, -0.1});
  const Vec3 n = unit({s, 0, 1});
  Vec3 out = in - (2 * dot(in, n)) * n;
  EXPECT_GT(out.z, 0);
  const Vec3 steep = unit({1, 0, -0.1});
  out = steep - (2 * dot(steep, n)) * n;  // downward
  ASSERT_LT(out.z, 0);
  EXPECT_NEAR(open.light(Vec3{3.8, 2.5, 4} - 2 * steep, steep).r, 0.5 + 0.5 * out.x, 1e-6);
  EXPECT_EQ(open.count(RayKind::reflection), 4u);

  change.smooth = false;
  SceneDescription flat = description;
  flat.files[0].change = change;
  EXPECT_NEAR(OpenScene(flat).light({3.5, 2.5, 5}, {0, 0, -1}).r, 0.5, 1e-12);
}

/// Takes reading away from every whole page of a section.
void forbid(const tetfmt::FileView& view, tetfmt::SectionKind kind) {
  const auto bytes = view.section(kind);
  constexpr std::uintptr_t kPage = 4096;
  const auto begin = (reinterpret_cast<std::uintptr_t>(bytes.data()) + kPage - 1) / kPage * kPage;
  const auto end = reinterpret_cast<std::uintptr_t>(bytes.data() + bytes.size()) / kPage * kPage;
  ASSERT_GT(end, begin + kPage) << "the section is too small for this test";
  ASSERT_EQ(mprotect(reinterpret_cast<void*>(begin), end - begin, PROT_NONE), 0);
}

TEST_F(TraceTest, WhatASceneDoesNotNeedIsNotRead) {
  constexpr std::size_t kPadding = 100000;
  // Points that matter come last, so that they are in the pages that may not be read.
  tetfmt::Mesh mesh = decorated({}, 0);
  for (tetfmt::OptionalSection& section : mesh.optional) {
    const bool of_points = section.kind == tetfmt::kNormals || section.kind == tetfmt::kTexcoords ||
                           section.kind == tetfmt::kColors;
    if (of_points) section.bytes.insert(section.bytes.begin(), kPadding * section.stride, std::byte{});
    if (section.kind != tetfmt::kCorners) continue;
    for (std::size_t i = 0; i < section.bytes.size(); i += 4) {
      Index point;
      std::memcpy(&point, section.bytes.data() + i, 4);
      point += kPadding - 50000;  // in the middle
      std::memcpy(section.bytes.data() + i, &point, 4);
    }
  }
  mesh.optional.push_back(section_of(tetfmt::kPropertyValues, std::vector<double>(kPadding)));
  write("square.tet", mesh);

  MaterialChange plain;
  plain.smooth = false;
  plain.vertex_colors = VertexColors::none;
  const auto trace = [](const MaterialChange& change, const std::vector<tetfmt::SectionKind>& forbidden,
                        bool shaded) {
    const Scene scene = open_scene(description_of({entry("square.tet", change)}), shaded);
    for (const auto kind : forbidden) forbid(scene.parts[0]->view(), kind);
    RenderOptions options;
    options.width = options.height = 16;
    options.shade = shaded ? Shade::scene : Shade::lambert;
    Progress silent;
    const Rendering rendering = render(scene, make_camera({}, scene, 1), options, silent);
    EXPECT_GT(rendering.statistics.counts.hits, 100u);
    return scene.readable_bytes();
  };
  using namespace tetfmt;
  const std::vector<SectionKind> all{kNormals, kTexcoords, kColors, kPropertyValues};
  const std::uint64_t least = trace(plain, all, true);
  EXPECT_LE(trace(plain, all, false), least);
  EXPECT_LT(least, kPadding * 8);  // not the smallest of the four

  MaterialChange smooth = plain;
  smooth.smooth = true;
  const std::uint64_t more = trace(smooth, {kTexcoords, kColors, kPropertyValues}, true);
  EXPECT_GE(more, least + 12 * kPadding);
  EXPECT_LT(more, least + 13 * kPadding);
  // The ban works: who needs normals and may not read them dies of it.
  ::testing::GTEST_FLAG(death_test_style) = "threadsafe";
  EXPECT_DEATH(trace(smooth, {kNormals}, true), "");
}

}  // namespace
}  // namespace tetfmt_test
