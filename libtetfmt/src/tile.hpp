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
// Rays come in blocks whose directions are close. A block's directions lie in a box; where an edge has all of
// the box on one side, one sign says it for the block. All signs are certified; what is not goes to the exact
// predicates, ray by ray. So each ray takes the path of its own exact walk.
#pragma once

#include <array>
#include <bit>
#include <cstdint>
#include <span>

#include "tetfmt/traverse.hpp"

namespace tetfmt::detail {

inline constexpr std::size_t kBlockRays = 16, kBlocks = 16, kTileRays = kBlockRays * kBlocks;

/// A set of a tile's rays: bit i % 64 of word i / 64.
struct RayMask {
  std::array<std::uint64_t, kTileRays / 64> words{};

  static RayMask first(std::size_t count) {
    RayMask mask;
    for (std::size_t w = 0; w < mask.words.size(); ++w) {
      const std::size_t begin = 64 * w;
      if (count > begin)
        mask.words[w] = count - begin >= 64 ? ~std::uint64_t{0} : (std::uint64_t{1} << (count - begin)) - 1;
    }
    return mask;
  }
  bool any() const { return (words[0] | words[1] | words[2] | words[3]) != 0; }
  std::uint32_t block(std::size_t b) const {
    return static_cast<std::uint16_t>(words[b / 4] >> (16 * (b % 4)));
  }

  friend RayMask operator&(const RayMask& a, const RayMask& b) {
    return {
        {a.words[0] & b.words[0], a.words[1] & b.words[1], a.words[2] & b.words[2], a.words[3] & b.words[3]}};
  }
  friend RayMask operator|(const RayMask& a, const RayMask& b) {
    return {
        {a.words[0] | b.words[0], a.words[1] | b.words[1], a.words[2] | b.words[2], a.words[3] | b.words[3]}};
  }
  /// a without b.
  friend RayMask operator-(const RayMask& a, const RayMask& b) {
    return {{a.words[0] & ~b.words[0], a.words[1] & ~b.words[1], a.words[2] & ~b.words[2],
             a.words[3] & ~b.words[3]}};
  }
  template <class Function>
  void for_each(Function&& function) const {
    for (std::size_t w = 0; w < words.size(); ++w)
      for (std::uint64_t rest = words[w]; rest != 0; rest &= rest - 1)
        function(64 * w + static_cast<std::size_t>(std::countr_zero(rest)));
  }
};

/// The walk of one tile: first hits of 1 to kTileRays rays from one place, all as first_hit has them but for
/// Hit::steps, which stays 0. Directions must be finite, and their largest component between 2^-60 and 2^60;
/// `from` neither corrupt nor absent, its position finite. `hits` has the directions' size. Returns the
/// visits.
using TileTracer = std::uint64_t (*)(const FileView& view, const Location& from,
                                     std::span<const Vec3f> directions, std::span<Hit> hits);

/// The tile walk compiled for one kind of processor.
struct TileTarget {
  const char* name;
  TileTracer checked, unchecked;
};

/// Those that this processor can run, best first; never empty.
std::span<const TileTarget> tile_targets();

}  // namespace tetfmt::detail
