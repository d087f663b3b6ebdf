// SPDX-License-Identifier: AGPL-3.0-or-later
// Which boxes overlap: a tree of eight children a node over boxes sorted along a Hilbert curve, kept as plain
// arrays level by level. Nothing is built but the sorted order, so it is cheap to throw away.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <vector>

#include "prep/prep.hpp"

namespace tetprep {

/// Closed, in grid steps.
struct GridBox {
  GridPoint low, high;
};

inline GridBox box_around(const std::vector<GridPoint>& points, const std::array<Index, 3>& triangle) {
  GridBox box{points[triangle[0]], points[triangle[0]]};
  for (const Index corner : {triangle[1], triangle[2]})
    for (std::size_t k = 0; k < 3; ++k) {
      box.low[k] = std::min(box.low[k], points[corner][k]);
      box.high[k] = std::max(box.high[k], points[corner][k]);
    }
  return box;
}

/// Eight boxes, side by side for the vector unit.
struct EightBoxes {
  std::array<std::array<std::int32_t, 8>, 3> low, high;

  void set(std::size_t i, const GridBox& box) {
    for (std::size_t k = 0; k < 3; ++k) {
      low[k][i] = box.low[k];
      high[k][i] = box.high[k];
    }
  }
  GridBox get(std::size_t i) const {
    return {{low[0][i], low[1][i], low[2][i]}, {high[0][i], high[1][i], high[2][i]}};
  }
  /// Bit i: box i has a point in common with `box`.
  unsigned overlapping(const GridBox& box) const;
  /// The smallest box around all.
  GridBox bounds() const;
};

class BoxTree {
 public:
  static constexpr std::size_t kWidth = 8;

  /// `items`: the boxes' numbers; at least one. `box_of(item)` gives a GridBox.
  template <class BoxOf>
  BoxTree(std::vector<Index> items, const BoxOf& box_of) : items_(std::move(items)) {
    std::vector<GridBox> boxes;
    boxes.reserve(items_.size());
    for (const Index item : items_) boxes.push_back(box_of(item));
    build(std::move(boxes));
  }

  /// Leaves hold up to kWidth items each, next to each other in space. Their number.
  std::size_t leaves() const { return levels_.front().size(); }
  const EightBoxes& leaf(std::size_t number) const { return levels_.front()[number]; }
  /// Place i of a leaf; kNone beyond the last item.
  Index item(std::size_t leaf, std::size_t i) const {
    const std::size_t place = leaf * kWidth + i;
    return place < items_.size() ? items_[place] : kNone;
  }

  /// False only if no item overlaps `box`.
  bool may_overlap(const GridBox& box) const { return levels_.back().front().overlapping(box) != 0; }

  /// Calls visit(leaf) for each leaf from `first` on whose bounds overlap `box`, in ascending order.
  template <class Visit>
  void visit_leaves(const GridBox& box, std::size_t first, const Visit& visit) const {
    struct Pending {
      std::size_t level, node;
    };
    std::array<Pending, kWidth * kMostLevels> stack;
    std::size_t size = 0;
    stack[size++] = {levels_.size() - 1, 0};
    while (size > 0) {
      const auto [level, node] = stack[--size];
      // Child i covers the leaves [(node * 8 + i) << 3 (level - 1), ...).
      unsigned mask = levels_[level][node].overlapping(box);
      const std::size_t shift = 3 * (level - 1), base = node * kWidth;
      if (const std::size_t least = first >> shift; least > base)
        mask = least - base < kWidth ? mask & (0xFFu << (least - base)) : 0;
      if (level == 1) {
        for (; mask != 0; mask &= mask - 1) visit(base + static_cast<std::size_t>(std::countr_zero(mask)));
      } else {
        for (; mask != 0; mask ^= std::bit_floor(mask))
          stack[size++] = {level - 1, base + static_cast<std::size_t>(std::bit_width(mask)) - 1};
      }
    }
  }

 private:
  static constexpr std::size_t kMostLevels = 12;  // 8^11 > 2^32

  void build(std::vector<GridBox> boxes);

  std::vector<Index> items_;
  std::vector<std::vector<EightBoxes>> levels_;  ///< the items' own, their bounds', ... up to one node
};

}  // namespace tetprep
