// SPDX-License-Identifier: AGPL-3.0-or-later
#include "prep/debug_mesh.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>

#include "prep/prep_support.hpp"

namespace tetprep_test {
namespace {

using tetprep::CleanSurface;
using tetprep::ExitCode;
using tetprep::snap;
using tetprep::write_debug_mesh;

using DebugMesh = FolderTest;

/// What follows the header, as this test understands the format.
struct Face {
  std::array<Index, 3> corners{};
  std::array<std::uint8_t, 3> colour{};
  Index input_triangle = 0;
};

std::vector<Face> faces_of(const std::string& file, std::size_t points, std::size_t triangles) {
  std::size_t at = file.find("end_header\n") + std::strlen("end_header\n") + points * 3 * sizeof(double);
  std::vector<Face> faces;
  EXPECT_EQ(file.size(), at + triangles * (1 + 12 + 3 + 4));
  for (std::size_t i = 0; i < triangles && at + 20 <= file.size(); ++i, at += 20) {
    Face face;
    EXPECT_EQ(file[at], 3);
    std::memcpy(&face.corners, &file[at + 1], 12);
    std::memcpy(&face.colour, &file[at + 13], 3);
    std::memcpy(&face.input_triangle, &file[at + 16], 4);
    faces.push_back(face);
  }
  return faces;
}

TEST_F(DebugMesh, OtherReadersUnderstandIt) {
  const TriangleSoup soup = moved(ball(3), {1e6, 0, -3});
  const CleanSurface surface = snap(soup);
  write_debug_mesh(path("a.ply"), surface, {5, 2, 5});
  const TriangleSoup again = tetprep::read_soup(path("a.ply"));
  ASSERT_EQ(again.points.size(), surface.points.size());
  const double step = std::ldexp(1.0, surface.grid_exponent);
  for (std::size_t i = 0; i < again.points.size(); ++i)
    for (std::size_t k = 0; k < 3; ++k)
      EXPECT_EQ(again.points[i][k], surface.origin[k] + surface.points[i][k] * step);
  ASSERT_EQ(again.triangles.size(), surface.triangles.size());
  EXPECT_EQ(again.triangles[0], surface.triangles[2]);
  EXPECT_EQ(again.triangles[1], surface.triangles[5]);
  EXPECT_EQ(again.triangles[2], surface.triangles[0]);
}

TEST_F(DebugMesh, MarkedTrianglesAreFirstAndRed) {
  TriangleSoup soup = ball(3);
  soup.triangles.insert(soup.triangles.begin(), 7, {0, 0, 1});  // dropped, but input numbers count them
  const CleanSurface surface = snap(soup);
  write_debug_mesh(path("a.ply"), surface, {30, 4});
  const auto faces = faces_of(read("a.ply"), surface.points.size(), surface.triangles.size());
  ASSERT_EQ(faces.size(), surface.triangles.size());
  std::vector<Index> order{4, 30};
  for (Index t = 0; t < surface.triangles.size(); ++t)
    if (t != 4 && t != 30) order.push_back(t);
  for (std::size_t i = 0; i < faces.size(); ++i) {
    EXPECT_EQ(faces[i].corners, surface.triangles[order[i]]);
    EXPECT_EQ(faces[i].input_triangle, surface.input_triangle[order[i]]);
    EXPECT_EQ(faces[i].colour[0] > 2 * faces[i].colour[1], i < 2) << i;
  }
}

TEST_F(DebugMesh, NothingMarked) {
  const CleanSurface surface = snap(cube({0, 0, 0}, 1));
  write_debug_mesh(path("a.ply"), surface, {});
  for (const Face& face : faces_of(read("a.ply"), 8, 12)) EXPECT_EQ(face.colour[0], face.colour[1]);
}

TEST_F(DebugMesh, ReplacesWholeFiles) {
  write("a.ply", "an older file");
  write_debug_mesh(path("a.ply"), snap(cube({0, 0, 0}, 1)), {0});
  EXPECT_EQ(read("a.ply").substr(0, 4), "ply\n");
  EXPECT_EQ(listing(), std::vector<std::string>{"a.ply"});
}

TEST_F(DebugMesh, FolderIsMissing) {
  const auto failure = failure_of([&] { write_debug_mesh(path("no/a.ply"), snap(cube({0, 0, 0}, 1)), {}); });
  EXPECT_EQ(failure.code(), ExitCode::io);
  EXPECT_TRUE(listing().empty());
}

}  // namespace
}  // namespace tetprep_test
