// SPDX-License-Identifier: AGPL-3.0-or-later
#include <cmath>

#include "prep/read_support.hpp"

namespace tetprep_test {
namespace {

using tetprep::kNone;
using tetprep::merge_soups;

TEST_F(Read, MergeKeepsEverythingInOrder) {
  write("a.mtl", "newmtl m\nKd 1 0 0\nnewmtl n\n");
  const std::string corners = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
  const auto plain = read_text("plain.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n");
  const auto rich = read_text(
      "rich.obj", "mtllib a.mtl\nmtllib b.mtl\n" + corners +
                      "vt 0 1\nvn 0 0 1\ng g\nusemtl n\nf 1/1/1 2/1/1 3/1/1\no o\nusemtl m\nf 1 2 3\n");
  const auto cloud =
      read_text("cloud.ply",
                "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n"
                "property float z\nproperty float heat\nproperty uchar red\nproperty uchar green\n"
                "property uchar blue\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n"
                "0 0 0 0.5 255 0 0\n1 0 0 0.5 255 0 0\n0 1 0 1.5 0 0 255\n3 0 1 2\n");
  const auto all = merge_soups({plain, rich, cloud, rich});
  EXPECT_EQ(all.points.size(), 12u);
  EXPECT_EQ(all.triangles, (Triangles{{0, 1, 2}, {3, 4, 5}, {3, 4, 5}, {6, 7, 8}, {9, 10, 11}, {9, 10, 11}}));
  EXPECT_EQ(all.warnings.size(), 2u);
  const auto& a = all.appearance;
  std::vector<std::string> names;
  for (const auto& object : a.objects) names.push_back(object.source + ":" + object.name);
  EXPECT_EQ(names, (std::vector<std::string>{"plain.off:", "rich.obj:g", "rich.obj:o/g",
                                             "cloud.ply:", "rich.obj:g", "rich.obj:o/g"}));
  EXPECT_EQ(a.triangle_object, (std::vector<Index>{0, 1, 2, 3, 4, 5}));
  std::vector<std::string> materials;
  for (const Index material : a.triangle_material) materials.push_back(a.materials.at(material).name);
  EXPECT_EQ(materials, (std::vector<std::string>{"", "n", "m", "", "n", "m"}));

  ASSERT_EQ(a.surface_points, 4u);  // one of each rich soup, two of the cloud
  EXPECT_EQ(a.corners, (Triangles{{kNone, kNone, kNone},
                                  {0, 0, 0},
                                  {kNone, kNone, kNone},
                                  {1, 1, 2},
                                  {3, 3, 3},
                                  {kNone, kNone, kNone}}));
  EXPECT_EQ(a.normals[3], (std::array<float, 3>{0, 0, 1}));
  EXPECT_TRUE(std::isnan(a.normals[1][0]));
  EXPECT_TRUE(std::isnan(a.texcoords[2][1]));
  EXPECT_EQ(a.colors[2], (std::array<float, 4>{0, 0, 1, 1}));
  EXPECT_TRUE(std::isnan(a.colors[3][3]));
  ASSERT_EQ(a.properties.size(), 1u);
  ASSERT_EQ(a.properties[0].values.size(), 4u);
  EXPECT_TRUE(std::isnan(a.properties[0].values[0]));
  EXPECT_EQ(a.properties[0].values[2], 1.5);
  EXPECT_TRUE(std::isnan(a.properties[0].values[3]));
}

TEST_F(Read, MergeOfOneIsItself) {
  const auto one = read_text("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  const auto same = merge_soups({one});
  EXPECT_EQ(same.points, one.points);
  EXPECT_EQ(same.triangles, one.triangles);
  EXPECT_TRUE(same.appearance.triangle_object.empty() && same.appearance.materials.empty());
}

TEST_F(Read, MergedPropertiesOfOneNameAreOne) {
  const auto ply = [&](const std::string& type, const std::string& value) {
    std::string rows;
    for (const char* point : {"0 0 0 ", "1 0 0 ", "0 1 0 "}) rows += point + value + "\n";
    return read_text("a.ply",
                     "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n"
                     "property float z\nproperty " +
                         type +
                         " heat\nelement face 1\n"
                         "property list uchar int vertex_indices\nend_header\n" +
                         rows + "3 0 1 2\n");
  };
  const auto all = merge_soups({ply("float", "1"), ply("float", "2"), ply("int", "3")}).appearance;
  ASSERT_EQ(all.properties.size(), 2u);
  EXPECT_EQ(all.properties[0].values[1], 2);
  EXPECT_TRUE(std::isnan(all.properties[0].values[2]));
  EXPECT_EQ(all.properties[1].values[2], 3);
}

}  // namespace
}  // namespace tetprep_test
