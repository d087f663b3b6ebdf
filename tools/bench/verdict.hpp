// SPDX-License-Identifier: AGPL-3.0-or-later
// Which answers of a workload are wrong, by exact arithmetic.
#pragma once

#include "bench/judge.hpp"
#include "bench/ray_list.hpp"
#include "bench/tracer.hpp"

namespace tetbench {

/// The exact kernel's answers, of which a sample is held against exact arithmetic that shares no code with
/// it.
struct Truth {
  Answers answers;
  std::size_t hits = 0;    ///< answers that are not kNone
  std::size_t sample = 0;  ///< rays asked of the exact reference
  std::size_t failed = 0;  ///< those of them that the kernel has wrong: face, side or outcome
};

/// `sample`: how many rays, drawn by the seed; all of them if there are fewer.
Truth find_truth(const Scene& scene, const Judge& judge, const RayList& rays, std::size_t sample,
                 std::uint64_t seed);

/// Of a tracer's answers, those that are wrong: another triangle, or something in the way where there is
/// nothing; and missed: nothing where there is something. Of a tracer that is not meant to be exact, an
/// answer that differs is first judged by the exact reference, for where a ray meets an edge or a vertex
/// exactly, any of the triangles there is right (Judge::peer). Of occlusion nothing is judged again: whether
/// a ray that only touches an edge or a vertex is blocked follows the exact kernel's rule for ties, and a
/// peer that says otherwise is wrong or missed.
PeerTally judged(const Scene& scene, const Judge& judge, const RayList& rays, const Truth& truth,
                 const Answers& answers, bool exact);

}  // namespace tetbench
