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
  /// Bit i % 64 of word i / 64 stands for a group's ray i. Of a group that is not in `groups`: anything.
  using Group = std::array<std::uint64_t, kGroupRays / 64>;
  alignas(64) std::array<Group, kGroups> group;
  std::uint32_t groups = 0;  ///< those with a ray in the set, one bit each

  RayMask() {}  // and leaves the groups' words as they are
  static RayMask first(std::size_t count) {
    RayMask mask;
    for (std::size_t w = 0; w < kTileRays / 64 && count > 64 * w; ++w) {
      const std::size_t left = count - 64 * w, g = w / 4;
      if (w % 4 == 0) mask.group[g] = {};
      mask.group[g][w % 4] = left >= 64 ? ~std::uint64_t{0} : (std::uint64_t{1} << left) - 1;
      mask.groups |= 1u << g;
    }
    return mask;
  }
  bool any() const { return groups != 0; }
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
  /// Takes `rays` of a group for what it holds.
  void set(std::size_t g, const Group& rays) {
    group[g] = rays;
    const bool some = (rays[0] | rays[1] | rays[2] | rays[3]) != 0;
    groups = (groups & ~(1u << g)) | static_cast<std::uint32_t>(some) << g;
  }

  friend RayMask operator&(const RayMask& a, const RayMask& b) {
    RayMask mask;
    for (std::size_t g = 0; g < kGroups; ++g)
      if ((a.groups & b.groups) >> g & 1u)
        mask.set(g, combine(a.group[g], b.group[g], [](auto x, auto y) { return x & y; }));
    return mask;
  }
  RayMask& operator|=(const RayMask& other) {
    other.for_each_group([&](std::size_t g) {
      if (groups >> g & 1u)
        group[g] = combine(group[g], other.group[g], [](auto x, auto y) { return x | y; });
      else
        group[g] = other.group[g];
    });
    groups |= other.groups;
    return *this;
  }
  /// a without b.
  friend RayMask operator-(const RayMask& a, const RayMask& b) {
    RayMask mask;
    a.for_each_group([&](std::size_t g) {
      if (b.groups >> g & 1u)
        mask.set(g, combine(a.group[g], b.group[g], [](auto x, auto y) { return x & ~y; }));
      else
        mask.set(g, a.group[g]);
    });
    return mask;
  }

 private:
  template <class Operation>
  static Group combine(const Group& a, const Group& b, Operation&& of) {
    return {of(a[0], b[0]), of(a[1], b[1]), of(a[2], b[2]), of(a[3], b[3])};
  }
};

/// A walk of 1 to kTileRays rays from one place. `from` must be neither corrupt nor absent, its position
/// finite. Both return the number of visits.
struct TileTracers {
  /// First hits, all as first_hit has them but for Hit::steps, which stays 0. Directions must be finite,
  /// and their largest component between 2^-60 and 2^60. `hits` has the directions' size.
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
