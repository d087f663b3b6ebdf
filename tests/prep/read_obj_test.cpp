// SPDX-License-Identifier: AGPL-3.0-or-later
#include <cmath>

#include "prep/read_mtl.hpp"
#include "prep/read_support.hpp"

namespace tetprep_test {
namespace {

using Floats2 = std::vector<std::array<float, 2>>;
using Floats3 = std::vector<std::array<float, 3>>;
using Floats4 = std::vector<std::array<float, 4>>;

const std::string kObjCorners = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";

TEST_F(Read, Obj) {
  const auto soup = read_text("a.OBJ",
                              "# comment\r\nv 0 0 0\nv 1 0 0 1.0\nv 0 1 0\nvt 0 0\nvn 0 0 1\n"
                              "g group\nf 1/1/1 2/1/1 3/1/1\nf -3//1 -1//1 \\\n -2//1 # back\nl 1 2\n");
  EXPECT_EQ(soup.points, kCorners);
  EXPECT_EQ(soup.triangles, (Triangles{{0, 1, 2}, {0, 2, 1}}));
  EXPECT_TRUE(soup.warnings.empty());
}

TEST_F(Read, ObjKeepsEveryBit) {
  const auto soup =
      read_text("a.obj", "v 0.79550933837890625 1e-3 +3.0000000000000004\nv 1 0 0\nv 0 1 0\nf 1 2 3");
  EXPECT_EQ(soup.points[0], (std::array<double, 3>{0.79550933837890625, 1e-3, 3.0000000000000004}));
}

TEST_F(Read, ObjMayNameVerticesThatFollow) {
  const auto soup = read_text("a.obj", "f 1/2/1 2/1/1 3/1/1\n" + kObjCorners + "vt .5 1\nvt 0 0\nvn 0 0 1\n");
  EXPECT_EQ(soup.triangles, (Triangles{{0, 1, 2}}));
  EXPECT_EQ(soup.appearance.texcoords, (Floats2{{0, 0}, {.5f, 1}}));
}

TEST_F(Read, ObjAttributes) {
  // A quadrilateral whose corners share a normal, and a triangle that shares an edge but nothing else.
  const auto soup = read_text("a.obj", kObjCorners +
                                           "v 1 1 0\nv 2 0 0\nvt 0 0\nvt 1 0\nvt 0 1 0.5\nvt 1 1\nvn 0 0 1\n"
                                           "vn 0.6 0 -0.8\nf 1/1/1 2/2/1 4/4/1 3/3/1\nf 2/-4/-1 5/2 4//2\n");
  const auto& a = soup.appearance;
  ASSERT_EQ(soup.triangles.size(), 3u);
  // In the order in which the corners come: four of the quadrilateral, three of the triangle.
  const float none = NAN;
  ASSERT_EQ(a.surface_points, 7u);
  EXPECT_EQ(Floats2(a.texcoords.begin(), a.texcoords.begin() + 6),
            (Floats2{{0, 0}, {1, 0}, {1, 1}, {0, 1}, {0, 0}, {1, 0}}));
  EXPECT_EQ(Floats3(a.normals.begin(), a.normals.begin() + 5),
            (Floats3{{0, 0, 1}, {0, 0, 1}, {0, 0, 1}, {0, 0, 1}, {0.6f, 0, -0.8f}}));
  EXPECT_TRUE(std::isnan(a.normals[5][0]));
  EXPECT_TRUE(std::isnan(a.texcoords[6][0]) && std::isnan(none));
  EXPECT_EQ(a.normals[6], (std::array<float, 3>{0.6f, 0, -0.8f}));
  EXPECT_EQ(a.corners.back(), (std::array<Index, 3>{4, 5, 6}));
  for (std::size_t t = 0; t < 2;
       ++t)  // each corner of the quadrilateral's triangles has its point's coordinates
    for (std::size_t k = 0; k < 3; ++k) {
      const auto& point = soup.points[soup.triangles[t][k]];
      EXPECT_EQ(a.texcoords[a.corners[t][k]],
                (std::array<float, 2>{static_cast<float>(point[0]), static_cast<float>(point[1])}));
    }
}

TEST_F(Read, ObjEqualValuesAreOneSurfacePoint) {
  const auto soup =
      read_text("a.obj", kObjCorners + "v 0 0 1\nvn 0 0 1\nvn 0 0 1\nf 1//1 2//2 3//1\nf 1//2 2//1 4//1\n");
  EXPECT_EQ(soup.appearance.surface_points, 1u);
  EXPECT_EQ(soup.appearance.corners, (Triangles{{0, 0, 0}, {0, 0, 0}}));
}

TEST_F(Read, ObjWithoutAttributesHasNone) {
  const auto soup = read_text("dir.obj", kObjCorners + "vn 0 0 1\nvt 1 1\nf 1 2 3\n");
  EXPECT_EQ(soup.appearance.surface_points, 0u);
  EXPECT_TRUE(soup.appearance.corners.empty() && soup.appearance.normals.empty());
  ASSERT_EQ(soup.appearance.objects.size(), 1u);
  EXPECT_EQ(soup.appearance.objects[0].source, "dir.obj");
  EXPECT_EQ(soup.appearance.objects[0].name, "");
  EXPECT_TRUE(soup.appearance.materials.empty());
}

TEST_F(Read, ObjVertexColors) {
  const auto soup = read_text("a.obj", "v 0 0 0 1 0 0.5\nv 1 0 0 0 1 0 0.25\nv 0 1 0\nf 1 2 3\n");
  ASSERT_EQ(soup.appearance.colors.size(), 2u);
  EXPECT_EQ(soup.appearance.colors, (Floats4{{1, 0, 0.5f, 1}, {0, 1, 0, 0.25f}}));
  EXPECT_EQ(soup.appearance.corners, (Triangles{{0, 1, tetprep::kNone}}));
  const auto bytes = read_text("b.obj", "v 0 0 0 255 0 51\nv 1 0 0 0 0 0\nv 0 1 0 0 0 0\nf 1 2 3\n");
  EXPECT_EQ(bytes.appearance.colors[0], (std::array<float, 4>{1, 0, 0.2f, 1}));
  EXPECT_EQ(bytes.warnings.size(), 1u);
}

TEST_F(Read, ObjObjectsAndGroups) {
  const auto soup = read_text("a.obj", kObjCorners +
                                           "f 1 2 3\no box\nf 1 2 3\ng left side\nf 1 2 3\no lid\nf 1 2 3\n"
                                           "g unused\no box\ng left side\nf 1 2 3\ng\nf 1 2 3\n");
  std::vector<std::string> names;
  for (const auto& object : soup.appearance.objects) names.push_back(object.name);
  EXPECT_EQ(names, (std::vector<std::string>{"", "box", "box/left side", "lid/left side"}));
  EXPECT_EQ(soup.appearance.triangle_object, (std::vector<Index>{0, 1, 2, 3, 2, 1}));
}

TEST_F(Read, ObjMaterials) {
  write(
      "my file.mtl",
      "# made by hand\nnewmtl red\nKd 0.5 0.25 0.125\nKe 1 2 3\nd 0.5\nTr 0.9\nPr 0.3\nPm 1\nNi 1.45\nNs "
      "100\nKa 1 1 1\n"
      "map_Kd -s 1 1 1 -clamp on red wall.png\nnewmtl shiny\nKd 1\nNs 14\nTr 0.25\nTf 0.5 0.5 0.8\nillum 6\n"
      "newmtl opaque\nTf 1 1 1\nillum 2\n");
  write("red wall.png", "");
  const auto soup =
      read_text("a.obj", "mtllib my file.mtl\n" + kObjCorners +
                             "f 1 2 3\nusemtl shiny\nf 1 2 3\nusemtl red\nf 1 2 3\nusemtl opaque\nf 1 2 3\n");
  EXPECT_TRUE(soup.warnings.empty()) << soup.warnings.front();
  const auto& materials = soup.appearance.materials;
  ASSERT_EQ(materials.size(), 4u);
  EXPECT_EQ(soup.appearance.triangle_material, (std::vector<Index>{3, 0, 1, 2}));
  EXPECT_EQ(materials[0].name, "shiny");
  EXPECT_EQ(materials[0].values.base_color, (std::array<float, 4>{1, 1, 1, 0.75f}));
  EXPECT_FLOAT_EQ(materials[0].values.roughness, std::sqrt(std::sqrt(0.125f)));
  EXPECT_FLOAT_EQ(materials[0].values.transmission, 0.6f);
  EXPECT_EQ(materials[1].name, "red");
  EXPECT_EQ(materials[1].values.base_color, (std::array<float, 4>{0.5f, 0.25f, 0.125f, 0.5f}));
  EXPECT_EQ(materials[1].values.emission, (std::array<float, 3>{1, 2, 3}));
  EXPECT_EQ(materials[1].values.roughness, 0.3f);
  EXPECT_EQ(materials[1].values.metallic, 1);
  EXPECT_EQ(materials[1].values.ior, 1.45f);
  EXPECT_EQ(materials[1].base_color_texture, "red wall.png");
  EXPECT_EQ(materials[2].values.transmission, 0);
  EXPECT_EQ(materials[3].name, "");
}

TEST_F(Read, ObjMaterialsAreNeverAnError) {
  const auto warnings_of = [&](const std::string& mtl, const std::string& statements) {
    write("a.mtl", mtl);
    const auto soup = read_text("a.obj", statements + kObjCorners + "usemtl m\nf 1 2 3\n");
    EXPECT_EQ(soup.appearance.materials.size(), 1u);
    EXPECT_EQ(soup.appearance.materials[0].name, "m");
    std::string all;
    for (const auto& warning : soup.warnings) all += warning + "\n";
    return all;
  };
  EXPECT_TRUE(
      mentions(warnings_of("", "mtllib missing.mtl\n"), {"a.obj:1:", "missing.mtl", "a.obj:5:", "\"m\""}));
  EXPECT_TRUE(mentions(warnings_of("", "mtllib ../x.mtl\n"), {"a.obj:1:", "outside"}));
  EXPECT_TRUE(mentions(warnings_of("", "mtllib /etc/passwd\n"), {"a.obj:1:", "outside"}));
  EXPECT_TRUE(mentions(warnings_of("", "mtllib\n"), {"a.obj:1:"}));
  const std::string use = "mtllib a.mtl\n";
  EXPECT_TRUE(mentions(warnings_of("newmtl m\nKd 1 x 0\n", use), {"a.mtl:2:", "\"x\""}));
  EXPECT_TRUE(mentions(warnings_of("newmtl m\nKd 1 0\n", use), {"a.mtl:2:", "has 2"}));
  EXPECT_TRUE(mentions(warnings_of("newmtl m\nKd 2 0 nan\n", use), {"a.mtl:2:", "out of range", "\"nan\""}));
  EXPECT_TRUE(mentions(warnings_of("newmtl m\nKd spectral x.rfl\n", use), {"a.mtl:2:", "spectral"}));
  EXPECT_TRUE(mentions(warnings_of("newmtl m\nd\nNs\nPr -1\n", use), {"a.mtl:2:", "a.mtl:3:", "a.mtl:4:"}));
  EXPECT_TRUE(
      mentions(warnings_of("Kd 1 1 1\nnewmtl m\nwhat 3\n", use), {"a.mtl:1:", "a.mtl:3:", "\"what\""}));
  EXPECT_TRUE(mentions(warnings_of("newmtl m\nnewmtl m\n", use), {"a.mtl:2:", "second time"}));
  EXPECT_TRUE(
      mentions(warnings_of("newmtl m\nmap_Kd gone.png\n", use), {"a.mtl:2:", "gone.png", "not there"}));
  EXPECT_TRUE(mentions(warnings_of("newmtl m\nmap_Kd ../up.png\n", use), {"a.mtl:2:", "outside"}));
  EXPECT_TRUE(mentions(warnings_of("newmtl m\nmap_Kd C:\\t\\up.png\n", use), {"a.mtl:2:", "outside"}));
  EXPECT_TRUE(mentions(warnings_of("newmtl m\nmap_Kd\nmap_Bump b.png\n", use), {"a.mtl:2:", "map_Bump"}));
  std::string many = "newmtl m\n";
  for (int i = 0; i < 1000; ++i) many += "Kd x\n";
  EXPECT_TRUE(mentions(warnings_of(many, use), {"980 more"}));
  std::string noise;
  for (int i = 0; i < 4000; ++i) noise += static_cast<char>(i * 7919 >> 3);
  warnings_of(noise, use + "mtllib a.obj\n");
}

TEST_F(Read, BadObj) {
  const std::string& corners = kObjCorners;
  refuse("a.obj", corners + "f 1 2 0\n", {":4:", "0"});
  refuse("a.obj", corners + "f 1 2 -4\n", {":4:", "-4"});
  refuse("a.obj", corners + "f 1 2 4\n", {":4:", "point 3", "only 3"});
  refuse("a.obj", corners + "f 1 2 4294967297\n", {":4:"});
  refuse("a.obj", corners + "f 1 2 99999999999999999999\n", {":4:"});
  refuse("a.obj", corners + "f 1 2 -9223372036854775808\n", {":4:"});
  refuse("a.obj", corners + "f 1 2\n", {":4:", "2 corners"});
  refuse("a.obj", corners + "f 1 2 x\n", {":4:", "\"x\""});
  refuse("a.obj", "v 0 0\n" + corners + "f 1 2 3\n", {":1:", "three"});
  refuse("a.obj", "v 0 0 zero\n" + corners + "f 1 2 3\n", {":1:", "\"zero\""});
  refuse("a.obj", "v 0 nan 0\n" + corners + "f 1 2 3\n", {":1:", "not a number"});
  refuse("a.obj", corners + "v 0 -inf 0\nf 1 2 4\n", {":4:", "infinite"});
  refuse("a.obj", corners, {"without faces"});
  refuse("a.obj", "hello\nworld\n", {"no mesh"});
  refuse("a.obj", "", {"empty"});
}

TEST_F(Read, BadObjAttributes) {
  const std::string start = kObjCorners + "vt 0 0\nvn 0 0 1\n";
  refuse("a.obj", start + "f 1/1 2/2 3/1\n", {":6:", "texture coordinate index 2", "only 1"});
  refuse("a.obj", start + "f 1/1 2/-2 3/1\n", {":6:", "texture coordinate index -2"});
  refuse("a.obj", start + "f 1/0 2/1 3/1\n", {":6:", "texture coordinate index 0"});
  refuse("a.obj", start + "f 1//1 2//1 3//7\n", {":6:", "normal index 7", "only 1"});
  refuse("a.obj", start + "f 1//1 2//1 3//-7\n", {":6:", "normal index -7"});
  refuse("a.obj", start + "f 1//1 2//1 3//4294967296\n", {":6:", "normal"});
  refuse("a.obj", start + "f 1/x 2/1 3/1\n", {":6:", "\"1/x\""});
  refuse("a.obj", start + "f 1/1/1/1 2 3\n", {":6:", "\"1/1/1/1\""});
  refuse("a.obj", start + "f 1/1 2/1 3/1\nf 1/1 2/9 3/1\n", {":7:", "index 9"});
  refuse("a.obj", "vt\n" + start + "f 1 2 3\n", {":1:"});
  refuse("a.obj", "vt x\n" + start + "f 1 2 3\n", {":1:", "\"x\""});
  refuse("a.obj", "vn 0 1\n" + start + "f 1 2 3\n", {":1:", "three"});
}

TEST_F(Read, DamagedObj) {
  write("a.mtl", "newmtl m\nKd 1 0 0\n");
  const std::string good =
      "mtllib a.mtl\no box\nv 0 0 0 1 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 0\nvt 1 1\nvn 0 0 1\ng "
      "side\nusemtl m\n"
      "f 1/1/1 2/2/1 3/1/1 4/2/1\nf -4/-1 -3/-2 -1/1\n";
  expect_soundness(path("a.obj"), good);
}

TEST_F(Read, DamagedMtl) {
  const std::string good =
      "newmtl m\nKd 1 0 0\nmap_Kd -o 1 2 x.png\nTr .5\nNs 10\nKe 1 2 3\nNi 2\nPm 1\nTf 1 1 1\nillum 4\n";
  expect_soundness(
      [&](std::string_view bytes) {
        tetprep::MaterialLibrary library;
        tetprep::Warnings warnings("a.mtl");
        tetprep::read_mtl("a.mtl", bytes, library, warnings);
        for (const auto& [name, material] : library) {
          const tetfmt::Material& values = material.values;
          for (const float x : values.base_color) EXPECT_TRUE(x >= 0 && x <= 1) << x;
          for (const float x : values.emission) EXPECT_TRUE(x >= 0 && std::isfinite(x)) << x;
          for (const float x : {values.metallic, values.roughness, values.transmission})
            EXPECT_TRUE(x >= 0 && x <= 1) << x;
          EXPECT_TRUE(values.ior > 0 && std::isfinite(values.ior)) << values.ior;
        }
        return tetprep::parse_soup("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
      },
      good);
}

}  // namespace
}  // namespace tetprep_test
