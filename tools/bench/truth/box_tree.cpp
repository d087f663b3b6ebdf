// SPDX-License-Identifier: AGPL-3.0-or-later
#include "bench/truth/box_tree.hpp"

#include <numeric>

namespace tetbench {
namespace {

constexpr int kBins = 16;

float half_area(const std::array<float, 3>& low, const std::array<float, 3>& high) {
  const float x = high[0] - low[0], y = high[1] - low[1], z = high[2] - low[2];
  return x * y + y * z + z * x;
}

}  // namespace

BoxTree::BoxTree(std::span<const tetfmt::Vec3f> vertices, std::span<const Face> faces) {
  std::vector<Box> boxes;
  boxes.reserve(faces.size());
  for (const Face& face : faces) {
    Box box = kEmpty;
    for (const tetfmt::Index id : face) {
      const std::array<float, 3> p = {vertices[id].x, vertices[id].y, vertices[id].z};
      for (std::size_t k = 0; k < 3; ++k) {
        box.low[k] = std::min(box.low[k], p[k]);
        box.high[k] = std::max(box.high[k], p[k]);
      }
    }
    boxes.push_back(box);
  }
  order_.resize(faces.size());
  std::iota(order_.begin(), order_.end(), 0U);
  if (!order_.empty()) build(0, static_cast<std::uint32_t>(order_.size()), boxes, 0);
}

void BoxTree::build(std::uint32_t first, std::uint32_t last, std::span<const Box> boxes, int depth) {
  const auto all = std::span(order_).subspan(first, last - first);
  const auto join = [](Box& a, const Box& b) {
    for (std::size_t k = 0; k < 3; ++k) {
      a.low[k] = std::min(a.low[k], b.low[k]);
      a.high[k] = std::max(a.high[k], b.high[k]);
    }
  };

  const auto center = [&](std::uint32_t i, std::size_t k) {
    return boxes[i].low[k] / 2 + boxes[i].high[k] / 2;
  };
  Box box = kEmpty, centers = kEmpty;
  for (const std::uint32_t i : all) {
    join(box, boxes[i]);
    const std::array<float, 3> c = {center(i, 0), center(i, 1), center(i, 2)};
    join(centers, {c, c});
  }
  const std::size_t self = nodes_.size();
  nodes_.push_back({box, first, last - first});
  if (last - first <= kLeaf) return;

  // The cheapest of a few planes, by surface area (MacDonald and Booth 1990); in the middle where that finds
  // none, or where the tree grows deep: then it is at most 32 deeper.
  std::size_t axis = 0;
  for (std::size_t k = 1; k < 3; ++k)
    if (centers.high[k] - centers.low[k] > centers.high[axis] - centers.low[axis]) axis = k;
  const float low = centers.low[axis], extent = centers.high[axis] - low;
  std::uint32_t middle = first;
  if (extent > 0 && depth < 60) {
    const auto bin = [&](std::uint32_t i) {
      return std::clamp(static_cast<int>((center(i, axis) - low) / extent * kBins), 0, kBins - 1);
    };
    std::array<Box, kBins> bins;
    std::array<std::uint32_t, kBins> counts{};
    bins.fill(kEmpty);
    for (const std::uint32_t i : all) {
      const auto b = static_cast<std::size_t>(bin(i));
      join(bins[b], boxes[i]);
      ++counts[b];
    }
    float best = std::numeric_limits<float>::infinity();
    int split = 0;
    for (int s = 1; s < kBins; ++s) {
      Box left = kEmpty, right = kEmpty;
      std::uint32_t left_count = 0, right_count = 0;
      for (int b = 0; b < kBins; ++b) {
        const auto k = static_cast<std::size_t>(b);
        if (counts[k] == 0) continue;
        join(b < s ? left : right, bins[k]);
        (b < s ? left_count : right_count) += counts[k];
      }
      if (left_count == 0 || right_count == 0) continue;
      const float cost = half_area(left.low, left.high) * static_cast<float>(left_count) +
                         half_area(right.low, right.high) * static_cast<float>(right_count);
      if (cost < best) best = cost, split = s;
    }
    const auto parted =
        std::partition(all.begin(), all.end(), [&](std::uint32_t i) { return bin(i) < split; });
    middle = first + static_cast<std::uint32_t>(parted - all.begin());
  }
  if (middle == first || middle == last) {
    middle = first + (last - first) / 2;
    std::nth_element(all.begin(), all.begin() + (last - first) / 2, all.end(),
                     [&](std::uint32_t a, std::uint32_t b) { return center(a, axis) < center(b, axis); });
  }
  nodes_[self].count = 0;
  build(first, middle, boxes, depth + 1);
  nodes_[self].first = static_cast<std::uint32_t>(nodes_.size());
  build(middle, last, boxes, depth + 1);
}

}  // namespace tetbench
