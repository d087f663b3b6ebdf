// SPDX-License-Identifier: AGPL-3.0-or-later
// A bounding-volume hierarchy that only ever says "perhaps": it names every triangle that a ray could meet,
// and some that it does not. What is exact is decided by others (exact_reference.hpp).
#pragma once

#include <array>
#include <cstddef>
#include <limits>
#include <span>
#include <utility>
#include <vector>

#include "tetfmt/layout.hpp"
#include "tetfmt/traverse.hpp"
#include "tetfmt/types.hpp"

namespace tetfmt_test {

class BoxTree {
 public:
  /// `triangles` are positions in the list that was given; dropped triangles are left out. O(n log n).
  BoxTree(std::span<const tetfmt::Vec3f> vertices, std::span<const tetfmt::Triangle> triangles);

  /// Calls visit(triangle) for every triangle whose box the ray could meet at 0 <= t <= limit, near boxes
  /// first. `visit` returns the new limit, an upper bound of the t that are still of interest.
  template <class Visit>
  void visit(const tetfmt::Ray& ray, double limit, Visit&& visit) const;

 private:
  static constexpr double kNever = std::numeric_limits<double>::infinity();
  struct Node {
    tetfmt::Bounds box;
    std::size_t first = 0, count = 0;  ///< leaf: order_[first .. first + count); inner node: count == 0
    std::size_t right = 0;             ///< inner node: the left child follows its parent
  };
  void build(std::size_t first, std::size_t last, std::span<const tetfmt::Bounds> boxes);
  /// A lower bound of the t at which the ray enters the box, or kNever if it cannot be in it at t <= limit.
  static double entry(const tetfmt::Bounds& box, const tetfmt::Ray& ray, double limit);

  std::vector<Node> nodes_;
  std::vector<tetfmt::Index> order_;
};

template <class Visit>
void BoxTree::visit(const tetfmt::Ray& ray, double limit, Visit&& visit) const {
  struct Entry {
    std::size_t node;
    double t;
  };
  if (nodes_.empty()) return;
  // The limit may be infinite, so that "never" needs a test of its own.
  const auto wanted = [&limit](double t) { return t < kNever && t <= limit; };
  std::vector<Entry> pending = {{0, entry(nodes_[0].box, ray, limit)}};
  while (!pending.empty()) {
    const auto [index, t] = pending.back();
    pending.pop_back();
    if (!wanted(t)) continue;
    const Node& node = nodes_[index];
    if (node.count != 0) {
      for (std::size_t i = 0; i < node.count; ++i) limit = visit(order_[node.first + i]);
      continue;
    }
    Entry left{index + 1, entry(nodes_[index + 1].box, ray, limit)};
    Entry right{node.right, entry(nodes_[node.right].box, ray, limit)};
    if (left.t < right.t) std::swap(left, right);
    if (wanted(left.t)) pending.push_back(left);
    if (wanted(right.t)) pending.push_back(right);
  }
}

}  // namespace tetfmt_test
