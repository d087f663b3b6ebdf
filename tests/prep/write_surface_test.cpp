// SPDX-License-Identifier: AGPL-3.0-or-later
// Extracted surfaces as mesh files, read again by the converter's own readers.
#include <cmath>
#include <limits>

#include "prep/prep_support.hpp"
#include "surface/write_surface.hpp"

namespace tetprep_test {
namespace {

using tetfmt::PropertyType;
using tetprep::Appearance;
using tetprep::kNone;
using tetprep::SurfaceMesh;

constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();

/// Twelve triangles that share seven surface points.
SurfaceMesh dressed_ball() {
  SurfaceMesh mesh;
  const TriangleSoup soup = ball(1);
  mesh.points = soup.points;
  mesh.triangles = soup.triangles;
  mesh.input_triangle_count = 12;
  Appearance& look = mesh.appearance;
  look.materials.resize(3);
  look.materials[0].name = "bronze";
  look.materials[0].values.base_color = {0.1f, 0.2f, 0.3f, 0.5f};
  look.materials[0].values.metallic = 0.2f;
  look.materials[1].name = "bronze";  // twice on purpose
  look.materials[1].base_color_texture = "textures/wood grain.png";
  look.materials[1].values.emission = {10, 0, 2};
  look.materials[2].name = "glass # 3";
  look.materials[2].values.ior = 1.33f;
  look.materials[2].values.transmission = 0.75f;
  look.materials[2].values.roughness = 0.1f;
  look.objects = {{"left", "a.obj"}, {"bronze", "a.obj"}, {"", "b.glb"}};
  look.surface_points = 7;
  for (Index i = 0; i < 12; ++i) {
    mesh.input_triangle.push_back(i);
    look.triangle_material.push_back(i % 3);
    look.triangle_object.push_back(i / 4);
    look.corners.push_back({i % 7, (i + 1) % 7, (3 * i) % 7});
  }
  for (int i = 0; i < 7; ++i) {
    const float x = static_cast<float>(i);
    look.normals.push_back({1 / (x + 3), -x, 1e-8f});
    look.texcoords.push_back({x / 3, -40 * x});
    look.colors.push_back({x / 255, 1, 0, 254.0f / 255});
  }
  look.properties = {{"quality", PropertyType::float32, {0, 0.5, -1e30f, 4, 5, 0.25, 7}},
                     {"id", PropertyType::uint32, {0, 1, 2, 3, 4, 4294967295.0, 6}},
                     {"flags", PropertyType::uint8, {0, 255, 2, 3, 4, 5, 6}},
                     {"exact", PropertyType::float64, {0.1, 0.2, 1e300, -0.0, 1.0 / 3, 5, 6}}};
  return mesh;
}

/// The values at a triangle's corner, all NaN where there are none.
template <std::size_t N>
std::array<float, N> at(const std::vector<std::array<float, N>>& values, const Appearance& look,
                        std::size_t triangle, std::size_t corner) {
  std::array<float, N> value{};
  value.fill(kNaN);
  if (values.empty() || look.corners.empty()) return value;
  const Index point = look.corners[triangle][corner];
  return point == kNone ? value : values[point];
}

bool same(double a, double b) {
  return a == b || (std::isnan(a) && std::isnan(b));
}

template <std::size_t N>
bool same(const std::array<float, N>& a, const std::array<float, N>& b) {
  for (std::size_t k = 0; k < N; ++k)
    if (!same(static_cast<double>(a[k]), static_cast<double>(b[k]))) return false;
  return true;
}

void expect_same_surface(const SurfaceMesh& mesh, const TriangleSoup& soup) {
  ASSERT_EQ(soup.triangles.size(), mesh.triangles.size());
  const Appearance &a = mesh.appearance, &b = soup.appearance;
  for (std::size_t i = 0; i < soup.triangles.size(); ++i) {
    for (std::size_t k = 0; k < 3; ++k) {
      EXPECT_EQ(soup.points[soup.triangles[i][k]], mesh.points[mesh.triangles[i][k]]);
      EXPECT_TRUE(same(at(a.normals, a, i, k), at(b.normals, b, i, k))) << i;
      EXPECT_TRUE(same(at(a.texcoords, a, i, k), at(b.texcoords, b, i, k))) << i;
    }
  }
}

class WriteSurface : public FolderTest {
 protected:
  TriangleSoup through(const std::string& name, const SurfaceMesh& mesh, bool ascii = false) {
    losses_ = tetprep::make_surface_writer(path(name), {ascii, false})->write(mesh);
    return tetprep::read_soup(path(name));
  }

  std::vector<std::string> losses_;
};

void expect_ply_values(const Appearance& look, const Appearance& back) {
  ASSERT_EQ(back.properties.size(), look.properties.size());
  for (std::size_t n = 0; n < look.properties.size(); ++n)
    EXPECT_EQ(back.properties[n].name, look.properties[n].name);
  for (std::size_t i = 0; i < 12; ++i) {
    for (std::size_t k = 0; k < 3; ++k) {
      EXPECT_TRUE(same(at(look.colors, look, i, k), at(back.colors, back, i, k))) << i;
      const Index p = look.corners[i][k], q = back.corners[i][k];
      if (p == kNone) continue;
      for (std::size_t n = 0; n < look.properties.size(); ++n)
        EXPECT_TRUE(same(look.properties[n].values[p], back.properties[n].values[q])) << n;
    }
  }
}

TEST_F(WriteSurface, PlyComesBackBitForBit) {
  SurfaceMesh mesh = dressed_ball();
  for (const bool ascii : {false, true}) {
    const TriangleSoup soup = through("a.ply", mesh, ascii);
    EXPECT_TRUE(losses_.empty());
    expect_same_surface(mesh, soup);
    expect_ply_values(mesh.appearance, soup.appearance);
    for (std::size_t n = 0; n < mesh.appearance.properties.size(); ++n)
      EXPECT_EQ(soup.appearance.properties[n].type, mesh.appearance.properties[n].type);
    // PLY names the textures of materials, no more.
    for (std::size_t i = 0; i < 12; ++i)
      EXPECT_EQ(soup.appearance.materials[soup.appearance.triangle_material[i]].base_color_texture,
                i % 3 == 1 ? "textures/wood grain.png" : "");
  }
}

TEST_F(WriteSurface, PlyComesBackWithWhatIsMissing) {
  SurfaceMesh mesh = dressed_ball();
  Appearance& look = mesh.appearance;
  look.corners[4][0] = kNone;
  look.normals[3] = {kNaN, kNaN, kNaN};
  look.texcoords[6] = {kNaN, kNaN};
  look.colors[1][0] = 0.3f;
  look.properties[0].values[5] = std::numeric_limits<double>::quiet_NaN();
  for (const bool ascii : {false, true}) {
    const TriangleSoup soup = through("a.ply", mesh, ascii);
    expect_same_surface(mesh, soup);
    expect_ply_values(look, soup.appearance);
  }
}

TEST_F(WriteSurface, ObjComesBackWithMaterialsAndObjects) {
  const SurfaceMesh mesh = dressed_ball();
  const Appearance& look = mesh.appearance;
  const TriangleSoup soup = through("a.obj", mesh);
  EXPECT_EQ(losses_.size(), 2u);  // properties, opacity
  expect_same_surface(mesh, soup);
  const Appearance& back = soup.appearance;
  ASSERT_EQ(back.materials.size(), 3u);
  const std::array<std::string, 3> names = {"bronze", "bronze_2", "glass _ 3"};
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_EQ(back.materials[i].name, names[i]);
    EXPECT_EQ(back.materials[i].base_color_texture, look.materials[i].base_color_texture);
    const tetfmt::Material &a = look.materials[i].values, &b = back.materials[i].values;
    EXPECT_EQ(a.base_color, b.base_color);
    EXPECT_EQ(a.emission, b.emission);
    EXPECT_EQ(a.metallic, b.metallic);
    EXPECT_EQ(a.roughness, b.roughness);
    EXPECT_EQ(a.ior, b.ior);
    EXPECT_EQ(a.transmission, b.transmission);
  }
  EXPECT_EQ(back.triangle_material, look.triangle_material);
  ASSERT_EQ(back.objects.size(), 3u);
  EXPECT_EQ(back.objects[0].name, "left");
  EXPECT_EQ(back.objects[1].name, "bronze");
  EXPECT_EQ(back.objects[2].name, "b.glb");  // which has no name of its own
  EXPECT_EQ(back.triangle_object, look.triangle_object);
  for (std::size_t i = 0; i < 12; ++i) {
    for (std::size_t k = 0; k < 3; ++k) {
      auto color = at(look.colors, look, i, k);
      color[3] = 1;  // OBJ has no opacity there
      EXPECT_TRUE(same(color, at(back.colors, back, i, k)));
    }
  }
}

TEST_F(WriteSurface, WritesNothingThatItCannotFinish) {
  const SurfaceMesh mesh = dressed_ball();
  write("old.obj", "old");
  std::filesystem::create_directory(path("old.mtl"));
  const auto failure = failure_of([&] { tetprep::make_surface_writer(path("old.obj"), {})->write(mesh); });
  EXPECT_EQ(failure.code(), tetprep::ExitCode::io);
  EXPECT_EQ(read("old.obj"), "old");
  EXPECT_EQ(listing(), (std::vector<std::string>{"old.mtl", "old.obj"}));
}

}  // namespace
}  // namespace tetprep_test
