// SPDX-License-Identifier: AGPL-3.0-or-later
// What all formats share; OFF and STL.
#include <algorithm>
#include <cmath>
#include <functional>

#include "prep/read_support.hpp"

namespace tetprep_test {
namespace {

using tetprep::ExitCode;
using tetprep::read_soup;

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

TEST_F(Read, OffValues) {
  const auto soup = read_text("a.off",
                              "STCNOFF\n3 1 3\n0 0 0 0 0 1 255 0 51 255 0 0\n1 0 0 0 0 1 0 255 0 0 0.5 1\n"
                              "0 1 0 0 0 1 255 0 51 255 0 0\n3 0 1 2\n");
  const auto& a = soup.appearance;
  ASSERT_EQ(a.surface_points, 2u);
  EXPECT_EQ(a.corners, (Triangles{{0, 1, 0}}));
  EXPECT_EQ(a.normals[0], (std::array<float, 3>{0, 0, 1}));
  EXPECT_EQ(a.colors, (std::vector<std::array<float, 4>>{{1, 0, 0.2f, 1}, {0, 1, 0, 0}}));
  EXPECT_EQ(a.texcoords[1], (std::array<float, 2>{0.5f, 1}));
  EXPECT_TRUE(soup.warnings.empty());
}

TEST_F(Read, OffColorsOfFaces) {
  const std::string head = "OFF\n3 2 0\n0 0 0\n1 0 0\n0 1 0\n";
  const auto whole = read_text("a.off", head + "3 0 1 2 255 0 51\n3 0 2 1\n").appearance;
  EXPECT_EQ(whole.colors, (std::vector<std::array<float, 4>>{{1, 0, 0.2f, 1}}));
  EXPECT_EQ(whole.corners, (Triangles{{0, 0, 0}, {tetprep::kNone, tetprep::kNone, tetprep::kNone}}));
  const auto fractions = read_text("a.off", head + "3 0 1 2 1 0.5 0 0.25\n3 0 2 1 0 0 0 1\n").appearance;
  EXPECT_EQ(fractions.colors, (std::vector<std::array<float, 4>>{{1, 0.5f, 0, 0.25f}, {0, 0, 0, 1}}));
  const auto table = read_text("a.off", head + "3 0 1 2 7\n3 0 2 1 9\n");
  EXPECT_EQ(table.appearance.surface_points, 0u);
  ASSERT_EQ(table.warnings.size(), 1u);
  EXPECT_TRUE(mentions(table.warnings[0], {"a.off:6:", "no colour"}));
  const auto unknown = read_text("a.off", "OFF\n3 1 0\n0 0 0 1\n1 0 0 2\n0 1 0 3\n3 0 1 2\n");
  EXPECT_EQ(unknown.points, kCorners);
  ASSERT_EQ(unknown.warnings.size(), 1u);
  EXPECT_TRUE(mentions(unknown.warnings[0], {"a.off:3:"}));
}

TEST_F(Read, OffDialects) {
  EXPECT_EQ(read_text("a.off", "3 1\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n").points, kCorners);
  EXPECT_EQ(read_text("a.off", "OFF 3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n").points, kCorners);
  EXPECT_EQ(read_text("a.off", "4OFF\n3 1 0\n0 0 0 2\n2 0 0 2\n0 0.5 0 .5\n3 0 1 2\n").points, kCorners);
  std::string binary = "COFF BINARY\n";
  const auto add = [&](auto value) {
    std::string bytes = raw(value);
    std::reverse(bytes.begin(), bytes.end());
    binary += bytes;
  };
  for (const std::int32_t count : {3, 1, 0}) add(count);
  for (const auto& point : kCorners) {
    for (const double x : point) add(static_cast<float>(x));
    for (const float x : {0.5f, 0.25f, 1.f, 1.f}) add(x);
  }
  for (const std::int32_t number : {3, 0, 1, 2, 0}) add(number);
  const auto soup = read_text("a.off", binary);
  EXPECT_EQ(soup.points, kCorners);
  EXPECT_EQ(soup.triangles, (Triangles{{0, 1, 2}}));
  EXPECT_EQ(soup.appearance.colors, (std::vector<std::array<float, 4>>{{0.5f, 0.25f, 1, 1}}));
  refuse("a.off", "nOFF\n4\n3 1 0\n", {":1:", "three dimensions"}, ExitCode::unsupported);
  for (std::size_t length = 0; length < binary.size(); ++length)
    EXPECT_EQ(failure_of([&] { read_text("a.off", binary.substr(0, length)); }).code(), ExitCode::invalid);
  expect_soundness("a.off", binary);
}

TEST_F(Read, DamagedOff) {
  expect_soundness("a.off",
                   "# c\nSTCNOFF\n5 2 0\n0 0 0 0 0 1 255 0 51 255 0 0\n1 0 0 0 0 1 0 255 0 0 0.5 1\n"
                   "1 1 0 0 0 1 255 0 51 255 0 0\n0 1 0 0 0 1 255 0 51 255 0 0\n0 2 0 0 0 1 9 9 9 9 0 0\n"
                   "3 0 1 2\n5 0 1 2 3 4 0 0 255\n");
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

TEST_F(Read, StlSolidsAreObjects) {
  std::string second = kAsciiStl;
  second.replace(0, 7, "SOLID the second");
  const auto soup = read_text("a.stl", kAsciiStl + second);
  EXPECT_EQ(soup.points, kCorners);
  ASSERT_EQ(soup.appearance.objects.size(), 2u);
  EXPECT_EQ(soup.appearance.objects[1].name, "the second");
  EXPECT_EQ(soup.appearance.triangle_object, (std::vector<Index>{0, 1}));
  EXPECT_EQ(read_text("a.stl",
                      "solid\nfacet normal nan nan nan outer loop vertex 0 0 0 vertex 1 0 0 vertex 0 1 0 "
                      "endloop endfacet\nendsolid")
                .points,
            kCorners);
  refuse("a.stl", "solid\nfacet normal 0 0 1\nouter loop\nvertex 0 0 x\nendsolid", {":4:", "\"x\""});
  refuse("a.stl", "solid\nouter loop\nvertex 0 0 1\nvertex 0 0 1\nendloop\nendsolid", {":5:", "2 corners"});
  refuse("a.stl", "solid\nfoo\nendsolid", {":2:", "\"foo\""});
}

TEST_F(Read, DamagedStl) {
  for (const std::string& good : {kAsciiStl, binary_stl(1)}) expect_soundness("a.stl", good);
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

TEST_F(Read, LargePolygons) {
  // A star with 20,000 corners, flat and tilted and bent; and one whose corners are anywhere.
  constexpr int kCount = 20000;
  const auto polygon = [&](const std::function<std::array<double, 3>(double, double)>& place) {
    std::string text, face = "f";
    for (int i = 0; i < kCount; ++i) {
      const double angle = 2 * M_PI * i / kCount, radius = 1 + 0.3 * std::sin(7 * angle);
      const auto p = place(radius * std::cos(angle), radius * std::sin(angle));
      text += "v " + std::to_string(p[0]) + " " + std::to_string(p[1]) + " " + std::to_string(p[2]) + "\n";
      face += " " + std::to_string(i + 1);
    }
    return tetprep::parse_soup("a.obj", text + face + "\n");
  };
  const auto shadow = [](const TriangleSoup& soup) {
    double signed_area = 0, area = 0;
    for (const auto& [a, b, c] : soup.triangles) {
      const auto &p = soup.points[a], &q = soup.points[b], &r = soup.points[c];
      const double twice = (q[0] - p[0]) * (r[1] - p[1]) - (q[1] - p[1]) * (r[0] - p[0]);
      signed_area += twice / 2;
      area += std::abs(twice) / 2;
    }
    EXPECT_NEAR(signed_area, area, 1e-4);
    return area;
  };
  const double expected = M_PI * (1 + 0.09 / 2);
  for (const double slope : {0.0, 0.7}) {
    const auto soup = polygon([&](double x, double y) { return std::array<double, 3>{x, y, slope * x}; });
    EXPECT_EQ(soup.triangles.size(), std::size_t{kCount - 2});
    EXPECT_NEAR(shadow(soup), expected, 1e-3);
  }
  EXPECT_NEAR(shadow(polygon([&](double x, double y) {
                return std::array<double, 3>{x, y, 0.3 * x * y};
              })),
              expected, 1e-3);
  std::uint32_t state = 1;
  const auto any = [&](double, double) {
    std::array<double, 3> p{};
    for (double& x : p) x = (state = state * 1664525 + 1013904223) / 4294967296.0;
    return p;
  };
  EXPECT_EQ(polygon(any).triangles.size(), std::size_t{kCount - 2});
}

TEST_F(Read, FilesThatAreNone) {
  EXPECT_EQ(failure_of([&] { read_soup(path("missing.off")); }).code(), ExitCode::io);
  std::filesystem::create_directory(path("folder.off"));
  EXPECT_EQ(failure_of([&] { read_soup(path("folder.off")); }).code(), ExitCode::io);
  refuse("a.xyz", "0 0 0\n", {".xyz"}, ExitCode::unsupported);
  refuse("noextension", "0 0 0\n", {"extension"}, ExitCode::unsupported);
  for (const char* name : {"a.off", "a.obj", "a.ply", "a.stl", "a.drc", "a.gltf", "a.glb"})
    refuse(name, "", {"empty"});
}

}  // namespace
}  // namespace tetprep_test
