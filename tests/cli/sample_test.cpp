// SPDX-License-Identifier: AGPL-3.0-or-later
// `tet sample`: counts, formats that agree, closed surfaces that are closed and point outward.
#include <cmath>
#include <cstring>
#include <map>
#include <set>
#include <sstream>

#include "cli/cli_support.hpp"

namespace tetfmt_test {
namespace {

struct Surface {
  std::vector<std::array<float, 3>> points;
  std::vector<std::array<std::uint32_t, 3>> triangles;
};

Surface read_off(const std::string& path) {
  std::istringstream text(read_bytes(path));
  std::string magic;
  std::size_t points = 0, triangles = 0, edges = 0, corners = 0;
  text >> magic >> points >> triangles >> edges;
  EXPECT_EQ(magic, "OFF");
  Surface surface;
  surface.points.resize(points);
  surface.triangles.resize(triangles);
  for (auto& p : surface.points) text >> p[0] >> p[1] >> p[2];
  for (auto& t : surface.triangles) {
    text >> corners >> t[0] >> t[1] >> t[2];
    EXPECT_EQ(corners, 3u);
  }
  EXPECT_TRUE(static_cast<bool>(text));
  return surface;
}

Surface sample(const std::string& kind, std::uint64_t triangles, const std::string& seed = "1") {
  const RunResult result =
      tet({"sample", kind, "-o", "s.off", "--triangles", std::to_string(triangles), "--seed", seed});
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_EQ(result.out, "");
  const Surface surface = read_off("s.off");
  EXPECT_TRUE(is_one_line(result.err, "tet sample",
                          {"s.off", std::to_string(surface.triangles.size()) + " triangles"}));
  return surface;
}

/// Every directed edge once, and its reverse once.
bool closed(const Surface& surface) {
  std::set<std::pair<std::uint32_t, std::uint32_t>> edges;
  for (const auto& t : surface.triangles) {
    for (std::size_t i = 0; i < 3; ++i) {
      if (t[i] >= surface.points.size() || !edges.emplace(t[i], t[(i + 1) % 3]).second) return false;
    }
  }
  for (const auto& [a, b] : edges) {
    if (!edges.contains({b, a})) return false;
  }
  return true;
}

/// Six times the signed volume: positive if triangles point outward.
double volume6(const Surface& surface) {
  double sum = 0;
  for (const auto& t : surface.triangles) {
    const auto &a = surface.points[t[0]], &b = surface.points[t[1]], &c = surface.points[t[2]];
    for (std::size_t i = 0; i < 3; ++i) {
      const std::size_t j = (i + 1) % 3, k = (i + 2) % 3;
      sum +=
          static_cast<double>(a[i]) * (static_cast<double>(b[j]) * c[k] - static_cast<double>(b[k]) * c[j]);
    }
  }
  return sum;
}

int euler(const Surface& surface) {
  return static_cast<int>(surface.points.size()) - static_cast<int>(surface.triangles.size()) / 2;
}

TEST_F(CliTest, SampleClosedSurfacesAreClosedAndPointOutward) {
  for (const std::uint64_t count : {4000u, 4001u, 12345u, 50000u}) {
    for (const std::string kind : {"sphere", "torus-knot", "knots", "needles", "slivers", "lattice"}) {
      const Surface surface = sample(kind, count);
      EXPECT_NEAR(static_cast<double>(surface.triangles.size()), static_cast<double>(count),
                  0.03 * static_cast<double>(count));
      EXPECT_TRUE(closed(surface)) << kind << " " << count;
      EXPECT_GT(volume6(surface), 0) << kind << " " << count;
      // Two a sphere, none a torus; needles, lenses and cubes are spheres of so many triangles each.
      const std::map<std::string, std::size_t> triangles_a_part = {
          {"needles", 4}, {"slivers", 32}, {"lattice", 12}};
      const auto part = triangles_a_part.find(kind);
      const std::size_t spheres = kind == "sphere"                 ? 1
                                  : part == triangles_a_part.end() ? 0
                                                                   : surface.triangles.size() / part->second;
      EXPECT_EQ(euler(surface), 2 * static_cast<int>(spheres)) << kind << " " << count;
      EXPECT_EQ(std::set(surface.points.begin(), surface.points.end()).size(), surface.points.size());
    }
  }
}

TEST_F(CliTest, SampleSphereIsStarShapedAtAnyCount) {
  // Closed, of Euler characteristic 2, and every triangle positive as seen from the centre: so no two meet.
  for (std::uint64_t count = 8; count < 300; count += 2) {
    const Surface surface = sample("sphere", count);
    EXPECT_EQ(surface.triangles.size(), count);
    EXPECT_TRUE(closed(surface)) << count;
    EXPECT_EQ(euler(surface), 2) << count;
    for (const auto& t : surface.triangles) {
      Surface one{surface.points, {t}};
      ASSERT_GT(volume6(one), 0) << count;
    }
  }
}

TEST_F(CliTest, SampleBumpyPlaneIsAHeightField) {
  for (const std::uint64_t count : {2u, 1000u, 20000u}) {
    const Surface surface = sample("bumpy-plane", count);
    EXPECT_NEAR(static_cast<double>(surface.triangles.size()), static_cast<double>(count),
                0.03 * static_cast<double>(count));
    for (const auto& t : surface.triangles) {
      const auto &a = surface.points[t[0]], &b = surface.points[t[1]], &c = surface.points[t[2]];
      ASSERT_GT((b[2] - a[2]) * (c[0] - a[0]) - (b[0] - a[0]) * (c[2] - a[2]), 0.0F);  // faces up
    }
    EXPECT_FALSE(closed(surface));
  }
}

TEST_F(CliTest, SampleSmallestSurfacesWork) {
  EXPECT_EQ(sample("sphere", 8).triangles.size(), 8u);
  EXPECT_TRUE(closed(sample("torus-knot", 500)));
  EXPECT_TRUE(closed(sample("knots", 4000)));
  EXPECT_EQ(sample("needles", 4).triangles.size(), 4u);
  EXPECT_EQ(sample("slivers", 32).triangles.size(), 32u);
  EXPECT_EQ(sample("lattice", 12).triangles.size(), 12u);
}

TEST_F(CliTest, SampleSeedsMatterWhereTheyShould) {
  for (const std::string kind : {"knots", "bumpy-plane", "needles", "slivers", "lattice"}) {
    EXPECT_EQ(sample(kind, 5000, "3").points, sample(kind, 5000, "3").points);
    EXPECT_NE(sample(kind, 5000, "3").points, sample(kind, 5000, "4").points);
  }
}

TEST_F(CliTest, SampleKnotsKeepToTheirCells) {
  const Surface surface = sample("knots", 32000);
  // Each knot's vertices stand together: no triangle leaves the unit cell that its first corner is in.
  for (const auto& t : surface.triangles) {
    for (std::size_t i = 0; i < 3; ++i) {
      EXPECT_EQ(std::floor(surface.points[t[0]][i]), std::floor(surface.points[t[1]][i]));
      EXPECT_EQ(std::floor(surface.points[t[0]][i]), std::floor(surface.points[t[2]][i]));
    }
  }
}

TEST_F(CliTest, SampleFormatsHoldTheSameSurface) {
  const Surface expected = sample("torus-knot", 600);
  for (const char* name : {"s.obj", "s.ply", "S.STL"})
    ASSERT_EQ(tet({"sample", "torus-knot", "-o", name, "--triangles", "600"}).exit_code, 0);

  Surface obj;
  std::istringstream text(read_bytes("s.obj"));
  for (std::string line; std::getline(text, line);) {
    std::istringstream fields(line);
    std::string kind;
    fields >> kind;
    if (kind == "v") {
      auto& p = obj.points.emplace_back();
      fields >> p[0] >> p[1] >> p[2];
    } else if (kind == "f") {
      auto& t = obj.triangles.emplace_back();
      fields >> t[0] >> t[1] >> t[2];
      for (auto& corner : t) --corner;
    } else {
      EXPECT_EQ(kind, "#");
    }
  }
  EXPECT_EQ(obj.points, expected.points);
  // Text holds float32 exactly: a reader in double must not see something else.
  std::istringstream first(read_bytes("s.obj").substr(read_bytes("s.obj").find("v ") + 2));
  for (std::size_t i = 0; i < 3; ++i) {
    double value = 0;
    first >> value;
    EXPECT_EQ(value, static_cast<double>(expected.points[0][i]));
  }
  EXPECT_EQ(obj.triangles, expected.triangles);

  const std::string ply = read_bytes("s.ply");
  const std::size_t body = ply.find("end_header\n") + 11;
  EXPECT_NE(ply.find("format binary_little_endian 1.0\n"), std::string::npos);
  ASSERT_EQ(ply.size(), body + 12 * expected.points.size() + 13 * expected.triangles.size());
  EXPECT_EQ(std::memcmp(ply.data() + body, expected.points.data(), 12 * expected.points.size()), 0);
  for (std::size_t i = 0; i < expected.triangles.size(); ++i) {
    const char* face = ply.data() + body + 12 * expected.points.size() + 13 * i;
    EXPECT_EQ(face[0], 3);
    EXPECT_EQ(std::memcmp(face + 1, expected.triangles[i].data(), 12), 0);
  }

  const std::string stl = read_bytes("S.STL");
  ASSERT_EQ(stl.size(), 84 + 50 * expected.triangles.size());
  EXPECT_FALSE(stl.starts_with("solid"));
  for (std::size_t i = 0; i < expected.triangles.size(); ++i) {
    for (std::size_t corner = 0; corner < 3; ++corner) {
      EXPECT_EQ(std::memcmp(stl.data() + 84 + 50 * i + 12 * (corner + 1),
                            expected.points[expected.triangles[i][corner]].data(), 12),
                0);
    }
  }
}

TEST_F(CliTest, SampleRefusesSeedsOutOfRange) {
  for (const std::string seed : {"-1", "18446744073709551616", "1.5", "x", "0x10"}) {
    const RunResult result = tet({"sample", "knots", "-o", "a.obj", "--seed", seed});
    EXPECT_EQ(result.exit_code, 1) << seed;
    EXPECT_TRUE(is_one_line(result.err, "tet sample", {"--seed", seed}));
  }
  EXPECT_EQ(tet({"sample", "sphere", "-o", "a.obj", "--seed", "18446744073709551615"}).exit_code, 0);
}

}  // namespace
}  // namespace tetfmt_test
