// SPDX-License-Identifier: AGPL-3.0-or-later
// Sends the rays of one block through everything that can answer them, and has the answers judged.
#pragma once

#include <array>
#include <memory>
#include <vector>

#include "bench/judge.hpp"
#include "bench/rays.hpp"
#include "bench/scene.hpp"
#include "bench/tally.hpp"
#include "bench/tracer.hpp"
#include "tetfmt/batch.hpp"

namespace tetbench {

/// What is the same for all blocks of a scene. Any thread may use it.
struct Bench {
  explicit Bench(const std::string& path);
  Scene scene;
  Judge judge;
  RayMaker maker;
  Structures structures;
  std::array<std::unique_ptr<Tracer>, 2> peers;  ///< embree-1 and embree-1-robust, or none
};

/// Rays and segments that were answered one by one, kept to be asked once more, side by side.
struct Asked {
  std::vector<Start> starts;  ///< where rays and segments begin and end
  std::vector<tetfmt::BatchRay> rays;
  std::vector<tetfmt::Hit> hits;         ///< of each ray
  std::vector<tetfmt::Outcome> blocked;  ///< likewise
  std::vector<tetfmt::BatchSegment> segments;
  std::vector<tetfmt::Outcome> hidden;  ///< of each segment
  /// The place's number. The last one has one number however often it is asked for.
  std::uint32_t number_of(const Start& start);
};

class Tester {
 public:
  /// `bench` and `set` must outlive the tester.
  Tester(const Bench& bench, const RaySet& set, std::initializer_list<std::uint64_t> seeds)
      : bench_(bench), set_(set), dice_(seeds) {}

  /// Tests `count` rays, a little more if a sequence of bounces begins before the last one.
  void run(std::uint64_t count);
  Tally take() { return std::move(tally_); }

 private:
  void single(bool crossings);
  void shared();
  void bounces();
  void segment();

  Start locate(const tetfmt::Vec3f& point);
  /// A ray through everything. `crossings`: all of them, too.
  tetfmt::Hit ray(const Start& start, const tetfmt::Vec3f& direction, const tetfmt::Interval& interval,
                  bool crossings);
  void variants(const Start& start, const tetfmt::Vec3f& direction, const tetfmt::Hit& hit);
  Start side_of(const tetfmt::Hit& hit, bool far);
  void leave(const Start& start);
  tetfmt::Vec3f bounce(const Start& start, const tetfmt::Vec3f& incoming);
  Start segment_end();
  /// From a place to what its rays have met, and to others: one by one and together.
  void targets(const Start& from, const std::vector<tetfmt::Hit>& hits);
  /// What was asked since the last time, once more and side by side.
  void side_by_side();

  void report(const std::optional<Finding>& finding);
  /// What reproducers name from here on.
  void about(const Start& start, const Vec3d& direction, const tetfmt::Interval& interval);

  const Bench& bench_;
  const RaySet& set_;
  Dice dice_;
  Tally tally_;
  Reproducer current_;
  Asked asked_;
  std::optional<tetfmt::Cell> near_;  ///< where the last place was found
  Answers peers_answer_ = Answers(1);
};

}  // namespace tetbench
