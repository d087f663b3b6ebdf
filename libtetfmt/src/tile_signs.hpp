// SPDX-License-Identifier: MIT
// The rays of a tile, and on which side of an edge they pass, many at a time. Compiled once a kind of
// processor: see tile.cpp.
#if defined(TETFMT_TILE_SIGNS_HPP) == defined(HWY_TARGET_TOGGLE)
#ifdef TETFMT_TILE_SIGNS_HPP
#undef TETFMT_TILE_SIGNS_HPP
#else
#define TETFMT_TILE_SIGNS_HPP
#endif

#include <hwy/highway.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

#include "tile.hpp"

HWY_BEFORE_NAMESPACE();
namespace tetfmt::detail {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

/// Sixteen floats at a time, whatever the width of the registers.
using Lanes = hn::CappedTag<float, kBlockRays>;

template <class D>
HWY_INLINE std::uint32_t bits(D d, hn::Mask<D> mask) {
  std::uint64_t packed = 0;
  hn::StoreMaskBits(d, mask, reinterpret_cast<std::uint8_t*>(&packed));
  return static_cast<std::uint32_t>(packed);
}

/// The rays of one group as a set, in registers where these are wide enough: sixteen blocks of sixteen.
#if HWY_CAP_GE256
class GroupBits {
  using D = hn::CappedTag<std::uint16_t, kGroupBlocks>;
  using V = hn::Vec<D>;

 public:
  GroupBits() = default;
  explicit GroupBits(const RayMask::Group& group)
      : v_(hn::Load(D(), reinterpret_cast<const std::uint16_t*>(group.data()))) {}
  void store(RayMask::Group& group) const {
    hn::Store(v_, D(), reinterpret_cast<std::uint16_t*>(group.data()));
  }
  /// All rays of the blocks whose bits are set.
  static GroupBits of_blocks(std::uint32_t blocks) {
    const std::uint64_t packed = blocks;
    return V(hn::VecFromMask(D(), hn::LoadMaskBits(D(), reinterpret_cast<const std::uint8_t*>(&packed))));
  }
  /// The blocks that have a ray in the set.
  std::uint32_t blocks() const { return bits(D(), hn::Ne(v_, hn::Zero(D()))); }
  GroupBits with(std::size_t block, std::uint32_t rays) const {
    const V here = hn::LoadU(D(), &kSelect[kGroupBlocks - block]);
    return V(hn::Or(v_, hn::And(here, hn::Set(D(), static_cast<std::uint16_t>(rays)))));
  }
  GroupBits operator&(const GroupBits& b) const { return V(hn::And(v_, b.v_)); }
  GroupBits operator|(const GroupBits& b) const { return V(hn::Or(v_, b.v_)); }
  GroupBits operator-(const GroupBits& b) const { return V(hn::AndNot(b.v_, v_)); }

 private:
  /// Read from kGroupBlocks - b on: all bits of block b.
  static constexpr std::array<std::uint16_t, 2 * kGroupBlocks> kSelect = [] {
    std::array<std::uint16_t, 2 * kGroupBlocks> table{};
    table[kGroupBlocks] = 0xFFFF;
    return table;
  }();
  GroupBits(V v) : v_(v) {}
  V v_;
};
#else
class GroupBits {
 public:
  GroupBits() = default;
  explicit GroupBits(const RayMask::Group& group) : words_(group) {}
  void store(RayMask::Group& group) const { group = words_; }
  static GroupBits of_blocks(std::uint32_t blocks) {
    static constexpr std::array<std::uint64_t, 16> kSpread = [] {  // four bits to four blocks
      std::array<std::uint64_t, 16> table{};
      for (unsigned i = 0; i < 16; ++i)
        for (unsigned b = 0; b < 4; ++b)
          if (i >> b & 1u) table[i] |= std::uint64_t{0xFFFF} << (16 * b);
      return table;
    }();
    RayMask::Group words;
    for (std::size_t w = 0; w < 4; ++w) words[w] = kSpread[blocks >> (4 * w) & 15u];
    return GroupBits(words);
  }
  std::uint32_t blocks() const {
    std::uint32_t result = 0;
    for (unsigned b = 0; b < kGroupBlocks; ++b)
      result |= static_cast<std::uint32_t>((words_[b / 4] >> (16 * (b % 4)) & 0xFFFF) != 0) << b;
    return result;
  }
  GroupBits with(std::size_t block, std::uint32_t rays) const {
    GroupBits result = *this;
    result.words_[block / 4] |= std::uint64_t{rays} << (16 * (block % 4));
    return result;
  }
  GroupBits operator&(const GroupBits& b) const {
    GroupBits result = *this;
    for (std::size_t w = 0; w < 4; ++w) result.words_[w] &= b.words_[w];
    return result;
  }
  GroupBits operator|(const GroupBits& b) const {
    GroupBits result = *this;
    for (std::size_t w = 0; w < 4; ++w) result.words_[w] |= b.words_[w];
    return result;
  }
  GroupBits operator-(const GroupBits& b) const {
    GroupBits result = *this;
    for (std::size_t w = 0; w < 4; ++w) result.words_[w] &= ~b.words_[w];
    return result;
  }

 private:
  RayMask::Group words_;
};
#endif

/// Moments (a - o) x (b - o) of up to four edges, scaled, coordinate by coordinate; the sums of the sizes of
/// their components; and by how much their products with a direction may be off.
struct Moments {
  alignas(16) std::array<float, 4> x, y, z, size, bound;
};

struct Signs16 {
  std::uint32_t left = 0, right = 0;
};

/// Directions, component by component, and cubes around those of each block.
class TileRays {
 public:
  alignas(64) std::array<float, kTileRays> x, y, z;

  /// To be called when x, y, z are set for `rays`, some of the first `count`. The others, up to the end of
  /// the last group, become like these.
  void enclose(const RayMask& rays, std::size_t count) {
    const std::size_t end = (count + kGroupRays - 1) / kGroupRays * kGroupRays;
    fill_gaps(rays, end);
    const Lanes d;
    axis_ = {};
    auto largest = hn::Zero(d);
    for (std::size_t b = 0; b < end / kBlockRays; b += hn::Lanes(d)) {
      auto radius = hn::Zero(d);
      enclose(x, b, middle_x_, axis_[0], radius, largest);
      enclose(y, b, middle_y_, axis_[1], radius, largest);
      enclose(z, b, middle_z_, axis_[2], radius, largest);
      hn::Store(radius, d, &radius_[b]);
    }
    largest_ = hn::GetLane(hn::MaxOfLanes(d, largest));
  }
  /// From moments, the rest of `m`.
  template <class D>
  HWY_INLINE void set_moments(D d, hn::Vec<D> mx, hn::Vec<D> my, hn::Vec<D> mz, std::size_t i,
                              Moments& m) const {
    const auto size = hn::Add(hn::Add(hn::Abs(mx), hn::Abs(my)), hn::Abs(mz));
    hn::Store(mx, d, &m.x[i]);
    hn::Store(my, d, &m.y[i]);
    hn::Store(mz, d, &m.z[i]);
    hn::Store(size, d, &m.size[i]);
    hn::Store(hn::MulAdd(size, hn::Set(d, 0x1p-21f * largest_), hn::Set(d, 0x1p-45f * largest_)), d,
              &m.bound[i]);
  }
  /// The largest component of a direction, or slightly more.
  float largest() const { return largest_; }
  /// The sum of the blocks' middles: a vector along the tile.
  const std::array<float, 3>& axis() const { return axis_; }

  /// On which side of edge k the blocks of a group are: those that are on one.
  HWY_INLINE Signs16 blocks(std::size_t group, const Moments& m, std::size_t k) const {
    const Lanes d;
    const auto size = hn::Set(d, m.size[k] * (1 + 0x1p-20f)), bound = hn::Set(d, m.bound[k]);
    return signs(middle_x_, middle_y_, middle_z_, group * kGroupBlocks, m, k,
                 [&](std::size_t b) { return hn::MulAdd(hn::Load(d, &radius_[b]), size, bound); });
  }
  /// On which side of edge k the rays of a block pass: those that are not within the bound.
  HWY_INLINE Signs16 rays(std::size_t block, const Moments& m, std::size_t k) const {
    const auto bound = hn::Set(Lanes(), m.bound[k]);
    return signs(x, y, z, block * kBlockRays, m, k, [&](std::size_t) { return bound; });
  }

 private:
  using Blocks = std::array<float, kTileBlocks>;

  template <std::size_t kSize, class Margin>
  static HWY_INLINE Signs16 signs(const std::array<float, kSize>& px, const std::array<float, kSize>& py,
                                  const std::array<float, kSize>& pz, std::size_t first, const Moments& m,
                                  std::size_t k, const Margin& margin) {
    const Lanes d;
    const auto mx = hn::Set(d, m.x[k]), my = hn::Set(d, m.y[k]), mz = hn::Set(d, m.z[k]);
    Signs16 result;
    for (std::size_t i = 0; i < 16; i += hn::Lanes(d)) {
      const auto product =
          hn::MulAdd(hn::Load(d, &px[first + i]), mx,
                     hn::MulAdd(hn::Load(d, &py[first + i]), my, hn::Mul(hn::Load(d, &pz[first + i]), mz)));
      const auto bound = margin(first + i);
      result.left |= bits(d, hn::Gt(product, bound)) << i;
      result.right |= bits(d, hn::Lt(product, hn::Neg(bound))) << i;
    }
    return result;
  }

  void fill_gaps(const RayMask& rays, std::size_t end) {
    std::size_t like = end;  // one in the set: the last so far, or else the first
    for (std::size_t b = 0; b < end / kBlockRays; ++b) {
      const std::uint32_t here = rays.block(b);
      if (here == 0xFFFF) {
        like = b * kBlockRays;
        continue;
      }
      if (like == end) rays.for_each([&](std::size_t r) { like = std::min(like, r); });
      for (std::size_t i = 0; i < kBlockRays; ++i) {
        const std::size_t r = b * kBlockRays + i;
        if (here >> i & 1u) {
          like = r;
        } else {
          x[r] = x[like];
          y[r] = y[like];
          z[r] = z[like];
        }
      }
    }
  }

  /// Of as many blocks as there are lanes, from block b on: one component.
  HWY_INLINE void enclose(const std::array<float, kTileRays>& of, std::size_t b, Blocks& middles, float& sum,
                          hn::Vec<Lanes>& radius, hn::Vec<Lanes>& largest) {
    const Lanes d;
    constexpr std::size_t kLanes = hn::MaxLanes(Lanes());
    using V = hn::Vec<Lanes>;
    std::array<V, kLanes> low, high;
    for (std::size_t k = 0; k < kLanes; ++k) {
      const float* const rays = &of[(b + k) * kBlockRays];
      low[k] = high[k] = hn::Load(d, rays);
      for (std::size_t i = kLanes; i < kBlockRays; i += kLanes) {
        low[k] = hn::Min(low[k], hn::Load(d, rays + i));
        high[k] = hn::Max(high[k], hn::Load(d, rays + i));
      }
    }
#if HWY_TARGET != HWY_SCALAR
    // Halves of two vectors become one, until each lane is all that is left of a block.
    for (std::size_t n = kLanes / 2; n > 0; n /= 2) {
      for (std::size_t k = 0; k < n; ++k) {
        const auto fold = [&](const V& even, const V& odd) {
          return std::array<V, 2>{hn::ConcatEven(d, odd, even), hn::ConcatOdd(d, odd, even)};
        };
        const auto lows = fold(low[2 * k], low[2 * k + 1]), highs = fold(high[2 * k], high[2 * k + 1]);
        low[k] = hn::Min(lows[0], lows[1]);
        high[k] = hn::Max(highs[0], highs[1]);
      }
    }
#endif
    const V middle = hn::Mul(hn::Add(low[0], high[0]), hn::Set(d, 0.5f));
    const V half =
        hn::Mul(hn::Max(hn::Sub(high[0], middle), hn::Sub(middle, low[0])), hn::Set(d, 1 + 0x1p-22f));
    hn::Store(middle, d, &middles[b]);
    sum += hn::GetLane(hn::SumOfLanes(d, middle));
    radius = hn::Max(radius, half);
    largest = hn::Max(largest, hn::Add(hn::Abs(middle), half));
  }

  /// Of each block, the middle of its box, and half the box's largest extent.
  alignas(64) Blocks middle_x_, middle_y_, middle_z_, radius_;
  std::array<float, 3> axis_{};
  float largest_ = 0;
};

}  // namespace HWY_NAMESPACE
}  // namespace tetfmt::detail
HWY_AFTER_NAMESPACE();

#endif
