// SPDX-License-Identifier: AGPL-3.0-or-later
// The rays that `tet bench` times are those that it says, in both of their forms; and what is counted as an
// error is one.
#include "bench/workload.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <map>

#include "bench/verdict.hpp"
#include "support/lattice_mesh.hpp"
#include "tetfmt/encode.hpp"

namespace tetfmt_test {
namespace {

using tetbench::PeerRay;
using tetbench::RayList;
using tetfmt::Location;
using tetfmt::Vec3f;

/// A box without the wall that faces the camera: rays see its inside, and from there some see out.
class WorkloadTest : public testing::Test {
 protected:
  WorkloadTest() : file_(write()), scene_(file_), judge_(scene_) { options_.size = 32; }
  ~WorkloadTest() override { std::filesystem::remove(file_); }

  static std::string write() {
    LatticeOptions box;
    box.low = 2;
    box.walls = 31;
    box.one_triangle_a_face = true;
    const auto bytes = tetfmt::encode(lattice_mesh(8, box), tetfmt::Layout::tet16);
    const auto* test = testing::UnitTest::GetInstance()->current_test_info();
    const std::string path = testing::TempDir() + "workload_" + test->name() + ".tet";
    std::ofstream(path, std::ios::binary)
        .write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
    return path;
  }
  RayList make(const std::string& name) const {
    for (const tetbench::WorkloadKind& kind : tetbench::workload_kinds())
      if (kind.name == name) return kind.make(scene_, options_);
    ADD_FAILURE() << "no workload " << name;
    return {};
  }

  std::string file_;
  tetbench::Scene scene_;
  tetbench::Judge judge_;
  tetbench::WorkloadOptions options_;
};

TEST_F(WorkloadTest, BothFormsOfARayAreTheSameRay) {
  for (const tetbench::WorkloadKind& kind : tetbench::workload_kinds()) {
    const RayList rays = kind.make(scene_, options_);
    ASSERT_GT(rays.size(), 100U) << kind.name;
    ASSERT_EQ(rays.from.size(), rays.size());
    ASSERT_EQ(rays.t_max.size(), rays.size());
    ASSERT_EQ(rays.packets.size(), (rays.size() + 15) / 16);
    ASSERT_TRUE(rays.to.empty() || rays.to.size() == rays.size());
    for (std::size_t i = 0; i < rays.size(); ++i) {
      const PeerRay peer = rays.peer(i);
      const Location& from = rays.places[rays.from[i]];
      ASSERT_NE(from.state, Location::State::corrupt) << kind.name;
      EXPECT_EQ(peer.direction, rays.directions[i]);
      EXPECT_EQ(peer.t_max, rays.t_max[i]);
      const bool on_surface = from.face != Location::kNoFace;
      const std::array<float, 3> origin = {peer.origin.x, peer.origin.y, peer.origin.z},
                                 along = {peer.direction.x, peer.direction.y, peer.direction.z};
      for (std::size_t k = 0; k < 3; ++k) {
        // Rounded where it is on a surface; else exactly the place.
        const double rounded = static_cast<double>(static_cast<float>(from.position[k]));
        EXPECT_EQ(origin[k], on_surface ? rounded : from.position[k]) << kind.name;
        if (rays.to.empty()) continue;
        EXPECT_NEAR(origin[k] + along[k], rays.places[rays.to[i]].position[k], 1e-5) << kind.name;
      }
      EXPECT_EQ(peer.t_min > 0, on_surface) << kind.name;
    }
  }
}

TEST_F(WorkloadTest, RaysFromSurfacesLeaveTheirFace) {
  for (const char* name : {"ao-unbounded", "shadow", "paths"}) {
    const RayList rays = make(name);
    for (std::size_t i = 0; i < rays.size(); ++i) {
      const Location& from = rays.places[rays.from[i]];
      ASSERT_LT(from.face, Location::kNoFace) << name;
      const tetfmt::Hit hit = tetfmt::first_hit(scene_.view(0), from, rays.directions[i]);
      EXPECT_FALSE(hit.outcome == tetfmt::Outcome::hit && hit.t == 0) << name << " " << i;
    }
  }
}

TEST_F(WorkloadTest, ReachOfAmbientOcclusionIsThatOfItsName) {
  // The surface is the box [2, 6]^3.
  const double diagonal = std::sqrt(48.0);
  const auto hits = [&](const RayList& rays) {
    return tetbench::find_truth(scene_, judge_, rays, rays.size(), 1).hits;
  };
  const RayList far = make("ao-unbounded"), tenth = make("ao-10"), fiftieth = make("ao-2");
  EXPECT_TRUE(far.unbounded());
  EXPECT_FLOAT_EQ(tenth.t_max[0], static_cast<float>(0.1 * diagonal));
  EXPECT_FLOAT_EQ(fiftieth.t_max[0], static_cast<float>(0.02 * diagonal));
  EXPECT_GT(hits(far), hits(tenth));
  EXPECT_GT(hits(tenth), hits(fiftieth));
  EXPECT_EQ(far.size() % 4, 0U);
}

TEST_F(WorkloadTest, OrderIsAllThatShufflingChanges) {
  const RayList rays = make("ao-10"), mixed = tetbench::shuffled(rays, 9);
  ASSERT_EQ(mixed.size(), rays.size());
  EXPECT_FALSE(mixed.coherent);
  const auto names = [](const RayList& list) {
    std::vector<std::array<float, 6>> result;
    for (std::size_t i = 0; i < list.size(); ++i) {
      const PeerRay r = list.peer(i);
      result.push_back({r.origin.x, r.origin.y, r.origin.z, r.direction.x, r.direction.y, r.direction.z});
    }
    return result;
  };
  auto before = names(rays), after = names(mixed);
  EXPECT_NE(before, after);
  std::sort(before.begin(), before.end());
  std::sort(after.begin(), after.end());
  EXPECT_EQ(before, after);
  EXPECT_EQ(names(mixed), names(tetbench::shuffled(rays, 9)));
}

TEST_F(WorkloadTest, RoomIsSeenFromWithin) {
  const RayList rays = make("room");
  ASSERT_TRUE(rays.one_origin());
  for (const double x : rays.places[0].position) {
    EXPECT_GT(x, 2);
    EXPECT_LT(x, 6);
  }
  // All but the open wall: five of six views.
  const auto truth = tetbench::find_truth(scene_, judge_, rays, 0, 1);
  EXPECT_GT(truth.hits, rays.size() / 2);
  EXPECT_LT(truth.hits, rays.size());
}

TEST_F(WorkloadTest, VerdictsCountWhatIsWrong) {
  for (const char* name : {"camera-9", "ao-unbounded", "shadow", "paths", "lines", "vertices"}) {
    const RayList rays = make(name);
    const auto truth = tetbench::find_truth(scene_, judge_, rays, rays.size(), 1);
    EXPECT_EQ(truth.sample, rays.size());
    EXPECT_EQ(truth.failed, 0U) << name;
    const auto right = tetbench::judged(scene_, judge_, rays, truth, truth.answers, true);
    EXPECT_EQ(right.rays, rays.size());
    EXPECT_EQ(right.wrong + right.missed, 0U);

    // Each answer is spoilt in turn: something where nothing is, nothing where something is.
    tetbench::Answers spoilt = truth.answers;
    for (tetfmt::Index& answer : spoilt) answer = answer == tetfmt::kNone ? 0 : tetfmt::kNone;
    const auto verdict = tetbench::judged(scene_, judge_, rays, truth, spoilt, true);
    EXPECT_EQ(verdict.missed, truth.hits) << name;
    EXPECT_EQ(verdict.wrong, rays.size() - truth.hits) << name;
  }
}

TEST_F(WorkloadTest, AnotherTriangleIsWrongUnlessTheRayMeetsBothAtTheirEdge) {
  // Onto the wall z = 2 through the open side: at a diagonal that two triangles share, and beside it.
  RayList rays;
  const auto add = [&](Vec3f origin) {
    rays.add(rays.add_place(tetfmt::locate(scene_.view(0), origin)), {origin, {0, 0, -1}});
  };
  add({3.5F, 3.5F, 7});
  add({3.625F, 3.5F, 7});
  const auto truth = tetbench::find_truth(scene_, judge_, rays, 2, 1);
  ASSERT_EQ(truth.hits, 2U);
  EXPECT_EQ(truth.failed, 0U);
  tetbench::Answers others = truth.answers;
  const auto& triangles = scene_.view(0).view().input_triangles();
  for (tetfmt::Index& answer : others)
    for (tetfmt::Index other = 0; other < triangles.size(); ++other) {
      const auto& a = triangles[answer].vertices;
      const auto& b = triangles[other].vertices;
      const auto shared = std::count_if(a.begin(), a.end(),
                                        [&](auto v) { return std::find(b.begin(), b.end(), v) != b.end(); });
      // Its neighbour in the same lattice square: both have the square's diagonal.
      const auto& p = scene_.view(0).view().vertices();
      bool flat = shared == 2 && other != answer;
      for (const tetfmt::Index v : b)
        flat = flat && p[v].z == 2 && p[v].x >= 3 && p[v].x <= 4 && p[v].y >= 3 && p[v].y <= 4;
      if (!flat) continue;
      answer = other;
      break;
    }
  ASSERT_NE(others[0], truth.answers[0]);
  ASSERT_NE(others[1], truth.answers[1]);
  const auto peer = tetbench::judged(scene_, judge_, rays, truth, others, false);
  EXPECT_EQ(peer.rays, 2U);
  EXPECT_EQ(peer.wrong, 1U);
  EXPECT_EQ(peer.missed, 0U);
  EXPECT_EQ(tetbench::judged(scene_, judge_, rays, truth, others, true).wrong, 2U) << "of an exact tracer";
}

TEST_F(WorkloadTest, EveryTracerOfThisBuildAnswersWhatItTakes) {
  tetbench::Structures structures(scene_);
  std::map<std::string, std::size_t> taken;
  for (const tetbench::TracerKind& kind : tetbench::tracer_kinds()) {
    const auto tracer = kind.make(structures);
    EXPECT_GT(tracer->structure().bytes, 0U) << kind.name;
    for (const char* name : {"camera-6.5", "ao-10", "shadow", "lines"}) {
      const RayList rays = make(name);
      if (!tracer->takes(rays)) continue;
      ++taken[kind.name];
      const auto truth = tetbench::find_truth(scene_, judge_, rays, 100, 1);
      tetbench::Answers answers(rays.size());
      tracer->trace(rays, answers);
      const auto verdict = tetbench::judged(scene_, judge_, rays, truth, answers, kind.exact);
      EXPECT_EQ(verdict.rays, rays.size());
      // Walls in the planes of lattice points: where signs are not exact a few go astray, not more.
      EXPECT_LE(verdict.wrong + verdict.missed, kind.exact ? 0 : rays.size() / 20)
          << kind.name << ", " << name;
    }
  }
  for (const char* all : {"tet20-exact", "tet16-exact", "tet20-batch", "tet16-batch", "bvh", "kd-tree"})
    EXPECT_EQ(taken[all], 4U) << all;
  EXPECT_EQ(taken["tet20-together"], 2U);  // from the camera, and to the lamp
}

}  // namespace
}  // namespace tetfmt_test
