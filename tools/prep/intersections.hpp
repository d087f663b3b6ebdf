// SPDX-License-Identifier: AGPL-3.0-or-later
// Triangles that meet where they should not, found while something else runs.
#pragma once

#include <atomic>
#include <exception>
#include <thread>
#include <utility>
#include <vector>

#include "prep/prep.hpp"

namespace tetprep {

/// True if the triangles have a point in common beyond the corners and the edge that they share by index.
/// Overlap in a plane counts. Exact. They must not share all three corners.
bool triangles_intersect(const std::vector<GridPoint>& points, const std::array<Index, 3>& a,
                         const std::array<Index, 3>& b);

/// All intersecting pairs, ascending, in which at least one triangle is marked in `active` (empty: all are).
/// The same for any number of threads. If there are more than `most_pairs`, that many of them. Stops when
/// `cancelled` becomes true, with some of them. `found_count` grows as they are found. The work is spread by
/// oneTBB. O(triangles log triangles) for surfaces whose triangles have few others near them.
std::vector<TrianglePair> find_intersections(const std::vector<GridPoint>& points,
                                             const std::vector<std::array<Index, 3>>& triangles,
                                             const std::vector<bool>& active, std::size_t most_pairs,
                                             const std::atomic<bool>& cancelled,
                                             std::atomic<std::size_t>& found_count);

/// Looks for all intersecting pairs in a thread of its own. `surface` must outlive it.
class IntersectionSearch {
 public:
  /// `threads`: how many may work on it, at least 1.
  IntersectionSearch(const CleanSurface& surface, unsigned threads);
  static constexpr std::size_t kMostPairs = 1'000'000;

  /// Gives up, if it has not ended.
  ~IntersectionSearch();
  IntersectionSearch(const IntersectionSearch&) = delete;
  IntersectionSearch& operator=(const IntersectionSearch&) = delete;

  /// Whether a pair has been found yet.
  bool found_any() const { return found_count_.load(std::memory_order_relaxed) > 0; }
  /// Waits for the end. All pairs, ascending, or kMostPairs of them if a hopeless input has more; the same
  /// for any number of threads.
  const std::vector<TrianglePair>& wait();

 private:
  std::atomic<bool> cancelled_{false};
  std::atomic<std::size_t> found_count_{0};
  std::vector<TrianglePair> pairs_;
  std::exception_ptr error_;
  std::thread thread_;  ///< last: it uses the members above
};

}  // namespace tetprep
