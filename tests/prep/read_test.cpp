// SPDX-License-Identifier: AGPL-3.0-or-later
#include <draco/compression/encode.h>
#include <draco/mesh/triangle_soup_mesh_builder.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>

#include "prep/prep_support.hpp"

namespace tetprep_test {
namespace {

using tetprep::ExitCode;
using tetprep::read_soup;
using Triangles = std::vector<std::array<Index, 3>>;
using Points = std::vector<std::array<double, 3>>;

class Read : public FolderTest {
 protected:
  /// Expects `bytes` to be refused with this code, the file's name and `parts` in the message.
  void refuse(const std::string& name, std::string_view bytes, std::vector<std::string> parts,
              ExitCode code = ExitCode::invalid) {
    const std::string file = write(name, bytes);
    const auto failure = failure_of([&] { read_soup(file); });
    EXPECT_EQ(failure.code(), code) << failure.what();
    parts.push_back(name);
    EXPECT_TRUE(mentions(failure.what(), parts));
  }
};

template <class T>
std::string raw(T value) {
  std::string bytes(sizeof value, '\0');
  std::memcpy(bytes.data(), &value, sizeof value);
  return bytes;
}

const Points kCorners{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};

TEST_F(Read, Obj) {
  const auto soup = read_soup(
      write("a.OBJ",
            "# comment\r\nmtllib x.mtl\nv 0 0 0\nv 1 0 0 1.0\nv 0 1 0 0.5 0.5 0.5\nvt 0 0\nvn 0 0 1\n"
            "g group\nusemtl m\nf 1/1/1 2/1/1 3/1/1\nf -3//1 -1//1 \\\n -2//1 # back\nl 1 2\n"));
  EXPECT_EQ(soup.points, kCorners);
  EXPECT_EQ(soup.triangles, (Triangles{{0, 1, 2}, {0, 2, 1}}));
}

TEST_F(Read, ObjKeepsEveryBit) {
  const auto soup =
      read_soup(write("a.obj", "v 0.79550933837890625 1e-3 +3.0000000000000004\nv 1 0 0\nv 0 1 0\nf 1 2 3"));
  EXPECT_EQ(soup.points[0], (std::array<double, 3>{0.79550933837890625, 1e-3, 3.0000000000000004}));
}

TEST_F(Read, ObjMayNameVerticesThatFollow) {
  EXPECT_EQ(read_soup(write("a.obj", "f 1 2 3\nv 0 0 0\nv 1 0 0\nv 0 1 0\n")).triangles,
            (Triangles{{0, 1, 2}}));
}

TEST_F(Read, BadObj) {
  const std::string corners = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
  refuse("a.obj", corners + "f 1 2 0\n", {":4:", "0"});
  refuse("a.obj", corners + "f 1 2 -4\n", {":4:", "-4"});
  refuse("a.obj", corners + "f 1 2 4\n", {":4:", "point 3", "only 3"});
  refuse("a.obj", corners + "f 1 2 4294967297\n", {":4:"});
  refuse("a.obj", corners + "f 1 2 99999999999999999999\n", {":4:"});
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

TEST_F(Read, ByteOrderMark) {
  const std::string mark = "\xEF\xBB\xBF";
  const std::vector<std::pair<std::string, std::string>> files{
      {"a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"},
      {"a.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n"},
      {"a.ply",
       "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
       "element face 1\nproperty list uchar int vertex_indices\nend_header\n"
       "0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n"},
      {"a.stl",
       "solid s\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\n"
       "endfacet\nendsolid s\n"}};
  for (const auto& [name, text] : files) {
    const auto soup = read_soup(write(name, mark + text));
    EXPECT_EQ(soup.points, kCorners) << name;
    EXPECT_EQ(soup.triangles, (Triangles{{0, 1, 2}})) << name;
  }
  refuse("a.obj", std::string("\xFF\xFEv\0 \0", 6), {"UTF-16", "save it as UTF-8"});
  refuse("a.obj", std::string("\xFE\xFF\0v\0 ", 6), {"UTF-16"});
}

TEST_F(Read, AsciiPlyNamesBadCoordinates) {
  const auto text = [](const std::string& third) {
    return "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
           "element face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n" +
           third + "\n3 0 1 2\n";
  };
  refuse("a.ply", text("0 nan 0"), {":12:", "point 2", "not a number"});
  refuse("a.ply", text("0 1 -inf"), {":12:", "point 2", "infinite"});
}

TEST_F(Read, UnusedPointsMayBeAnything) {
  EXPECT_EQ(read_soup(write("a.obj", "v nan inf 0\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 2 3 4\n")).triangles.size(),
            1u);
}

TEST_F(Read, Off) {
  const auto soup = read_soup(
      write("a.off", "OFF\n# comment\n4 2 0\n0 0 0\n1 0 0\n0 1 0\n0.1 0 1e-5\n3 0 1 2\n3 0 2 3 255 0 0\n"));
  EXPECT_EQ(soup.points[3], (std::array<double, 3>{0.1, 0, 1e-5}));
  EXPECT_EQ(soup.triangles, (Triangles{{0, 1, 2}, {0, 2, 3}}));
}

TEST_F(Read, BadOff) {
  const std::string head = "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n";
  refuse("a.off", head + "3 0 1 3\n", {":6:", "point 3", "only 3"});
  refuse("a.off", head + "3 0 1 -1\n", {":6:", "point -1"});
  refuse("a.off", head + "4 0 1 2\n", {":6:"});
  refuse("a.off", head, {"cut short"});
  refuse("a.off", "OFF\n3 1 0\n0 nan 0\n1 0 0\n0 1 0\n3 0 1 2\n", {":3:", "\"nan\""});
  refuse("a.off", "OFF\n3 1 0\n0 0\n1 0 0\n0 1 0\n3 0 1 2\n", {":3:"});
  refuse("a.off", "OFF\n4294967295 4294967295 0\n0 0 0\n", {"4294967295"});
  refuse("a.off", head + "4294967295 0 1 2\n", {":6:"});
  refuse("a.off", "OFF\n", {"a.off:1"});
  refuse("a.off", "what is this\n", {"a.off:1"});
  refuse("a.off", "OFF\n3 0 0\n0 0 0\n1 0 0\n0 1 0\n", {"without faces"});
}

const std::string kPlyVertices = "property float x\nproperty float y\nproperty float z\n";
const std::string kPlyFaces = "property list uchar int vertex_indices\nend_header\n";

std::string ply_head(const std::string& format, const std::string& vertices, const std::string& faces) {
  return "ply\nformat " + format + " 1.0\ncomment made by a test\nelement vertex " + vertices + "\n" +
         kPlyVertices + "element face " + faces + "\n" + kPlyFaces;
}

std::string binary_ply_body(bool big_endian = false) {
  std::string body;
  const auto add = [&](auto value) {
    std::string bytes = raw(value);
    if (big_endian) std::reverse(bytes.begin(), bytes.end());
    body += bytes;
  };
  for (const float x : {0.f, 0.f, 0.f, 1.f, 0.f, 0.f, 0.f, 1.f, 0.f}) add(x);
  add(std::uint8_t{3});
  for (const std::int32_t i : {0, 1, 2}) add(i);
  return body;
}

TEST_F(Read, Ply) {
  for (const std::string& text : {ply_head("ascii", "3", "1") + "0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n",
                                  ply_head("ascii", "3", "1") + "0 0 0\n1 0 0\n0 1 0\n3 0 1 2",
                                  ply_head("binary_little_endian", "3", "1") + binary_ply_body(),
                                  ply_head("binary_big_endian", "3", "1") + binary_ply_body(true)}) {
    const auto soup = read_soup(write("a.ply", text));
    EXPECT_EQ(soup.points, kCorners);
    EXPECT_EQ(soup.triangles, (Triangles{{0, 1, 2}}));
  }
}

TEST_F(Read, BadPly) {
  const std::string body = binary_ply_body();
  const std::string binary = ply_head("binary_little_endian", "3", "1") + body;
  for (std::size_t length = 1; length < binary.size(); ++length) {
    const std::string file = write("a.ply", std::string_view(binary).substr(0, length));
    EXPECT_EQ(failure_of([&] { read_soup(file); }).code(), ExitCode::invalid) << length;
  }
  refuse("a.ply", ply_head("binary_little_endian", "4294967295", "1") + body, {"4294967295", "cut short"});
  refuse("a.ply", ply_head("ascii", "4294967295", "1") + "0 0 0\n", {"4294967295", "cut short"});
  refuse("a.ply", ply_head("ascii", "3", "18446744073709551615") + "0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n",
         {"cut short"});
  refuse("a.ply", ply_head("ascii", "3", "1") + "0 0 0\n1 0 0\n0 1 0\n3 0 1 7\n", {"point 7", "only 3"});
  refuse("a.ply", ply_head("ascii", "3", "1") + "0 0 0\n1 0 0\n0 1 0\n3 0 1 -7\n", {":14:", "point -7"});
  refuse("a.ply", ply_head("ascii", "3", "1") + "0 0 0\n1 0 0\n0 what 0\n3 0 1 2\n", {});
  refuse("a.ply", ply_head("ascii", "3", "0") + "0 0 0\n1 0 0\n0 1 0\n", {"without faces"});
  std::string infinite = binary;
  infinite.replace(infinite.size() - body.size(), 4, raw(INFINITY));
  refuse("a.ply", infinite, {"infinite"});
  std::string long_list = "ply\nformat binary_little_endian 1.0\nelement vertex 3\n" + kPlyVertices +
                          "element face 1\nproperty list uint int vertex_indices\nend_header\n" + body;
  long_list.replace(long_list.size() - 13, 1, raw(std::uint32_t{0xFFFFFFF0}));
  refuse("a.ply", long_list, {"a.ply"});
}

std::string binary_stl(std::uint32_t count) {
  std::string bytes(80, ' ');
  bytes += raw(count);
  for (const float x : {0.f, 0.f, 1.f, 0.f, 0.f, 0.f, 1.f, 0.f, 0.f, 0.f, 1.f, 0.f}) bytes += raw(x);
  return bytes + raw(std::uint16_t{0});
}

const std::string kAsciiStl =
    "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 "
    "0\nendloop\nendfacet\nendsolid a\n";

TEST_F(Read, Stl) {
  std::string solid_binary = binary_stl(1);
  solid_binary.replace(0, 6, "solid ");
  for (const std::string& bytes : {binary_stl(1), solid_binary, kAsciiStl}) {
    const auto soup = read_soup(write("a.stl", bytes));
    EXPECT_EQ(soup.points, kCorners);
    EXPECT_EQ(soup.triangles, (Triangles{{0, 1, 2}}));
  }
}

TEST_F(Read, BadStl) {
  refuse("a.stl", binary_stl(2), {"promises 2", "only 1"});
  refuse("a.stl", binary_stl(0xFFFFFFFF), {"promises 4294967295"});
  refuse("a.stl", kAsciiStl.substr(0, 80), {"cut short"});
  refuse("a.stl", "solid a\nendsolid a\n", {});
  refuse("a.stl", "hello", {});
  std::string with_nan = binary_stl(1);
  with_nan.replace(80 + 4 + 12, 4, raw(NAN));
  refuse("a.stl", with_nan, {"not a number"});
}

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
    const std::string file = write("a.drc", bad);
    try {
      for (const auto& triangle : read_soup(file).triangles)
        for (const Index corner : triangle) EXPECT_LT(corner, 1u << 20);
    } catch (const tetprep::Failure&) {
    }
  }
}

TEST_F(Read, Polygons) {
  // A square, a concave quadrilateral, and a concave hexagon (an L): areas add up only without overlap.
  const std::string points = "v 0 0 0\nv 2 0 0\nv 2 2 0\nv 0 2 0\nv 0.5 0.5 0\nv 1 1 0\nv 1 2 0\nv 2 1 0\n";
  const auto area = [](const TriangleSoup& soup) {
    double sum = 0;
    for (const auto& [a, b, c] : soup.triangles) {
      const auto &p = soup.points[a], &q = soup.points[b], &r = soup.points[c];
      const double twice = (q[0] - p[0]) * (r[1] - p[1]) - (q[1] - p[1]) * (r[0] - p[0]);
      EXPECT_GE(twice, 0) << "against the polygon's orientation";
      sum += twice / 2;
    }
    return sum;
  };
  struct Case {
    const char* face;
    std::size_t triangles;
    double area;
  };
  for (const auto& [face, triangles, expected] :
       {Case{"f 1 2 3 4", 2, 4}, Case{"f 1 2 5 4", 2, 1}, Case{"f 2 5 4 1", 2, 1}, Case{"f 5 4 1 2", 2, 1},
        Case{"f 1 2 8 6 7 4", 4, 3}, Case{"f 8 6 7 4 1 2", 4, 3}}) {
    const auto soup = read_soup(write("a.obj", points + face + "\n"));
    EXPECT_EQ(soup.triangles.size(), triangles) << face;
    EXPECT_DOUBLE_EQ(area(soup), expected) << face;
  }
}

TEST_F(Read, FilesThatAreNone) {
  EXPECT_EQ(failure_of([&] { read_soup(path("missing.off")); }).code(), ExitCode::io);
  std::filesystem::create_directory(path("folder.off"));
  EXPECT_EQ(failure_of([&] { read_soup(path("folder.off")); }).code(), ExitCode::io);
  refuse("a.xyz", "0 0 0\n", {".xyz"}, ExitCode::unsupported);
  refuse("noextension", "0 0 0\n", {"extension"}, ExitCode::unsupported);
  for (const char* name : {"a.off", "a.obj", "a.ply", "a.stl", "a.drc"}) refuse(name, "", {"empty"});
}

}  // namespace
}  // namespace tetprep_test
