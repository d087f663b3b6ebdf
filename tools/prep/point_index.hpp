// SPDX-License-Identifier: AGPL-3.0-or-later
// Points by place.
#pragma once

#include <bit>
#include <unordered_map>
#include <vector>

#include "prep/prep.hpp"

namespace tetprep {

inline std::int64_t squared_distance(const GridPoint& a, const GridPoint& b) {
  std::int64_t squared = 0;
  for (std::size_t k = 0; k < 3; ++k) squared += (std::int64_t{a[k]} - b[k]) * (std::int64_t{a[k]} - b[k]);
  return squared;
}

struct PlaceHash {
  std::size_t operator()(const GridPoint& place) const {
    std::uint64_t hash = 0;
    for (const std::int32_t x : place) {  // multiplicative hashing (Knuth), with the golden ratio
      hash = (hash ^ static_cast<std::uint32_t>(x)) * 0x9E3779B97F4A7C15u;
      hash ^= hash >> 32;
    }
    return hash;
  }
};

/// The points of a list, found by their place.
class PointIndex {
 public:
  /// No two of `points` may be equal, and meanwhile the list must only grow through add().
  explicit PointIndex(std::vector<GridPoint>& points) : points_(points) {
    numbers_.reserve(points.size());
    for (Index i = 0; i < points.size(); ++i) numbers_.emplace(points[i], i);
  }

  /// The number of the point at `place`, kNone if there is none.
  Index find(const GridPoint& place) const {
    const auto found = numbers_.find(place);
    return found == numbers_.end() ? kNone : found->second;
  }
  /// The number of the point at `place`; a new one at the list's end if there was none.
  Index add(const GridPoint& place) {
    const auto [at, fresh] = numbers_.try_emplace(place, static_cast<Index>(points_.size()));
    if (fresh) points_.push_back(place);
    return at->second;
  }

 private:
  std::vector<GridPoint>& points_;
  std::unordered_map<GridPoint, Index, PlaceHash> numbers_;
};

/// Some points of a list, found by places near them.
class NearIndex {
 public:
  /// `reach`: how far to look, grid steps, at least 1.
  NearIndex(const std::vector<GridPoint>& points, std::int32_t reach)
      : points_(points), reach_(reach), bits_(std::bit_width(static_cast<std::uint32_t>(reach))) {}

  void add(Index number) { cells_[cell(points_[number])].push_back(number); }

  /// The nearest point within reach (the lowest number of equally near ones), or kNone.
  Index find(const GridPoint& place) const {
    Index nearest = kNone;
    std::int64_t least = std::int64_t{reach_} * reach_ + 1;
    const GridPoint middle = cell(place);
    GridPoint at{};
    for (at[0] = middle[0] - 1; at[0] <= middle[0] + 1; ++at[0])
      for (at[1] = middle[1] - 1; at[1] <= middle[1] + 1; ++at[1])
        for (at[2] = middle[2] - 1; at[2] <= middle[2] + 1; ++at[2]) {
          const auto found = cells_.find(at);
          if (found == cells_.end()) continue;
          for (const Index i : found->second) {
            const std::int64_t squared = squared_distance(points_[i], place);
            if (squared > least || (squared == least && i > nearest)) continue;
            least = squared;
            nearest = i;
          }
        }
    return nearest;
  }

 private:
  /// A cell is wider than the reach, so only the next ones matter.
  GridPoint cell(const GridPoint& p) const { return {p[0] >> bits_, p[1] >> bits_, p[2] >> bits_}; }

  const std::vector<GridPoint>& points_;
  const std::int32_t reach_;
  const int bits_;
  std::unordered_map<GridPoint, std::vector<Index>, PlaceHash> cells_;
};

}  // namespace tetprep
