// SPDX-License-Identifier: AGPL-3.0-or-later
// Real meshes through `tet convert` and `tet query`, both layouts, against exact arithmetic. Every other way
// to ask for a hit is in `tet bench --stress` (stress.sh).
#include <gtest/gtest.h>
#include <sys/wait.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <iterator>
#include <limits>

#include "bench/tester.hpp"
#include "differential/npy.hpp"

namespace tetfmt_test {
namespace {

namespace fs = std::filesystem;
using tetfmt::Index;

constexpr std::size_t kRays = 1000;  // of each set

struct Source {
  const char* name;     ///< of the test
  const char* member;   ///< of the archive of CGAL's example meshes
  const char* about;    ///< why this one
  const char* instead;  ///< arguments of `tet sample`, where there is no archive
};

std::ostream& operator<<(std::ostream& out, const Source& source) {
  return out << source.name;
}

const Source kSources[] = {
    {"dino", "data/meshes/dino.off", "a scan with colours", "torus-knot --triangles 8000"},
    {"three_peaks", "data/meshes/three_peaks.off", "an open height field", "bumpy-plane --triangles 4000"},
    {"rotor", "data/meshes/rotor_small.off", "a CAD part", "knots --triangles 8000"},
};

/// Runs `tet` with `arguments`; on failure the message has what it wrote.
testing::AssertionResult tet(const std::string& arguments, const fs::path& folder) {
  const fs::path log = folder / "tet.log";
  const std::string command =
      std::string("'") + TETFMT_TET + "' " + arguments + " >'" + log.string() + "' 2>&1";
  const int status = std::system(command.c_str());
  if (WIFEXITED(status) && WEXITSTATUS(status) == 0) return testing::AssertionSuccess();
  std::ifstream text(log);
  return testing::AssertionFailure() << "tet " << arguments << "\n"
                                     << std::string(std::istreambuf_iterator<char>(text), {});
}

std::string quoted(const fs::path& path) {
  return "'" + path.string() + "'";
}

/// The mesh as a file in `folder`; empty if it cannot be had.
fs::path obtain(const Source& source, const fs::path& folder) {
  const fs::path archive = TETFMT_MESH_ARCHIVE;
  if (fs::is_regular_file(archive)) {
    const std::string command = "tar -xzf " + quoted(archive) + " -C " + quoted(folder) + " " + source.member;
    EXPECT_EQ(std::system(command.c_str()), 0) << command;
    return folder / source.member;
  }
  std::cout << "NOTE: " << source.member
            << " is not on this machine (Debian: libcgal-demo); using `tet sample " << source.instead
            << "` instead\n";
  const fs::path made = folder / "sample.off";
  EXPECT_TRUE(tet(std::string("sample ") + source.instead + " -o " + quoted(made), folder));
  return made;
}

class Differential : public testing::TestWithParam<Source> {};

TEST_P(Differential, AnswersOfTheCommandAreExact) {
  const Source& source = GetParam();
  const fs::path folder = fs::path(TETFMT_WORK) / source.name;
  fs::remove_all(folder);
  fs::create_directories(folder);
  const fs::path mesh = obtain(source, folder);
  ASSERT_TRUE(fs::is_regular_file(mesh));
  for (const char* layout : {"tet20", "tet16"}) {
    const fs::path out = folder / (std::string(layout) + ".tet");
    ASSERT_TRUE(tet("convert " + quoted(mesh) + " -q --layout " + layout + " -o " + quoted(out), folder));
  }
  const tetbench::Bench bench((folder / "tet20.tet").string());
  const tetbench::ExactReference& reference = bench.scene.reference();

  std::vector<tetfmt::Ray> rays;
  std::vector<std::string> names;
  for (const tetbench::RaySet& set : tetbench::ray_sets()) {
    if (set.flow != tetbench::Flow::rays || std::string(set.name) == "intervals") continue;
    tetbench::Dice dice{2022, rays.size()};
    for (std::size_t i = 0; i < kRays; ++i) {
      const tetbench::Shot shot = bench.maker.make(set, dice);
      rays.push_back({shot.origin, shot.direction});
      names.emplace_back(set.name);
    }
  }
  write_rays((folder / "rays.npy").string(), rays);
  for (const char* layout : {"tet20", "tet16"}) {
    ASSERT_TRUE(tet("query " + quoted(folder / (std::string(layout) + ".tet")) + " --space local --rays " +
                        quoted(folder / "rays.npy") + " --hits " +
                        quoted(folder / (std::string(layout) + ".npy")),
                    folder));
  }
  const NpyTable hits = NpyTable::read((folder / "tet20.npy").string());
  ASSERT_EQ(hits.size(), rays.size());
  // Both files hold the same tets in the same order, so the same walks give the same answers to the last bit.
  // What is judged below is therefore both layouts' answer.
  ASSERT_TRUE(hits.bytes() == NpyTable::read((folder / "tet16.npy").string()).bytes());

  const auto triangle = hits.column("triangle"), t = hits.column("t"), u = hits.column("u"),
             v = hits.column("v"), side = hits.column("side"), tet_in = hits.column("tet"),
             neighbor = hits.column("neighbor");
  const tetfmt::Mesh& file = bench.scene.mesh();
  const auto origins = bench.scene.view(0).view().origins();
  std::size_t wrong = 0, found = 0;
  for (std::size_t i = 0; i < rays.size(); ++i) {
    const auto wide = [](const tetfmt::Vec3f& p) { return tetbench::Vec3d{p.x, p.y, p.z}; };
    const tetbench::ExactLine line(reference.surface(), {wide(rays[i].origin), {}}, wide(rays[i].direction));
    const auto truth = reference.first_crossing(line, 0, std::numeric_limits<double>::infinity());
    std::string problem;
    if (truth.empty()) {
      if (triangle[i] != -1) problem = "a hit where there is none";
    } else {
      ++found;
      const tetfmt::Side& met = file.sides[truth[0].side()];
      const auto input = origins.empty() ? met.triangle : origins[met.triangle];
      if (triangle[i] != input) problem = "another triangle than " + std::to_string(input);
      if (side[i] != (truth[0].back ? 1 : 0)) problem = "from the other side";
      if (tet_in[i] != met.tet || neighbor[i] != file.sides[tetfmt::twin(truth[0].side())].tet)
        problem = "tet or neighbor";
      const double slack = 1e-14 * std::abs(truth[0].low);
      if (line.sine(reference.surface().faces[truth[0].face]) > 0.02 &&
          !(t[i] >= truth[0].low - slack && t[i] <= truth[0].high + slack))
        problem = "t is not " + std::to_string(truth[0].low);
      if (!(u[i] >= 0 && v[i] >= 0 && u[i] + v[i] <= 1 + 1e-15)) problem = "u and v";
    }
    if (!problem.empty() && ++wrong <= 10)
      ADD_FAILURE() << "ray " << i << ", " << names[i] << ": " << std::hexfloat << rays[i].origin.x << ' '
                    << rays[i].origin.y << ' ' << rays[i].origin.z << " towards " << rays[i].direction.x
                    << ' ' << rays[i].direction.y << ' ' << rays[i].direction.z << ": " << problem;
  }
  EXPECT_EQ(wrong, 0U) << "of " << rays.size() << " answers";
  EXPECT_GT(found, rays.size() / 4) << "rays that miss show little";
}

INSTANTIATE_TEST_SUITE_P(Meshes, Differential, testing::ValuesIn(kSources),
                         [](const auto& test) { return std::string(test.param.name); });

}  // namespace
}  // namespace tetfmt_test
