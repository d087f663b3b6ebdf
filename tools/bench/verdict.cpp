// SPDX-License-Identifier: AGPL-3.0-or-later
#include "bench/verdict.hpp"

#include <algorithm>

#include "bench/dice.hpp"

namespace tetbench {
namespace {

using tetfmt::Index;
using tetfmt::Location;
using tetfmt::Outcome;

Place exact_place(const Judge& judge, const Location& location) {
  if (location.face == Location::kNoFace) return {location.position, {}};
  return judge.start_on_side(location, tetfmt::side_index(location.cell.neighbors[location.face])).place;
}

ExactLine line_of(const Scene& scene, const Judge& judge, const RayList& rays, std::size_t i) {
  const Place from = exact_place(judge, rays.places[rays.from[i]]);
  if (!rays.to.empty()) return {scene.surface(), from, exact_place(judge, rays.places[rays.to[i]])};
  const tetfmt::Vec3f& d = rays.directions[i];
  return {scene.surface(), from, Vec3d{double{d.x}, double{d.y}, double{d.z}}};
}

double end_of(const RayList& rays, std::size_t i) {
  return rays.to.empty() ? double{rays.t_max[i]} : 1;
}

/// What the kernel says: of occlusion whether, of the rest also on which side of which face.
Index kernel_side(const tetfmt::TrustedView& view, const RayList& rays, std::size_t i) {
  const Location& from = rays.places[rays.from[i]];
  if (rays.occlusion) {
    const Outcome outcome =
        rays.to.empty() ? tetfmt::occlusion(view, from, rays.directions[i], {0, double{rays.t_max[i]}})
                        : tetfmt::occlusion(view, from, rays.places[rays.to[i]]);
    return outcome == Outcome::hit ? kBlocked : tetfmt::kNone;
  }
  return tetfmt::first_hit(view, from, rays.directions[i], {0, double{rays.t_max[i]}}).side;
}

}  // namespace

Truth find_truth(const Scene& scene, const Judge& judge, const RayList& rays, std::size_t sample,
                 std::uint64_t seed) {
  const tetfmt::TrustedView& view = scene.view(0);
  Truth truth;
  truth.answers.resize(rays.size());
  std::vector<Index> sides(rays.size());
  for (std::size_t i = 0; i < rays.size(); ++i) {
    sides[i] = kernel_side(view, rays, i);
    const bool hit = sides[i] != tetfmt::kNone;
    truth.hits += hit ? 1 : 0;
    truth.answers[i] = hit && !rays.occlusion ? judge.triangle_of(sides[i]) : sides[i];
  }
  Dice dice({seed, 6});
  truth.sample = std::min(sample, rays.size());
  for (std::size_t k = 0; k < truth.sample; ++k) {
    const std::size_t i = truth.sample == rays.size() ? k : dice.below(rays.size());
    const auto first = scene.reference().first_crossing(line_of(scene, judge, rays, i), 0, end_of(rays, i));
    const Index side = first.empty() ? tetfmt::kNone : rays.occlusion ? kBlocked : first[0].side();
    truth.failed += side != sides[i] ? 1 : 0;
  }
  return truth;
}

PeerTally judged(const Scene& scene, const Judge& judge, const RayList& rays, const Truth& truth,
                 const Answers& answers, bool exact) {
  PeerTally tally;
  for (std::size_t i = 0; i < rays.size(); ++i) {
    if (answers[i] == truth.answers[i]) {
      ++tally.rays;
    } else if (rays.occlusion || exact) {
      ++tally.rays;
      ++(answers[i] == tetfmt::kNone ? tally.missed : tally.wrong);
    } else {
      const ExactLine line = line_of(scene, judge, rays, i);
      judge.peer(line, scene.reference().crossings(line, 0, end_of(rays, i)), answers[i], tally);
    }
  }
  return tally;
}

}  // namespace tetbench
