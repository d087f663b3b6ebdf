// SPDX-License-Identifier: AGPL-3.0-or-later
#include <algorithm>
#include <cmath>

#include "prep/read_support.hpp"

namespace tetprep_test {
namespace {

using tetfmt::PropertyType;

const std::string kPlyVertices = "property float x\nproperty float y\nproperty float z\n";
const std::string kPlyFaces = "property list uchar int vertex_indices\nend_header\n";

std::string ply_head(const std::string& format, const std::string& vertices, const std::string& faces) {
  return "ply\nformat " + format + " 1.0\ncomment made by a test\nelement vertex " + vertices + "\n" +
         kPlyVertices + "element face " + faces + "\n" + kPlyFaces;
}

/// Values one after the other, in either byte order.
class Body {
 public:
  explicit Body(bool big_endian) : big_endian_(big_endian) {}
  template <class T>
  Body& add(T value) {
    std::string bytes = raw(value);
    if (big_endian_) std::reverse(bytes.begin(), bytes.end());
    text += bytes;
    return *this;
  }
  std::string text;

 private:
  bool big_endian_;
};

std::string binary_ply_body(bool big_endian = false) {
  Body body(big_endian);
  for (const float x : {0.f, 0.f, 0.f, 1.f, 0.f, 0.f, 0.f, 1.f, 0.f}) body.add(x);
  body.add(std::uint8_t{3});
  for (const std::int32_t i : {0, 1, 2}) body.add(i);
  return body.text;
}

TEST_F(Read, Ply) {
  for (const std::string& text : {ply_head("ascii", "3", "1") + "0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n",
                                  ply_head("ascii", "3", "1") + "0 0 0\n1 0 0\n0 1 0\n3 0 1 2",
                                  ply_head("ascii", "3", "1") + "0 0 0\r\n1 0 0\r\n0 1 0\r\n3 0 1 2\r\n",
                                  ply_head("binary_little_endian", "3", "1") + binary_ply_body(),
                                  ply_head("binary_big_endian", "3", "1") + binary_ply_body(true)}) {
    const auto soup = read_text("a.ply", text);
    EXPECT_EQ(soup.points, kCorners);
    EXPECT_EQ(soup.triangles, (Triangles{{0, 1, 2}}));
    EXPECT_TRUE(soup.warnings.empty());
  }
}

/// A file with everything in it, in any format: three vertices and a triangle between other elements.
std::string full_ply(const std::string& format) {
  std::string text =
      "ply\nformat " + format +
      " 1.0\nelement camera 2\nproperty float focus\nproperty list uchar short lens\nelement vertex 4\n"
      "property double x\nproperty double y\nproperty double z\nproperty float nx\nproperty float ny\n"
      "property float nz\nproperty uchar red\nproperty uchar green\nproperty uchar blue\n"
      "property uchar alpha\nproperty float s\nproperty float t\nproperty double quality\n"
      "property uint id\nproperty list uchar int neighbors\nproperty char sign\n"
      "element face 1\nproperty uchar flags\nproperty list uchar uint vertex_index\n"
      "property list uchar float extra\nelement edge 1\nproperty int a\nproperty int b\nend_header\n";
  if (format == "ascii") {
    return text +
           "1.5 2 7 8\n2.5 0\n"
           "0.1 0 0 0 0 1 255 0 51 255 0 0 1e-300 4294967295 0 -128\n"
           "1 0 0 0 0 1 255 0 51 255 0 0 1e-300 4294967295 1 3 -128\n"
           "0 1 0 1 0 0 0 255 0 0 0.5 1 2.5 7 2 3 4 127\n"
           "9 9 9 0 0 0 0 0 0 0 0 0 0 0 0 0\n"
           "1 3 0 1 2 2 0.5 0.5\n1 2\n";
  }
  Body body(format == "binary_big_endian");
  using u8 = std::uint8_t;
  using i16 = std::int16_t;
  body.add(1.5f).add(u8{2}).add(i16{7}).add(i16{8}).add(2.5f).add(u8{0});
  const auto vertex = [&](double x, double y, float nx, float nz, u8 red, u8 green, u8 blue, u8 alpha,
                          float s, float t, double quality, std::uint32_t id, int neighbors,
                          std::int8_t sign) {
    body.add(x).add(y).add(0.0).add(nx).add(0.f).add(nz).add(red).add(green).add(blue).add(alpha).add(s).add(
        t);
    body.add(quality).add(id).add(static_cast<u8>(neighbors));
    for (int i = 0; i < neighbors; ++i) body.add(std::int32_t{i});
    body.add(sign);
  };
  vertex(0.1, 0, 0, 1, 255, 0, 51, 255, 0, 0, 1e-300, 4294967295u, 0, -128);
  vertex(1, 0, 0, 1, 255, 0, 51, 255, 0, 0, 1e-300, 4294967295u, 1, -128);
  vertex(0, 1, 1, 0, 0, 255, 0, 0, 0.5f, 1, 2.5, 7, 2, 127);
  vertex(9, 9, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0);
  body.add(u8{1}).add(u8{3}).add(std::uint32_t{0}).add(std::uint32_t{1}).add(std::uint32_t{2});
  body.add(u8{2}).add(0.5f).add(0.5f).add(std::int32_t{1}).add(std::int32_t{2});
  return text + body.text;
}

const std::vector<std::string> kFormats{"ascii", "binary_little_endian", "binary_big_endian"};

TEST_F(Read, PlyAttributes) {
  for (const std::string& format : kFormats) {
    const auto soup = read_text("a.ply", full_ply(format));
    EXPECT_EQ(soup.points[0], (std::array<double, 3>{0.1, 0, 0})) << format;
    EXPECT_EQ(soup.triangles, (Triangles{{0, 1, 2}}));
    const auto& a = soup.appearance;
    // The first two vertices agree in all but their place; the last is not used.
    ASSERT_EQ(a.surface_points, 2u) << format;
    EXPECT_EQ(a.corners, (Triangles{{0, 0, 1}}));
    EXPECT_EQ(a.normals, (std::vector<std::array<float, 3>>{{0, 0, 1}, {1, 0, 0}}));
    EXPECT_EQ(a.colors, (std::vector<std::array<float, 4>>{{1, 0, 0.2f, 1}, {0, 1, 0, 0}}));
    EXPECT_EQ(a.texcoords, (std::vector<std::array<float, 2>>{{0, 0}, {0.5f, 1}}));
    ASSERT_EQ(a.properties.size(), 3u);
    EXPECT_EQ(a.properties[0].name, "quality");
    EXPECT_EQ(a.properties[0].type, PropertyType::float64);
    EXPECT_EQ(a.properties[0].values, (std::vector<double>{1e-300, 2.5}));
    EXPECT_EQ(a.properties[1].name, "id");
    EXPECT_EQ(a.properties[1].type, PropertyType::uint32);
    EXPECT_EQ(a.properties[1].values, (std::vector<double>{4294967295.0, 7}));
    EXPECT_EQ(a.properties[2].name, "sign");
    EXPECT_EQ(a.properties[2].type, PropertyType::int8);
    EXPECT_EQ(a.properties[2].values, (std::vector<double>{-128, 127}));
    ASSERT_EQ(soup.warnings.size(), 1u);
    EXPECT_TRUE(mentions(soup.warnings[0], {"a.ply:", "\"neighbors\"", "list"}));
  }
}

TEST_F(Read, PlyColorTypes) {
  for (const auto& [type, red, expected] :
       {std::tuple{"uchar", "51", 0.2f}, {"ushort", "13107", 0.2f}, {"float", "0.2", 0.2f}}) {
    const std::string t = type;
    const auto soup = read_text("a.ply", "ply\nformat ascii 1.0\nelement vertex 3\n" + kPlyVertices +
                                             "property " + t + " red\nproperty " + t + " green\nproperty " +
                                             t + " blue\nelement face 1\n" + kPlyFaces + "0 0 0 " + red +
                                             " 0 0\n1 0 0 " + red + " 0 0\n0 1 0 " + red + " 0 0\n3 0 1 2\n");
    EXPECT_EQ(soup.appearance.colors, (std::vector<std::array<float, 4>>{{expected, 0, 0, 1}})) << type;
    EXPECT_TRUE(soup.appearance.properties.empty());
  }
}

TEST_F(Read, PlyFacesMayHaveColorsAndTextureCoordinates) {
  const auto soup = read_text(
      "a.ply",
      "ply\nformat ascii 1.0\ncomment TextureFile a b.png\ncomment TextureFile c.png\nelement vertex 4\n" +
          kPlyVertices +
          "element face 2\nproperty list uchar int vertex_indices\nproperty list uchar float texcoord\n"
          "property int texnumber\nproperty uchar red\nproperty uchar green\nproperty uchar blue\n"
          "end_header\n0 0 0\n1 0 0\n0 1 0\n1 1 0\n3 0 1 2 6 0 0 1 0 0 1 1 255 0 0\n"
          "3 1 3 2 0 -1 0 0 0\n");
  const auto& a = soup.appearance;
  ASSERT_EQ(a.surface_points, 4u);
  EXPECT_EQ(a.corners, (Triangles{{0, 1, 2}, {3, 3, 3}}));
  EXPECT_EQ(a.texcoords[1], (std::array<float, 2>{1, 0}));
  EXPECT_TRUE(std::isnan(a.texcoords[3][0]));
  EXPECT_EQ(a.colors[0], (std::array<float, 4>{1, 0, 0, 1}));
  EXPECT_EQ(a.colors[3], (std::array<float, 4>{0, 0, 0, 1}));
  ASSERT_EQ(a.materials.size(), 3u);
  EXPECT_EQ(a.materials[1].base_color_texture, "c.png");
  EXPECT_EQ(a.triangle_material, (std::vector<Index>{1, 2}));
  EXPECT_EQ(soup.warnings.size(), 2u);
}

TEST_F(Read, AsciiPlyNamesBadCoordinates) {
  const auto text = [](const std::string& third) {
    return ply_head("ascii", "3", "1") + "0 0 0\n1 0 0\n" + third + "\n3 0 1 2\n";
  };
  refuse("a.ply", text("0 nan 0"), {":13:", "point 2", "not a number"});
  refuse("a.ply", text("0 1 -inf"), {":13:", "point 2", "infinite"});
  refuse("a.ply", text("0 what 0"), {":13:", "vertex 2", "\"what\""});
  refuse("a.ply", text("0 1"), {":13:", "vertex 2", "too early"});
  refuse("a.ply", text("0 1 0 4"), {":13:", "vertex 2", "\"4\""});
}

TEST_F(Read, BadPly) {
  const std::string body = binary_ply_body();
  const std::string binary = ply_head("binary_little_endian", "3", "1") + body;
  for (std::size_t length = 1; length < binary.size(); ++length) {
    const std::string file = write("a.ply", std::string_view(binary).substr(0, length));
    EXPECT_EQ(failure_of([&] { tetprep::read_soup(file); }).code(), tetprep::ExitCode::invalid) << length;
  }
  refuse("a.ply", ply_head("binary_little_endian", "4294967295", "1") + body, {"4294967295", "cut short"});
  refuse("a.ply", ply_head("ascii", "4294967295", "1") + "0 0 0\n", {"4294967295", "cut short"});
  refuse("a.ply", ply_head("ascii", "3", "18446744073709551615") + "0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n",
         {"cut short"});
  refuse("a.ply", ply_head("ascii", "3", "1") + "0 0 0\n1 0 0\n0 1 0\n3 0 1 7\n", {"point 7", "only 3"});
  refuse("a.ply", ply_head("ascii", "3", "1") + "0 0 0\n1 0 0\n0 1 0\n3 0 1 -7\n", {":14:", "point -7"});
  refuse("a.ply", ply_head("ascii", "3", "1") + "0 0 0\n1 0 0\n0 1 0\n-3 0 1 2\n", {":14:", "-3"});
  refuse("a.ply", ply_head("ascii", "3", "1") + "0 0 0\n1 0 0\n0 1 0\n3 0 1 2.5\n", {":14:", "\"2.5\""});
  refuse("a.ply", ply_head("ascii", "3", "0") + "0 0 0\n1 0 0\n0 1 0\n", {"without faces"});
  refuse("a.ply", ply_head("binary_middle_endian", "3", "1") + body, {":2:", "binary_middle_endian"});
  std::string infinite = binary;
  infinite.replace(infinite.size() - body.size(), 4, raw(INFINITY));
  refuse("a.ply", infinite, {"infinite"});
  std::string long_list = "ply\nformat binary_little_endian 1.0\nelement vertex 3\n" + kPlyVertices +
                          "element face 1\nproperty list uint int vertex_indices\nend_header\n" + body;
  long_list.replace(long_list.size() - 13, 1, raw(std::uint32_t{0xFFFFFFF0}));
  refuse("a.ply", long_list, {"face 0", "cut short"});
}

TEST_F(Read, BadPlyHeaders) {
  const std::string start = "ply\nformat ascii 1.0\n", vertex = "element vertex 3\n" + kPlyVertices;
  const std::string body = "0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n";
  refuse("a.ply", "ply\n" + vertex + "element face 1\n" + kPlyFaces + body, {"no format"});
  refuse("a.ply", start + "property float x\n" + vertex + kPlyFaces, {":3:", "before the first element"});
  refuse("a.ply", start + "element vertex\n", {":3:"});
  refuse("a.ply", start + "element vertex 3\nproperty real x\n", {":4:", "\"real\""});
  refuse("a.ply", start + "element vertex 3\nproperty float\n", {":4:", "without a name"});
  refuse("a.ply", start + vertex + "property float x\n", {":7:", "\"x\"", "twice"});
  refuse("a.ply", start + "element vertex 3\nproperty list float int v\n", {":4:", "whole type"});
  refuse("a.ply",
         start + "element vertex 3\nproperty float x\nproperty float y\nelement face 1\n" + kPlyFaces + body,
         {"without x, y and z"});
  refuse("a.ply", start + vertex + "element face 1\nproperty int vertex_indices\nend_header\n" + body,
         {"vertex_indices"});
  refuse("a.ply", start + vertex + "element tristrips 1\n" + kPlyFaces + body, {"tristrips"},
         tetprep::ExitCode::unsupported);
  refuse("a.ply",
         start + "element face 1\nproperty list uchar int vertex_indices\n" + vertex + "end_header\n" + body,
         {"before the vertices"}, tetprep::ExitCode::unsupported);
  std::string wide = start + "element vertex 3\n";
  for (int i = 0; i < 300; ++i) wide += "property uchar p" + std::to_string(i) + "\n";
  refuse("a.ply", wide, {"256"});
}

TEST_F(Read, DamagedPly) {
  for (const std::string& format : kFormats) expect_soundness("a.ply", full_ply(format));
}

}  // namespace
}  // namespace tetprep_test
