// SPDX-License-Identifier: AGPL-3.0-or-later
// A bounding-volume hierarchy that only ever says "perhaps": it names every triangle that a line could meet,
// and some that it does not. What is exact is decided by others (exact_reference.hpp).
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <utility>
#include <vector>

#include "bench/truth/surface.hpp"

namespace tetbench {

class BoxTree {
 public:
  BoxTree(std::span<const tetfmt::Vec3f> vertices, std::span<const Face> faces);

  /// Calls visit(face number) for every face whose box the line could meet at first <= t <= last, near boxes
  /// first. `visit` returns the new `last`, an upper bound of the t that are still of interest. `direction`
  /// may be off by one rounding a component, unless it is exactly zero there.
  template <class Visit>
  void visit(const Vec3d& origin, const Vec3d& direction, double first, double last, Visit&& visit) const;

 private:
  static constexpr double kNever = std::numeric_limits<double>::infinity();
  static constexpr std::uint32_t kLeaf = 4;     ///< faces in a leaf, at most
  static constexpr std::size_t kDeepest = 128;  ///< more than any tree is (build)
  struct Box {
    std::array<float, 3> low, high;
  };
  static constexpr float kFar = std::numeric_limits<float>::infinity();
  static constexpr Box kEmpty{{kFar, kFar, kFar}, {-kFar, -kFar, -kFar}};
  struct Node {
    Box box;
    std::uint32_t first =
        0;  ///< leaf: faces order_[first .. first + count); else the right child, the left follows
    std::uint32_t count = 0;
  };
  void build(std::uint32_t first, std::uint32_t last, std::span<const Box> boxes, int depth);

  std::vector<Node> nodes_;
  std::vector<std::uint32_t> order_;
};

template <class Visit>
void BoxTree::visit(const Vec3d& origin, const Vec3d& direction, double first, double last,
                    Visit&& visit) const {
  // The direction's rounding, its reciprocal's, a difference's and a product's: a relative error below 2^-50.
  // Widening both ends by 2^-48 keeps every box that the exact line meets.
  constexpr double kMargin = 0x1p-48;
  Vec3d inverse{};
  for (std::size_t k = 0; k < 3; ++k) inverse[k] = direction[k] == 0 ? 0 : 1 / direction[k];
  const auto entry = [&](const Box& box) {
    double enter = first, leave = last;
    for (std::size_t k = 0; k < 3; ++k) {
      const double low = static_cast<double>(box.low[k]), high = static_cast<double>(box.high[k]);
      if (direction[k] == 0) {
        if (origin[k] < low || origin[k] > high) return kNever;
        continue;
      }
      const double a = (low - origin[k]) * inverse[k], b = (high - origin[k]) * inverse[k];
      const double near = std::min(a, b), far = std::max(a, b);
      enter = std::max(enter, near - std::abs(near) * kMargin);
      leave = std::min(leave, far + std::abs(far) * kMargin);
    }
    return enter <= leave ? enter : kNever;
  };
  struct Entry {
    std::uint32_t node;
    double t;
  };
  if (nodes_.empty()) return;
  std::array<Entry, kDeepest> pending;
  std::size_t count = 0;
  const auto push = [&](const Entry& wanted) {
    if (wanted.t < kNever) pending[count++] = wanted;
  };
  push({0, entry(nodes_[0].box)});
  while (count > 0) {
    const auto [index, t] = pending[--count];
    if (!(t <= last)) continue;
    const Node& node = nodes_[index];
    if (node.count != 0) {
      for (std::uint32_t i = 0; i < node.count; ++i) last = visit(order_[node.first + i]);
      continue;
    }
    Entry left{index + 1, entry(nodes_[index + 1].box)};
    Entry right{node.first, entry(nodes_[node.first].box)};
    if (left.t < right.t) std::swap(left, right);
    push(left);
    push(right);
  }
}

}  // namespace tetbench
