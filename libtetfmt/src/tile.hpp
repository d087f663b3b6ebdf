// SPDX-License-Identifier: MIT
// Many rays from one place, walked together: each tetrahedron is visited once for all rays that are in it
// (spec/traversal.md, section 10).
//
// The sign of d . ((a - o) x (b - o)) says on which side of the edge (a, b) the ray of direction d passes. It
// belongs to the edge, whatever tetrahedra the rays are in: one cross product for all rays, then three
// products a ray. So a visit takes the rays that enter by one face, finds three masks for the three new
// edges, and parts the rays by them into three exits. Pending visits wait in a list, nearest first, and merge
// if they enter one tetrahedron by one face.
//
// Rays come in blocks whose directions are close, and these in groups. A block's directions lie in a box;
// where an edge has all of the box on one side, one sign says it for the block. All signs are certified; what
// is not goes to the exact predicates, ray by ray. So each ray takes the path of its own exact walk.
//
//   tile_signs.hpp   the rays of a tile, block by block, and their signs
//   tile_queue.hpp   the visits that wait
//   tile_walk.hpp    the walk
//   tile_tasks.hpp   what is asked: first hits, or occlusion
//   tile.cpp         all of that, compiled once for each kind of processor
#pragma once

#include <array>
#include <bit>
#include <cstdint>
#include <span>

#include "tetfmt/traverse.hpp"

namespace tetfmt::detail {

inline constexpr std::size_t kBlockRays = 16, kGroupBlocks = 16, kGroups = 4;
inline constexpr std::size_t kGroupRays = kBlockRays * kGroupBlocks, kTileBlocks = kGroupBlocks * kGroups,
                             kTileRays = kGroupRays * kGroups;

/// A set of a tile's rays.
struct RayMask {
  struct Uninitialised {};
  /// Bit i % 64 of word i / 64 stands for a group's ray i.
  using Group = std::array<std::uint64_t, kGroupRays / 64>;
  alignas(64) std::array<Group, kGroups> group;
  std::uint32_t groups = 0;  ///< those with a ray in the set, one bit each

  RayMask() : group{} {}
  explicit RayMask(Uninitialised) {}  // for whoever sets every group at once
  static RayMask first(std::size_t count) {
    RayMask mask;
    for (std::size_t w = 0; w < kTileRays / 64 && count > 64 * w; ++w) {
      const std::size_t left = count - 64 * w;
      mask.group[w / 4][w % 4] = left >= 64 ? ~std::uint64_t{0} : (std::uint64_t{1} << left) - 1;
      mask.groups |= 1u << w / 4;
    }
    return mask;
  }
  void add(std::size_t ray) { add_block(ray / kBlockRays, 1u << ray % kBlockRays); }
  void add_block(std::size_t b, std::uint32_t rays) {
    group[b / kGroupBlocks][b % kGroupBlocks / 4] |= std::uint64_t{rays} << (16 * (b % 4));
    groups |= 1u << b / kGroupBlocks;
  }
  bool any() const { return groups != 0; }
  /// Whether there are fewer rays than `count` in the set, all of them in one group.
  bool fewer_than(int count) const {
    if (!std::has_single_bit(groups)) return false;
    int found = 0;
    for (const std::uint64_t word : group[static_cast<std::size_t>(std::countr_zero(groups))])
      found += std::popcount(word);
    return found < count;
  }
  std::uint32_t block(std::size_t b) const {
    return static_cast<std::uint16_t>(group[b / kGroupBlocks][b % kGroupBlocks / 4] >> (16 * (b % 4)));
  }
  template <class Function>
  void for_each_group(Function&& function) const {
    for (std::uint32_t rest = groups; rest != 0; rest &= rest - 1)
      function(static_cast<std::size_t>(std::countr_zero(rest)));
  }
  /// Calls function(number of the block, its rays) for each block with a ray in the set.
  template <class Function>
  void for_each_block(Function&& function) const {
    for_each_group([&](std::size_t g) {
      for (std::size_t b = g * kGroupBlocks; b < (g + 1) * kGroupBlocks; ++b)
        if (const std::uint32_t rays = block(b)) function(b, rays);
    });
  }
  template <class Function>
  void for_each(Function&& function) const {
    for_each_block([&](std::size_t b, std::uint32_t rays) {
      for (; rays != 0; rays &= rays - 1)
        function(b * kBlockRays + static_cast<std::size_t>(std::countr_zero(rays)));
    });
  }

  RayMask& operator|=(const RayMask& other) {
    for (std::size_t g = 0; g < kGroups; ++g)
      for (std::size_t w = 0; w < group[g].size(); ++w) group[g][w] |= other.group[g][w];
    groups |= other.groups;
    return *this;
  }
  friend RayMask operator&(const RayMask& a, const RayMask& b) {
    return combined(a, b, [](std::uint64_t x, std::uint64_t y) { return x & y; });
  }
  /// a without b.
  friend RayMask operator-(const RayMask& a, const RayMask& b) {
    return combined(a, b, [](std::uint64_t x, std::uint64_t y) { return x & ~y; });
  }

 private:
  template <class Operation>
  static RayMask combined(const RayMask& a, const RayMask& b, Operation&& of) {
    RayMask mask;
    for (std::size_t g = 0; g < kGroups; ++g) {
      std::uint64_t some = 0;
      for (std::size_t w = 0; w < a.group[g].size(); ++w)
        some |= mask.group[g][w] = of(a.group[g][w], b.group[g][w]);
      mask.groups |= static_cast<std::uint32_t>(some != 0) << g;
    }
    return mask;
  }
};

/// A walk of 1 to kTileRays rays from one place. `from` must be neither corrupt nor absent, its position
/// finite. Both return the number of visits.
struct TileTracers {
  /// First hits, all as first_hit has them but for Hit::steps, which stays 0. `hits` has the directions'
  /// size.
  using FirstHits = std::uint64_t (*)(const FileView& view, const Location& from,
                                      std::span<const Vec3f> directions, std::span<Hit> hits);
  /// As occlusion(view, from, target) has it, for each target. `outcomes` has the targets' size.
  using Occlusions = std::uint64_t (*)(const FileView& view, const Location& from,
                                       std::span<const Location> targets, std::span<Outcome> outcomes);
  FirstHits first_hits;
  Occlusions occlusions;
};

/// The tile walk compiled for one kind of processor.
struct TileTarget {
  const char* name;
  TileTracers checked, unchecked;
};

/// Those that this processor can run, best first; never empty.
std::span<const TileTarget> tile_targets();

}  // namespace tetfmt::detail
