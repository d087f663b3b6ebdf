// SPDX-License-Identifier: MIT
// Which boxes overlap a given one, by a binary tree over boxes that are near each other.
#pragma once

#include <algorithm>
#include <bit>
#include <cstdint>
#include <limits>
#include <numeric>
#include <vector>

#include "tetfmt/orientation.hpp"

namespace tetfmt::detail {

/// Axis-aligned and closed; empty (lower above upper) until a point is added.
struct GridBox {
  static constexpr std::int32_t kMost = std::numeric_limits<std::int32_t>::max();
  GridPoint lower{kMost, kMost, kMost}, upper{-kMost, -kMost, -kMost};

  void add(const GridPoint& point) {
    for (std::size_t i = 0; i < 3; ++i) {
      lower[i] = std::min(lower[i], point[i]);
      upper[i] = std::max(upper[i], point[i]);
    }
  }
  void add(const GridBox& other) {
    for (std::size_t i = 0; i < 3; ++i) {
      lower[i] = std::min(lower[i], other.lower[i]);
      upper[i] = std::max(upper[i], other.upper[i]);
    }
  }
  bool overlaps(const GridBox& other) const {
    for (std::size_t i = 0; i < 3; ++i)
      if (lower[i] > other.upper[i] || upper[i] < other.lower[i]) return false;
    return true;
  }
};

/// A complete binary tree, as an array: the children of node i are 2i and 2i + 1. Leaves are in Morton order.
class BoxTree {
 public:
  /// None of the boxes may be empty. O(n log n).
  explicit BoxTree(const std::vector<GridBox>& boxes)
      : leaves_(std::bit_ceil(std::max<std::size_t>(boxes.size(), 1))) {
    std::vector<std::uint64_t> key(boxes.size());
    for (std::size_t i = 0; i < boxes.size(); ++i) key[i] = morton(boxes[i]);
    order_.resize(boxes.size());
    std::iota(order_.begin(), order_.end(), std::uint32_t{0});
    std::sort(order_.begin(), order_.end(),
              [&](std::uint32_t a, std::uint32_t b) { return key[a] != key[b] ? key[a] < key[b] : a < b; });
    nodes_.resize(2 * leaves_);
    for (std::size_t i = 0; i < order_.size(); ++i) nodes_[leaves_ + i] = boxes[order_[i]];
    for (std::size_t i = leaves_ - 1; i > 0; --i) {
      nodes_[i] = nodes_[2 * i];
      nodes_[i].add(nodes_[2 * i + 1]);
    }
  }

  /// Calls visit(i) for every box i that overlaps the given one.
  template <class Visit>
  void overlapping(const GridBox& box, Visit&& visit) const {
    std::size_t node = 1;
    do {
      const bool meets = nodes_[node].overlaps(box);
      if (meets && node >= leaves_) visit(order_[node - leaves_]);
      // Down; or else to the next node that is not below this one, past all right children.
      if (meets && node < leaves_)
        node *= 2;
      else
        node = (node + 1) >> std::countr_zero(node + 1);
    } while (node != 1);
  }

 private:
  static std::uint64_t morton(const GridBox& box) {
    std::uint64_t key = 0;
    for (std::size_t i = 0; i < 3; ++i) {
      const std::int64_t middle = (std::int64_t{box.lower[i]} + box.upper[i]) / 2;
      // 21 bits of a coordinate below 2^26, spread to every third place.
      std::uint64_t x = static_cast<std::uint64_t>((middle + (std::int64_t{1} << 26)) >> 6) & 0x1FFFFF;
      x = (x | x << 32) & 0x1F00000000FFFF;
      x = (x | x << 16) & 0x1F0000FF0000FF;
      x = (x | x << 8) & 0x100F00F00F00F00F;
      x = (x | x << 4) & 0x10C30C30C30C30C3;
      x = (x | x << 2) & 0x1249249249249249;
      key |= x << i;
    }
    return key;
  }

  std::size_t leaves_;
  std::vector<std::uint32_t> order_;
  std::vector<GridBox> nodes_;
};

}  // namespace tetfmt::detail
