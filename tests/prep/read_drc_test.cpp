// SPDX-License-Identifier: AGPL-3.0-or-later
#include <draco/compression/encode.h>
#include <draco/mesh/triangle_soup_mesh_builder.h>

#include <cmath>

#include "prep/read_support.hpp"

namespace tetprep_test {
namespace {

using tetprep::ExitCode;
using tetprep::read_soup;

std::string draco_bytes(const TriangleSoup& soup) {
  draco::TriangleSoupMeshBuilder builder;
  builder.Start(static_cast<int>(soup.triangles.size()));
  const int position = builder.AddAttribute(draco::GeometryAttribute::POSITION, 3, draco::DT_FLOAT32);
  for (std::size_t t = 0; t < soup.triangles.size(); ++t) {
    std::array<std::array<float, 3>, 3> corners{};
    for (std::size_t i = 0; i < 3; ++i)
      for (std::size_t k = 0; k < 3; ++k)
        corners[i][k] = static_cast<float>(soup.points[soup.triangles[t][i]][k]);
    builder.SetAttributeValuesForFace(position, draco::FaceIndex(static_cast<std::uint32_t>(t)),
                                      corners[0].data(), corners[1].data(), corners[2].data());
  }
  const auto mesh = builder.Finalize();
  draco::Encoder encoder;
  draco::EncoderBuffer buffer;
  EXPECT_TRUE(encoder.EncodeMeshToBuffer(*mesh, &buffer).ok());
  return {buffer.data(), buffer.size()};
}

TEST_F(Read, Draco) {
  const auto soup = read_soup(write("a.drc", draco_bytes(cube({0, 0, 0}, 2))));
  EXPECT_EQ(soup.triangles.size(), 12u);
  EXPECT_EQ(soup.points.size(), 8u);
  for (const auto& point : soup.points)
    for (const double x : point) EXPECT_TRUE(x == 0 || x == 2) << x;
}

TEST_F(Read, BadDraco) {
  refuse("a.drc", "DRACO", {});
  refuse("a.drc", "something else entirely", {"Draco"});
  const std::string good = draco_bytes(ball(4));
  for (std::size_t length = 1; length < good.size(); length += 7) {
    const std::string file = write("a.drc", std::string_view(good).substr(0, length));
    EXPECT_EQ(failure_of([&] { read_soup(file); }).code(), ExitCode::invalid) << length;
  }
  for (std::size_t i = 0; i < good.size(); ++i) {  // a changed byte may decode, but not to something unsound
    std::string bad = good;
    bad[i] = static_cast<char>(bad[i] ^ 0x55);
    try {
      for (const auto& triangle : tetprep::parse_soup("a.drc", bad).triangles)
        for (const Index corner : triangle) EXPECT_LT(corner, 1u << 20);
    } catch (const tetprep::Failure&) {
    }
  }
}

/// Two triangles of a square with everything that a corner may have; lossless.
std::string draco_square() {
  draco::TriangleSoupMeshBuilder builder;
  builder.Start(2);
  const int position = builder.AddAttribute(draco::GeometryAttribute::POSITION, 3, draco::DT_FLOAT32);
  const int normal = builder.AddAttribute(draco::GeometryAttribute::NORMAL, 3, draco::DT_FLOAT32);
  const int texcoord = builder.AddAttribute(draco::GeometryAttribute::TEX_COORD, 2, draco::DT_FLOAT32);
  const int color = builder.AddAttribute(draco::GeometryAttribute::COLOR, 3, draco::DT_UINT8);
  const int weight = builder.AddAttribute(draco::GeometryAttribute::GENERIC, 1, draco::DT_INT32);
  const float points[4][3] = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
  const int faces[2][3] = {{0, 1, 2}, {0, 2, 3}};
  for (int f = 0; f < 2; ++f) {
    const draco::FaceIndex face(static_cast<std::uint32_t>(f));
    const float up[3] = {0, 0, f == 0 ? 1.f : -1.f};
    const std::uint8_t paint[3] = {255, static_cast<std::uint8_t>(51 * f), 0};
    const std::int32_t heavy = 1000000 * f - 7;
    const float *a = points[faces[f][0]], *b = points[faces[f][1]], *c = points[faces[f][2]];
    builder.SetAttributeValuesForFace(position, face, a, b, c);
    builder.SetAttributeValuesForFace(normal, face, up, up, up);
    builder.SetAttributeValuesForFace(texcoord, face, a, b, c);
    builder.SetAttributeValuesForFace(color, face, paint, paint, paint);
    builder.SetAttributeValuesForFace(weight, face, &heavy, &heavy, &heavy);
  }
  const auto mesh = builder.Finalize();
  draco::Encoder encoder;
  encoder.SetEncodingMethod(draco::MESH_SEQUENTIAL_ENCODING);
  draco::EncoderBuffer buffer;
  EXPECT_TRUE(encoder.EncodeMeshToBuffer(*mesh, &buffer).ok());
  return {buffer.data(), buffer.size()};
}

TEST_F(Read, DracoAttributes) {
  const auto soup = read_text("a.drc", draco_square());
  ASSERT_EQ(soup.triangles.size(), 2u);
  const auto& a = soup.appearance;
  ASSERT_EQ(a.corners.size(), 2u);
  ASSERT_EQ(a.properties.size(), 1u);
  EXPECT_EQ(a.properties[0].type, tetfmt::PropertyType::int32);
  for (std::size_t t = 0; t < 2; ++t) {
    const double sign = a.normals[a.corners[t][0]][2] > 0 ? 1 : -1;
    for (std::size_t k = 0; k < 3; ++k) {
      const Index at = a.corners[t][k];
      const auto& point = soup.points[soup.triangles[t][k]];
      EXPECT_EQ(a.normals[at], (std::array<float, 3>{0, 0, static_cast<float>(sign)}));
      EXPECT_EQ(a.texcoords[at],
                (std::array<float, 2>{static_cast<float>(point[0]), static_cast<float>(point[1])}));
      EXPECT_EQ(a.colors[at], (std::array<float, 4>{1, sign > 0 ? 0 : 0.2f, 0, 1}));
      EXPECT_EQ(a.properties[0].values[at], sign > 0 ? -7 : 999993);
    }
  }
  EXPECT_NE(a.normals[a.corners[0][0]], a.normals[a.corners[1][0]]);
}

TEST_F(Read, DamagedDraco) {
  expect_soundness("a.drc", draco_square());
}

}  // namespace
}  // namespace tetprep_test
