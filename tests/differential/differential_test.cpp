// SPDX-License-Identifier: AGPL-3.0-or-later
// Real meshes through `tet convert` and `tet query`, both layouts, against exact arithmetic: 100,000 rays a
// mesh, a third of them aimed at what is hard. The reference reads the triangles that the file stores and
// nothing else.
#include <gtest/gtest.h>
#include <sys/wait.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <iterator>
#include <set>

#include "differential/exact_reference.hpp"
#include "differential/npy.hpp"
#include "differential/rays.hpp"
#include "tetfmt/mapped_file.hpp"
#include "tetfmt/validate.hpp"

namespace tetfmt_test {
namespace {

namespace fs = std::filesystem;
using tetfmt::Index;

constexpr std::size_t kRays = 100'000;

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
    {"armadillo", "data/meshes/armadillo.off", "a scan", "torus-knot --triangles 52000"},
    {"elephant", "data/meshes/refined_elephant.off", "many small triangles", "sphere --triangles 80000"},
    {"dino", "data/meshes/dino.off", "a scan with colours", "torus-knot --triangles 8000"},
    {"lion_head", "data/meshes/lion-head.off", "an open scan", "bumpy-plane --triangles 16000"},
    {"three_peaks", "data/meshes/three_peaks.off", "an open height field", "bumpy-plane --triangles 4000"},
    {"fandisk", "data/meshes/fandisk.off", "a CAD part", "sphere --triangles 500"},
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

/// A tet file that validated at level geometry.
struct Opened {
  explicit Opened(const fs::path& path)
      : file(tetfmt::MappedFile::open(path.string())),
        trusted(tetfmt::TrustedView::validated(file.value().bytes())) {}
  const tetfmt::FileView& view() const { return trusted->view(); }
  tetfmt::Result<tetfmt::MappedFile> file;
  tetfmt::Result<tetfmt::TrustedView> trusted;
};

/// The sides of each constrained face name its tets: `tet` and `neighbor` of a hit must be a face's two
/// sides.
using FaceTets = std::set<std::array<std::int64_t, 3>>;  // triangle, tet on this side, tet beyond

FaceTets face_tets(const tetfmt::FileView& view, std::int64_t met_side) {
  FaceTets result;
  const auto sides = view.sides();
  for (std::size_t s = static_cast<std::size_t>(met_side); s < sides.size(); s += 2) {
    result.insert({sides[s].triangle, sides[s].tet, sides[s ^ 1].tet});
  }
  return result;
}

class Differential : public testing::TestWithParam<Source> {};

TEST_P(Differential, FirstHitsOfBothLayoutsAreExact) {
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
  const Opened opened(folder / "tet20.tet");
  const Opened other(folder / "tet16.tet");
  ASSERT_TRUE(opened.trusted) << tetfmt::to_string(opened.trusted.error());
  ASSERT_TRUE(other.trusted) << tetfmt::to_string(other.trusted.error());
  const tetfmt::FileView& view = opened.view();
  ASSERT_TRUE(std::ranges::equal(view.vertices(), other.view().vertices()));

  const auto families = make_rays(view, kRays, 2022);
  std::vector<tetfmt::Ray> rays;
  for (const RayFamily& family : families) rays.insert(rays.end(), family.rays.begin(), family.rays.end());
  ASSERT_EQ(rays.size(), kRays);
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
  const ExactReference reference(view.vertices(), view.triangles());
  const std::array<FaceTets, 2> faces = {face_tets(view, 0), face_tets(view, 1)};

  std::cout << mesh.filename().string() << " (for: " << source.about << "): " << view.triangles().size()
            << " triangles, " << view.tet_count() << " tets\n";
  std::size_t i = 0, wrong = 0, edge_hits = 0, vertex_hits = 0, total_hits = 0;
  for (const RayFamily& family : families) {
    std::size_t found = 0, on_edge = 0, on_vertex = 0, grazes = 0;
    for (const tetfmt::Ray& ray : family.rays) {
      const Answer answer{static_cast<std::int64_t>(triangle[i]), t[i], u[i], v[i],
                          static_cast<int>(side[i])};
      const auto barrier = reference.barrier(ray);
      std::string problem = reference.judge(ray, barrier, answer);
      if (problem.empty() && answer.triangle >= 0 &&
          !faces.at(static_cast<std::size_t>(answer.side))
               .contains({answer.triangle, static_cast<std::int64_t>(tet_in[i]),
                          static_cast<std::int64_t>(neighbor[i])})) {
        problem = "tet and neighbor are not the two sides of a face of the triangle";
      }
      if (!problem.empty() && ++wrong <= 10) {
        ADD_FAILURE() << "ray " << i << ", " << family.name << ": " << std::hexfloat << ray.origin.x << ' '
                      << ray.origin.y << ' ' << ray.origin.z << " towards " << ray.direction.x << ' '
                      << ray.direction.y << ' ' << ray.direction.z << ": " << problem;
      }
      found += answer.triangle >= 0 ? 1 : 0;
      on_edge += barrier && barrier->kind == Barrier::Kind::edge ? 1 : 0;
      on_vertex += barrier && barrier->kind == Barrier::Kind::vertex ? 1 : 0;
      grazes += answer.triangle >= 0 && !barrier ? 1 : 0;
      ++i;
    }
    std::cout << "  " << family.name << ": " << family.rays.size() << " rays, " << found
              << " hits, first crossing " << on_edge << " times an edge, " << on_vertex << " times a vertex; "
              << grazes << " hits only graze\n";
    total_hits += found;
    edge_hits += on_edge;
    vertex_hits += on_vertex;
  }
  EXPECT_EQ(wrong, 0U) << "of " << rays.size() << " answers";
  // The rays must have been what they claim to be, or the test has shown little.
  EXPECT_GT(total_hits, kRays / 10);
  EXPECT_GT(edge_hits, kRays / 100);
  EXPECT_GT(vertex_hits, kRays / 100);
}

INSTANTIATE_TEST_SUITE_P(Meshes, Differential, testing::ValuesIn(kSources),
                         [](const auto& test) { return std::string(test.param.name); });

}  // namespace
}  // namespace tetfmt_test
