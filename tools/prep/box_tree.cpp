// SPDX-License-Identifier: AGPL-3.0-or-later
#include "prep/box_tree.hpp"

#include <tbb/parallel_for.h>
#include <tbb/parallel_sort.h>

#include <algorithm>
#include <limits>

#include "prep/hilbert.hpp"

namespace tetprep {
namespace {

constexpr std::int32_t kLeast = std::numeric_limits<std::int32_t>::min();
constexpr std::int32_t kMost = std::numeric_limits<std::int32_t>::max();
constexpr GridBox kEmpty{{kMost, kMost, kMost}, {kLeast, kLeast, kLeast}};  ///< overlaps nothing

GridBox bounds_of(const std::vector<GridBox>& boxes) {
  GridBox all = kEmpty;
  for (const GridBox& box : boxes)
    for (std::size_t k = 0; k < 3; ++k) {
      all.low[k] = std::min(all.low[k], box.low[k]);
      all.high[k] = std::max(all.high[k], box.high[k]);
    }
  return all;
}

/// Where the box's middle is on the curve.
std::uint64_t position(const GridBox& box, const GridBox& all, int shift) {
  std::array<std::uint32_t, 3> x{};
  for (std::size_t k = 0; k < 3; ++k) {
    const std::int64_t middle = (std::int64_t{box.low[k]} + box.high[k]) / 2;
    x[k] = static_cast<std::uint32_t>((middle - all.low[k]) >> shift);
  }
  return hilbert_position(x);
}

}  // namespace

unsigned EightBoxes::overlapping(const GridBox& box) const {
  std::array<std::int32_t, 8> apart{};
  for (std::size_t k = 0; k < 3; ++k)  // without branches, so that all eight are compared at once
    for (std::size_t i = 0; i < 8; ++i)
      apart[i] |= static_cast<int>(low[k][i] > box.high[k]) | static_cast<int>(high[k][i] < box.low[k]);
  unsigned mask = 0;
  for (unsigned i = 0; i < 8; ++i) mask |= static_cast<unsigned>(apart[i] == 0) << i;
  return mask;
}

GridBox EightBoxes::bounds() const {
  GridBox box;
  for (std::size_t k = 0; k < 3; ++k) {
    box.low[k] = *std::min_element(low[k].begin(), low[k].end());
    box.high[k] = *std::max_element(high[k].begin(), high[k].end());
  }
  return box;
}

void BoxTree::build(std::vector<GridBox> boxes) {
  const GridBox all = bounds_of(boxes);
  int shift = 0;
  for (std::size_t k = 0; k < 3; ++k)
    while ((std::int64_t{all.high[k]} - all.low[k]) >> shift >= std::int64_t{1} << kHilbertBits) ++shift;
  struct Place {
    std::uint64_t position;
    Index number;
    bool operator<(const Place& other) const {
      return position != other.position ? position < other.position : number < other.number;
    }
  };
  std::vector<Place> places(boxes.size());
  tbb::parallel_for(std::size_t{0}, places.size(), [&](std::size_t i) {
    places[i] = {position(boxes[i], all, shift), static_cast<Index>(i)};
  });
  tbb::parallel_sort(places.begin(), places.end());

  std::vector<Index> sorted(items_.size());
  std::vector<EightBoxes> level((boxes.size() + kWidth - 1) / kWidth);
  for (std::size_t i = 0; i < level.size() * kWidth; ++i) {
    const bool there = i < places.size();
    if (there) sorted[i] = items_[places[i].number];
    level[i / kWidth].set(i % kWidth, there ? boxes[places[i].number] : kEmpty);
  }
  items_ = std::move(sorted);
  levels_.push_back(std::move(level));
  do {
    const auto& below = levels_.back();
    std::vector<EightBoxes> above((below.size() + kWidth - 1) / kWidth);
    for (std::size_t i = 0; i < above.size() * kWidth; ++i)
      above[i / kWidth].set(i % kWidth, i < below.size() ? below[i].bounds() : kEmpty);
    levels_.push_back(std::move(above));
  } while (levels_.back().size() > 1);
}

}  // namespace tetprep
