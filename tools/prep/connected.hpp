// SPDX-License-Identifier: AGPL-3.0-or-later
// Connected parts of a large graph, found by all threads at once.
#pragma once

#include <tbb/parallel_for.h>

#include <atomic>
#include <utility>
#include <vector>

#include "prep/prep.hpp"

namespace tetprep {

/// Sets of the numbers 0 to count - 1, each known by its smallest member. A forest whose links lead to
/// smaller numbers, so there is no cycle whatever order threads work in, and the result does not depend on it
/// (Jayanti and Tarjan 2016, "A randomized concurrent algorithm for disjoint set union", with numbers in
/// their given order, which here follows space).
class DisjointSets {
 public:
  explicit DisjointSets(std::size_t count) : parent_(count) {
    tbb::parallel_for(std::size_t{0}, count, [&](std::size_t i) { parent_[i] = static_cast<Index>(i); });
  }

  /// The smallest number of the set that `i` is in. Threads may call this and unite() at the same time.
  Index find(Index i) {
    while (true) {
      const Index up = load(i);
      if (up == i) return i;
      const Index further = load(up);
      if (further == up) return up;
      Index expected = up;  // halves the path; if another thread was faster, the path is short already
      std::atomic_ref(parent_[i]).compare_exchange_weak(expected, further, std::memory_order_relaxed);
      i = further;
    }
  }

  void unite(Index a, Index b) {
    while (true) {
      a = find(a);
      b = find(b);
      if (a == b) return;
      if (a < b) std::swap(a, b);
      Index expected = a;
      if (std::atomic_ref(parent_[a]).compare_exchange_strong(expected, b, std::memory_order_relaxed)) return;
    }
  }

 private:
  Index load(Index i) { return std::atomic_ref(parent_[i]).load(std::memory_order_relaxed); }
  std::vector<Index> parent_;
};

}  // namespace tetprep
