// SPDX-License-Identifier: AGPL-3.0-or-later
// `tet query`: answers held against the inner box's geometry, formats, spaces, threads.
#include <cmath>
#include <cstring>
#include <random>
#include <sstream>

#include "cli/cli_support.hpp"
#include "cli/npy_bytes.hpp"
#include "support/region_mesh.hpp"
#include "tetfmt/encode.hpp"

namespace tetfmt_test {
namespace {

using Row = std::array<double, 6>;

/// What the binary hit format holds, packed.
struct HitRow {
  std::int32_t triangle = 0;
  double t = 0, u = 0, v = 0;
  std::int32_t side = 0, tet = 0, neighbor = 0;
};

std::vector<HitRow> read_hits(const std::string& path) {
  constexpr std::size_t kHeader = 192, kRow = 40;
  const std::string bytes = read_bytes(path);
  EXPECT_EQ(bytes.size() % 64 % 8, 0u);
  std::vector<HitRow> rows;
  if (bytes.size() < kHeader) {
    ADD_FAILURE() << path << " is short";
    return rows;
  }
  const std::size_t count = (bytes.size() - kHeader) / kRow;
  std::string header =
      "{'descr': [('triangle', '<i4'), ('t', '<f8'), ('u', '<f8'), ('v', '<f8'), ('side', '<i4'), ('tet', "
      "'<i4'), ('neighbor', '<i4')], 'fortran_order': False, 'shape': (" +
      std::to_string(count) + ",), }";
  header.resize(kHeader - 10 - 1, ' ');
  EXPECT_EQ(bytes.substr(0, kHeader),
            std::string("\x93NUMPY\x01\x00", 8) + static_cast<char>(kHeader - 10) + '\0' + header + "\n");
  EXPECT_EQ(bytes.size(), kHeader + count * kRow);
  for (std::size_t i = 0; i < count; ++i) {
    const char* at = bytes.data() + kHeader + i * kRow;
    HitRow row;
    const auto take = [&at](auto& value) {
      std::memcpy(&value, at, sizeof value);
      at += sizeof value;
    };
    take(row.triangle), take(row.t), take(row.u), take(row.v), take(row.side), take(row.tet),
        take(row.neighbor);
    rows.push_back(row);
  }
  return rows;
}

/// Where a ray meets the surface of the box [2, 4]^3, local coordinates; no value if it does not.
std::optional<double> box_hit(const Row& ray) {
  double enter = -INFINITY, leave = INFINITY;
  for (std::size_t i = 0; i < 3; ++i) {
    double a = (2 - ray[i]) / ray[i + 3], b = (4 - ray[i]) / ray[i + 3];
    if (a > b) std::swap(a, b);
    enter = std::max(enter, a);
    leave = std::min(leave, b);
  }
  if (enter > leave || leave < 0) return std::nullopt;
  return enter >= 0 ? enter : leave;
}

/// Rays in general position from inside the inner box, around it, and outside of the hull, exact in float32.
std::vector<Row> random_rays(std::size_t count) {
  std::mt19937 random(7);
  std::uniform_real_distribution<float> place(-3, 9), direction(-1, 1);
  std::vector<Row> rays(count);
  for (Row& ray : rays) {
    for (std::size_t i = 0; i < 3; ++i) ray[i] = static_cast<double>(place(random));
    for (std::size_t i = 3; i < 6; ++i) ray[i] = static_cast<double>(direction(random));
  }
  return rays;
}

TEST_F(CliTest, QueryAgreesWithTheBox) {
  const auto mesh = box_mesh();
  const auto rays = random_rays(10000);
  write_bytes("rays.npy", npy_bytes<float>(rays));
  for (const auto layout : {tetfmt::Layout::tet20, tetfmt::Layout::tet16}) {
    for (const std::string kernel : {"exact", "float"}) {
      write_mesh("box.tet", mesh, layout);
      const RunResult result = tet({"query", "box.tet", "--rays", "rays.npy", "--hits", "hits.npy", "--space",
                                    "local", "--kernel", kernel});
      ASSERT_EQ(result.exit_code, 0) << result.err;
      EXPECT_EQ(result.out, "");
      EXPECT_EQ(result.err, "");
      const auto hits = read_hits("hits.npy");
      ASSERT_EQ(hits.size(), rays.size());
      std::size_t met = 0, from_behind = 0;
      for (std::size_t i = 0; i < rays.size(); ++i) {
        const HitRow& hit = hits[i];
        const Row& ray = rays[i];
        const auto expected = box_hit(ray);
        if (!expected) {
          EXPECT_EQ(hit.triangle, -1);
          EXPECT_EQ(hit.t, INFINITY);
          EXPECT_EQ(hit.u, 0);
          EXPECT_EQ(hit.v, 0);
          EXPECT_EQ(hit.side, -1);
          EXPECT_EQ(hit.tet, -1);
          EXPECT_EQ(hit.neighbor, -1);
          continue;
        }
        ++met;
        ASSERT_GE(hit.triangle, 0) << i;
        ASSERT_LT(hit.triangle, 12);
        EXPECT_NEAR(hit.t, *expected, 1e-9 * std::max(1.0, *expected)) << i;
        const auto& corners = mesh.triangles[static_cast<std::size_t>(hit.triangle)].vertices;
        const auto &a = mesh.vertices[corners[0]], &b = mesh.vertices[corners[1]],
                   &c = mesh.vertices[corners[2]];
        const auto along = [&](float pa, float pb, float pc) {
          return (1 - hit.u - hit.v) * pa + hit.u * pb + hit.v * pc;
        };
        EXPECT_NEAR(ray[0] + hit.t * ray[3], along(a.x, b.x, c.x), 1e-6);
        EXPECT_NEAR(ray[1] + hit.t * ray[4], along(a.y, b.y, c.y), 1e-6);
        EXPECT_NEAR(ray[2] + hit.t * ray[5], along(a.z, b.z, c.z), 1e-6);
        const bool inside =
            std::all_of(ray.begin(), ray.begin() + 3, [](double x) { return x > 2 && x < 4; });
        EXPECT_EQ(hit.side, inside ? 1 : 0);
        from_behind += inside;
        // The two tets are those of the face's two sides.
        bool twins = false;
        for (std::size_t s = 0; s < mesh.sides.size(); ++s) {
          twins |= mesh.sides[s].tet == static_cast<tetfmt::Index>(hit.tet) &&
                   mesh.sides[s ^ 1].tet == static_cast<tetfmt::Index>(hit.neighbor) &&
                   mesh.sides[s].triangle == static_cast<tetfmt::Index>(hit.triangle) &&
                   s % 2 == static_cast<std::size_t>(hit.side);
        }
        EXPECT_TRUE(twins) << i;
      }
      EXPECT_GT(met, 250u);
      EXPECT_GT(from_behind, 20u);
    }
  }
}

TEST_F(CliTest, QueryFormatsAgree) {
  write_mesh("box.tet", box_mesh());
  const auto rays = random_rays(500);
  write_bytes("f4.npy", npy_bytes<float>(rays));
  write_bytes("f8.npy", npy_bytes<double>(rays));
  write_bytes("v2.npy", npy_bytes<float>(rays, {.version = 2}));
  write_bytes("v3.npy", npy_bytes<double>(rays, {.version = 3}));
  write_bytes("fortran.npy", npy_bytes<float>(rays, {.fortran = true}));
  std::ostringstream csv;
  csv.precision(17);
  csv << "\xEF\xBB\xBFox, oy, oz, dx, dy, dz\r\n# a comment\r\n\r\n";
  for (const Row& r : rays)
    csv << r[0] << ',' << r[1] << " ,\t+" << std::abs(r[2]) << ',' << r[3] << ',' << r[4] << ',' << r[5]
        << "\r\n";
  auto positive = rays;
  for (Row& r : positive) r[2] = std::abs(r[2]);
  write_bytes("positive.npy", npy_bytes<float>(positive));
  const auto query = [&](const std::string& from, const std::string& input = {}) {
    const RunResult result =
        tet({"query", "box.tet", "--rays", from, "--hits", "-", "--space", "local"}, input);
    EXPECT_EQ(result.exit_code, 0) << from << ": " << result.err;
    EXPECT_EQ(result.err, "") << from;
    return result.out;
  };
  const std::string expected = query("f4.npy");
  EXPECT_EQ(expected.substr(0, expected.find('\n')), "triangle,t,u,v,side,tet,neighbor");
  EXPECT_EQ(static_cast<std::size_t>(std::count(expected.begin(), expected.end(), '\n')), rays.size() + 1);
  EXPECT_NE(expected.find("\n-1,inf,0,0,-1,-1,-1\n"), std::string::npos);
  for (const char* name : {"f8.npy", "v2.npy", "v3.npy", "fortran.npy"})
    EXPECT_EQ(query(name), expected) << name;
  EXPECT_EQ(query("-", csv.str()), query("positive.npy"));

  // CSV holds the same doubles as .npy: each is the shortest text that reads back as the same number.
  ASSERT_EQ(tet({"query", "box.tet", "--rays", "f4.npy", "--hits", "hits.npy", "--space", "local"}).exit_code,
            0);
  const auto hits = read_hits("hits.npy");
  std::istringstream lines(expected);
  std::string line;
  std::getline(lines, line);
  for (const HitRow& hit : hits) {
    ASSERT_TRUE(std::getline(lines, line));
    std::istringstream fields(line);
    std::vector<std::string> parts;
    for (std::string part; std::getline(fields, part, ',');) parts.push_back(part);
    ASSERT_EQ(parts.size(), 7u);
    EXPECT_EQ(std::stol(parts[0]), hit.triangle);
    EXPECT_EQ(std::strtod(parts[1].c_str(), nullptr), hit.t);
    EXPECT_EQ(std::strtod(parts[2].c_str(), nullptr), hit.u);
    EXPECT_EQ(std::strtod(parts[3].c_str(), nullptr), hit.v);
    EXPECT_EQ(std::stol(parts[4]), hit.side);
    EXPECT_EQ(std::stol(parts[5]), hit.tet);
    EXPECT_EQ(std::stol(parts[6]), hit.neighbor);
  }
}

TEST_F(CliTest, QueryModelSpaceSubtractsTheOriginInDouble) {
  auto mesh = box_mesh();
  mesh.origin = {1e9 + 0.125, -1e9, 1e7};  // far beyond float32's resolution
  write_mesh("far.tet", mesh);
  write_mesh("box.tet", box_mesh());
  auto rays = random_rays(3000);
  for (Row& r : rays) {
    for (std::size_t i = 0; i < 3; ++i)
      r[i] = std::round(r[i] * 1024) / 1024 + 1.0 / 4096;  // exact at the far origin
  }
  write_bytes("local.npy", npy_bytes<float>(rays));
  for (Row& r : rays) {
    for (std::size_t i = 0; i < 3; ++i) r[i] += mesh.origin[i];
  }
  write_bytes("model.npy", npy_bytes<double>(rays));
  const RunResult model = tet({"query", "far.tet", "--rays", "model.npy", "--hits", "-"});
  const RunResult local = tet({"query", "far.tet", "--rays", "local.npy", "--hits", "-", "--space", "local"});
  EXPECT_EQ(model.exit_code, 0) << model.err;
  EXPECT_EQ(model.err, "");
  EXPECT_EQ(model.out, local.out);
  std::size_t misses = 0;
  for (auto at = model.out.find("\n-1,"); at != std::string::npos; at = model.out.find("\n-1,", at + 1))
    ++misses;
  EXPECT_LT(misses, rays.size() - 40);  // some are hits
}

TEST_F(CliTest, QueryWarnsWhereLocalSpaceHasToRound) {
  write_mesh("box.tet", box_mesh());
  const RunResult result = tet({"query", "box.tet", "--rays", "-", "--hits", "-", "--space", "local"},
                               "0.1,0.25,3,1,0,0\n0,0.1,0.1,1,1,1\n");
  EXPECT_EQ(result.exit_code, 0);
  EXPECT_TRUE(is_one_line(result.err, "tet query", {"warning", "3 numbers"}));
  const RunResult model = tet({"query", "box.tet", "--rays", "-", "--hits", "-"}, "0.1,0.25,3,1,0,0\n");
  EXPECT_EQ(model.err, "");
}

TEST_F(CliTest, QueryDirectionlessRaysHitNothing) {
  write_mesh("box.tet", box_mesh());
  const RunResult result =
      tet({"query", "box.tet", "--rays", "-", "--hits", "-"}, "13,23,33,0,0,0\n13.2,23.1,10,0,0,2\n");
  EXPECT_EQ(result.exit_code, 0);
  EXPECT_TRUE(
      is_one_line(result.err, "tet query",
                  {"warning", "1 ray of standard input has direction zero", "hits nothing, first ray 0"}));
  const RunResult two = tet({"query", "box.tet", "--rays", "-", "--hits", "-"},
                            "13,23,33,1,0,0\n1,1,1,0,-0,1e-60\n1,1,1,0,0,0\n");
  EXPECT_EQ(two.exit_code, 0);
  EXPECT_TRUE(
      is_one_line(two.err, "tet query", {"2 rays", "have direction zero", "hit nothing, first ray 1"}));
  EXPECT_EQ(tet({"query", "box.tet", "--rays", "-", "--hits", "-"}, "13,23,33,1e-40,0,0\n").err, "");
  EXPECT_NE(result.out.find("\n-1,inf,0,0,-1,-1,-1\n"), std::string::npos);
  EXPECT_NE(result.out.find(",11,"), std::string::npos)
      << result.out;  // t is in units of the direction's length 2
}

TEST_F(CliTest, QueryAnswersNoRaysWithNoHits) {
  write_mesh("box.tet", box_mesh());
  EXPECT_EQ(tet({"query", "box.tet", "--rays", "-", "--hits", "-"}, "").out,
            "triangle,t,u,v,side,tet,neighbor\n");
  write_bytes("none.npy", npy_bytes<float>({}));
  EXPECT_EQ(tet({"query", "box.tet", "--rays", "none.npy", "--hits", "hits.npy"}).exit_code, 0);
  EXPECT_EQ(read_hits("hits.npy").size(), 0u);
}

/// Rays that start on vertices, edges and faces of tets, where a location can depend on the way there.
std::vector<Row> lattice_rays() {
  std::vector<Row> rays;
  std::mt19937 random(3);
  std::uniform_int_distribution<int> place(0, 12), direction(-2, 2);
  while (rays.size() < 20000) {
    Row ray{};
    for (std::size_t i = 0; i < 3; ++i) ray[i] = place(random) / 2.0;
    for (std::size_t i = 3; i < 6; ++i) ray[i] = direction(random);
    if (ray[3] != 0 || ray[4] != 0 || ray[5] != 0) rays.push_back(ray);
  }
  return rays;
}

TEST_F(CliTest, QueryIsTheSameForAnyNumberOfThreads) {
  write_mesh("box.tet", box_mesh());
  write_bytes("rays.npy", npy_bytes<float>(lattice_rays()));
  for (const std::string ending : {"npy", "csv"}) {
    for (const std::string threads : {"1", "2", "7"}) {
      const RunResult result =
          tet({"query", "box.tet", "--rays", "rays.npy", "--hits", "hits" + threads + "." + ending,
               "--threads", threads, "--space", "local"});
      ASSERT_EQ(result.exit_code, 0) << result.err;
    }
    const std::string expected = read_bytes("hits1." + ending);
    EXPECT_GT(expected.size(), 400000u);
    EXPECT_EQ(read_bytes("hits2." + ending), expected);
    EXPECT_EQ(read_bytes("hits7." + ending), expected);
  }
}

/// Rays from anywhere to vertices of the lattice, whose float signs contradict each other around them.
std::vector<Row> rays_to_vertices(std::size_t count) {
  std::mt19937 random(11);
  std::uniform_real_distribution<float> place(-3, 9);
  std::uniform_int_distribution<int> vertex(0, 6);
  std::vector<Row> rays(count);
  for (Row& ray : rays) {
    for (std::size_t i = 0; i < 3; ++i) {
      const float from = place(random);
      ray[i] = static_cast<double>(from);
      ray[i + 3] = static_cast<double>(static_cast<float>(vertex(random)) - from);
    }
  }
  return rays;
}

TEST_F(CliTest, QueryTellsRaysThatTheFloatKernelLoses) {
  write_mesh("box.tet", box_mesh());
  const auto rays = rays_to_vertices(200000);
  write_bytes("rays.npy", npy_bytes<float>(rays));
  const auto query = [&](const std::string& kernel) {
    return tet({"query", "box.tet", "--rays", "rays.npy", "--hits", "hits.npy", "--space", "local",
                "--kernel", kernel});
  };
  const RunResult exact = query("exact");
  EXPECT_EQ(exact.exit_code, 0);
  EXPECT_EQ(exact.err, "");
  const RunResult lossy = query("float");
  EXPECT_EQ(lossy.exit_code, 0);
  ASSERT_TRUE(is_one_line(lossy.err, "tet query",
                          {"warning: float kernel lost ", "rays.npy, first ray ", "; use --kernel exact"}));
  const auto number_after = [&](const std::string& words) {
    return std::stoul(lossy.err.substr(lossy.err.find(words) + words.size()));
  };
  EXPECT_GE(number_after("lost "), 1u);
  const auto hits = read_hits("hits.npy");
  ASSERT_EQ(hits.size(), rays.size());
  const std::size_t first = number_after("first ray ");
  ASSERT_LT(first, hits.size());
  EXPECT_EQ(hits[first].triangle, -1);
  EXPECT_EQ(hits[first].t, INFINITY);
}

TEST_F(CliTest, QueryOnBytesThatAreNoMeshIsInvalidData) {
  auto mesh = box_mesh();
  auto bytes = tetfmt::encode(mesh, tetfmt::Layout::tet20);
  const auto* header = reinterpret_cast<const tetfmt::FileHeader*>(bytes.data());
  const auto* sections = reinterpret_cast<const tetfmt::SectionEntry*>(bytes.data() + header->toc_offset);
  for (std::uint32_t i = 0; i < header->toc_count; ++i) {
    if (sections[i].kind != tetfmt::kTets) continue;
    auto* tets = reinterpret_cast<tetfmt::Tet20*>(bytes.data() + sections[i].offset);
    for (std::uint64_t t = 600; t < sections[i].count; ++t) tets[t].vertex_xor ^= 0x40000000;
  }
  tetfmt::rehash(bytes);
  write_bytes("broken.tet", {reinterpret_cast<const char*>(bytes.data()), bytes.size()});
  // The first ray stays where the file is sound, the second does not.
  write_bytes("rays.csv", "ox,oy,oz,dx,dy,dz\n10.1,20.2,30.3,0,0,-1\n10.1,20.2,30.3,0.1,0.2,1\n");
  const RunResult result = tet({"query", "broken.tet", "--rays", "rays.csv", "--hits", "hits.csv"});
  EXPECT_EQ(result.exit_code, 3);
  EXPECT_TRUE(is_one_line(result.err, "tet query", {"broken.tet", "rays.csv:3", "tet validate"}));
  EXPECT_EQ(tet({"query", "broken.tet", "--rays", "rays.csv", "--hits", "hits.csv", "--kernel", "float"}).err,
            result.err);
  EXPECT_EQ(listing(), (std::vector<std::string>{"broken.tet", "rays.csv"}));
}

TEST_F(CliTest, QueryNeverWritesOverItsInput) {
  write_mesh("box.tet", box_mesh());
  write_mesh("mesh.npy", box_mesh());
  write_bytes("rays.npy", npy_bytes<float>(random_rays(3)));
  std::filesystem::create_symlink("rays.npy", "link.npy");
  const std::string rays = read_bytes("rays.npy"), mesh = read_bytes("mesh.npy");
  const auto before = listing();
  for (const std::array<std::string, 3>& names :
       {std::array<std::string, 3>{"mesh.npy", "rays.npy", "mesh.npy"},
        {"box.tet", "rays.npy", "rays.npy"},
        {"box.tet", "rays.npy", "./rays.npy"},
        {"box.tet", "rays.npy", "link.npy"}}) {
    const RunResult result = tet({"query", names[0], "--rays", names[1], "--hits", names[2]});
    EXPECT_EQ(result.exit_code, 1) << names[2];
    EXPECT_TRUE(is_one_line(result.err, "tet query", {names[2], "the input itself"}));
  }
  EXPECT_EQ(read_bytes("rays.npy"), rays);
  EXPECT_EQ(read_bytes("mesh.npy"), mesh);
  EXPECT_EQ(listing(), before);
}

TEST_F(CliTest, QueryReplacesAnOldFileOnlyOnSuccess) {
  write_mesh("box.tet", box_mesh());
  write_bytes("hits.csv", "old");
  write_bytes("good.csv", "13.2,23.1,10,0,0,1\n");
  write_bytes("bad.csv", "13,23,10,0,0\n");
  EXPECT_EQ(tet({"query", "box.tet", "--rays", "bad.csv", "--hits", "hits.csv"}).exit_code, 3);
  EXPECT_EQ(read_bytes("hits.csv"), "old");
  std::filesystem::create_symlink("hits.csv", "link.csv");
  EXPECT_EQ(tet({"query", "box.tet", "--rays", "good.csv", "--hits", "link.csv"}).exit_code, 0);
  EXPECT_EQ(read_bytes("hits.csv").substr(0, 9), "triangle,");
  EXPECT_TRUE(std::filesystem::is_symlink("link.csv"));
}

TEST_F(CliTest, QueryTellsRaysFromLeftOutSpace) {
  write_mesh("outside.tet", with_regions(box_mesh(), {0}));
  write_mesh("inside.tet", with_regions(box_mesh(), {1}));
  ASSERT_EQ(tet({"validate", "outside.tet"}).exit_code, 0);
  // From the middle of the box up, and from above it down.
  const std::string rays = "13,23,33,0,0,1\n13,23,50,0,0,-1\n13,23,50,0,0,1\n";
  const RunResult outside = tet({"query", "outside.tet", "--rays", "-", "--hits", "-"}, rays);
  ASSERT_EQ(outside.exit_code, 0) << outside.err;
  EXPECT_TRUE(is_one_line(outside.err, "tet query", {"1 ray", "leaves out", "first ray 0", "--keep all"}));
  std::istringstream lines(outside.out);
  std::string line;
  std::getline(lines, line);
  std::getline(lines, line);
  EXPECT_EQ(line, "-2,nan,0,0,-1,-1,-1");
  std::getline(lines, line);
  EXPECT_TRUE(line.starts_with("10,16,") || line.starts_with("11,16,")) << line;
  EXPECT_TRUE(line.ends_with(",-1")) << line;  // nothing is known behind the wall
  std::getline(lines, line);
  EXPECT_EQ(line, "-1,inf,0,0,-1,-1,-1");

  const RunResult inside = tet({"query", "inside.tet", "--rays", "-", "--hits", "-"}, rays);
  ASSERT_EQ(inside.exit_code, 0) << inside.err;
  EXPECT_TRUE(is_one_line(inside.err, "tet query", {"2 rays", "first ray 1"}));
  EXPECT_NE(inside.out.find("-2,nan,0,0,-1,-1,-1\n-2,nan,0,0,-1,-1,-1\n"), std::string::npos) << inside.out;
}

}  // namespace
}  // namespace tetfmt_test
