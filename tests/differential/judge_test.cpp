// SPDX-License-Identifier: AGPL-3.0-or-later
// The judge of the stress test must condemn: a right answer, spoilt in each of its parts in turn.
#include "bench/judge.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <limits>

#include "support/lattice_mesh.hpp"
#include "tetfmt/encode.hpp"

namespace tetfmt_test {
namespace {

using tetbench::Fault;
using tetfmt::Hit;
using tetfmt::Outcome;

/// The 6 x 6 x 6 lattice around the inner box [2, 4]^3: two triangles a wall, four faces each.
class JudgeTest : public testing::Test {
 protected:
  JudgeTest() : file_(write()), scene_(file_), judge_(scene_) {
    const tetfmt::Vec3f eye = {2.375F, 3.25F, 0.5F};
    start_ = judge_.start(tetfmt::locate(scene_.view(0), eye), eye);
    line_.emplace(scene_.surface(), start_.place, tetbench::Vec3d{0, 0, 0.75});
    truth_ = scene_.reference().crossings(*line_, 0, std::numeric_limits<double>::infinity());
    hit_ = tetfmt::first_hit(scene_.view(0), start_.location, {0, 0, 0.75F});
    tetfmt::all_hits(scene_.view(0), start_.location, {0, 0, 0.75F}, hits_);
  }
  ~JudgeTest() override { std::filesystem::remove(file_); }

  static std::string write() {
    LatticeOptions box;
    box.low = 2;
    box.high = 4;
    const auto bytes = tetfmt::encode(lattice_mesh(6, box), tetfmt::Layout::tet20);
    const auto* test = testing::UnitTest::GetInstance()->current_test_info();
    const std::string path = testing::TempDir() + "judge_" + test->name() + ".tet";
    std::ofstream(path, std::ios::binary)
        .write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
    return path;
  }

  /// What is found wrong with the first hit once `spoil` has changed it.
  template <class Spoil>
  std::optional<Fault> verdict(Spoil&& spoil) {
    Hit hit = hit_;
    spoil(hit);
    const auto finding = judge_.first_hit(*line_, start_, {}, truth_, hit, tally_);
    return finding ? std::optional(finding->fault) : std::nullopt;
  }
  template <class Spoil>
  std::optional<Fault> verdict_of_all(Spoil&& spoil) {
    std::vector<Hit> hits = hits_;
    spoil(hits);
    const auto finding = judge_.all_hits(*line_, start_, {}, truth_, Outcome::miss, hits, tally_);
    return finding ? std::optional(finding->fault) : std::nullopt;
  }

  std::string file_;
  tetbench::Scene scene_;
  tetbench::Judge judge_;
  tetbench::Start start_;
  std::optional<tetbench::ExactLine> line_;
  std::vector<tetbench::Crossing> truth_;
  Hit hit_;
  std::vector<Hit> hits_;
  tetbench::Tally tally_;
};

TEST_F(JudgeTest, RightAnswersPass) {
  ASSERT_EQ(truth_.size(), 2U);
  EXPECT_EQ(hit_.t, 2);
  EXPECT_EQ(verdict([](Hit&) {}), std::nullopt);
  EXPECT_EQ(verdict_of_all([](auto&) {}), std::nullopt);
  EXPECT_EQ(tally_.steep.count(), 3U);
  EXPECT_NEAR(tally_.steep.max(), 1.0 / 3, 1e-9) << "t = 14 / 3; the others are exact";
}

TEST_F(JudgeTest, EveryPartOfAHitIsLookedAt) {
  EXPECT_EQ(verdict([](Hit& h) { h = {}; }), Fault::missed);
  EXPECT_EQ(verdict([](Hit& h) { h.outcome = Outcome::corrupt; }), Fault::hung);
  EXPECT_EQ(verdict([](Hit& h) { h.outcome = Outcome::absent; }), Fault::wrong);
  EXPECT_EQ(verdict([](Hit& h) { h.steps = 1U << 30U; }), Fault::hung);
  EXPECT_EQ(verdict([](Hit& h) { h.back = !h.back; }), Fault::wrong);
  EXPECT_EQ(verdict([](Hit& h) { h.side ^= 1U; }), Fault::wrong);
  EXPECT_EQ(verdict([](Hit& h) { h.side += 2; }), Fault::wrong);
  EXPECT_EQ(verdict([](Hit& h) { ++h.triangle; }), Fault::wrong);
  EXPECT_EQ(verdict([](Hit& h) { ++h.tet; }), Fault::wrong);
  EXPECT_EQ(verdict([](Hit& h) { h.neighbor = tetfmt::kNone; }), Fault::wrong);
  EXPECT_EQ(verdict([](Hit& h) { ++h.face[1]; }), Fault::wrong);
  EXPECT_EQ(verdict([](Hit& h) { h.t = std::nextafter(h.t, 3); }), std::nullopt) << "one ulp is allowed";
  EXPECT_EQ(verdict([](Hit& h) { h.t += 5 * 0x1p-51; }), Fault::wrong) << "five are not";
  EXPECT_EQ(verdict([](Hit& h) { h.t = std::nan(""); }), Fault::wrong);
  EXPECT_EQ(verdict([](Hit& h) { h.u += 1e-9; }), Fault::wrong);
  EXPECT_EQ(verdict([](Hit& h) { h.side_v -= 1e-9; }), Fault::wrong);
  EXPECT_EQ(verdict([](Hit& h) { h.u = h.side_u = -1; }), Fault::wrong);
  // A hit where there is none; and one of the face that the ray starts on.
  truth_.clear();
  EXPECT_EQ(verdict([](Hit&) {}), Fault::false_hit);
  start_.side = hit_.side;
  EXPECT_EQ(verdict([](Hit&) {}), Fault::self_hit);
}

TEST_F(JudgeTest, AllHitsAreLookedAt) {
  EXPECT_EQ(verdict_of_all([](auto& hits) { hits.pop_back(); }), Fault::missed);
  EXPECT_EQ(verdict_of_all([](auto& hits) { hits.push_back(hits[0]); }), Fault::doubled);
  EXPECT_EQ(verdict_of_all([](auto& hits) { std::swap(hits[0], hits[1]); }), Fault::doubled);
  EXPECT_EQ(verdict_of_all([](auto& hits) {
              hits.push_back(hits[0]);
              hits.back().side += 2;
            }),
            Fault::false_hit);
  EXPECT_EQ(verdict_of_all([](auto& hits) { hits[1].t *= 2; }), Fault::wrong);
}

TEST_F(JudgeTest, PlacesAreLookedAt) {
  EXPECT_FALSE(judge_.location(start_));
  const auto condemned = [&](auto&& spoil) {
    tetbench::Start start = start_;
    spoil(start.location);
    const auto finding = judge_.location(start);
    return finding && finding->fault == Fault::started;
  };
  using tetfmt::Location;
  EXPECT_TRUE(condemned([](Location& at) { at.state = Location::State::outside; }));
  EXPECT_TRUE(condemned([](Location& at) { at.position[1] += 0x1p-40; }));
  EXPECT_TRUE(condemned([](Location& at) { std::swap(at.cell.neighbors[0], at.cell.neighbors[1]); }));
  EXPECT_TRUE(condemned([&](Location& at) {
    const tetfmt::Index next = (at.cell.tet + 1) % static_cast<tetfmt::Index>(scene_.mesh().tets.size());
    at.cell = {next, scene_.mesh().tets[next].vertices, scene_.mesh().tets[next].neighbors};
  }));

  const auto side = judge_.start_on_side(tetfmt::near_side(scene_.view(0).view(), hit_), hit_.side);
  EXPECT_FALSE(judge_.side_location(side, hit_));
  const auto side_condemned = [&](auto&& spoil) {
    tetbench::Start start = side;
    spoil(start.location);
    return judge_.side_location(start, hit_).has_value();
  };
  EXPECT_TRUE(side_condemned([](Location& at) { at.position[2] += 0x1p-50; })) << "off the plane";
  EXPECT_TRUE(side_condemned([](Location& at) { at.position[0] += 0.5; })) << "off the hit's point";
  EXPECT_TRUE(side_condemned([](Location& at) { at.face = static_cast<std::uint8_t>((at.face + 1) % 4); }));
  const auto far = tetfmt::far_side(scene_.view(0).view(), hit_);
  EXPECT_TRUE(judge_.side_location(judge_.start_on_side(far, hit_.side), hit_)) << "the other side's place";
  EXPECT_FALSE(judge_.side_location(judge_.start_on_side(far, tetfmt::twin(hit_.side)), hit_));
}

}  // namespace
}  // namespace tetfmt_test
