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

/// A moment (a - o) x (b - o), scaled, and the bound for the error of its product with a direction.
struct Moment {
  float x, y, z, bound;
};

struct Signs16 {
  std::uint32_t left = 0, right = 0;
};

/// Directions, component by component, and the boxes around those of each block.
class TileRays {
 public:
  alignas(64) std::array<float, kTileRays> x, y, z;

  /// To be called when x, y, z are set for `rays`, some of the first `count`. The others, up to the end of
  /// the last group, become like these.
  void enclose(const RayMask& rays, std::size_t count) {
    fill_gaps(rays, count);
    const Lanes d;
    auto largest = hn::Zero(d);
    axis_ = {};
    for (std::size_t b = 0; b < count / kBlockRays + (count % kBlockRays != 0); b += hn::Lanes(d)) {
      largest = hn::Max(largest, enclose(x, b, middle_x_, half_x_, axis_[0]));
      largest = hn::Max(largest, enclose(y, b, middle_y_, half_y_, axis_[1]));
      largest = hn::Max(largest, enclose(z, b, middle_z_, half_z_, axis_[2]));
    }
    largest_ = hn::GetLane(hn::MaxOfLanes(d, largest));
  }
  /// The largest component of a direction, or slightly more.
  float largest() const { return largest_; }
  /// The sum of the blocks' middles: a vector along the tile.
  const std::array<float, 3>& axis() const { return axis_; }

  /// The blocks of a group, all at once: which lie on one side.
  HWY_INLINE Signs16 blocks(std::size_t group, const Moment& m) const {
    const Lanes d;
    const auto mx = hn::Set(d, m.x), my = hn::Set(d, m.y), mz = hn::Set(d, m.z), bound = hn::Set(d, m.bound);
    const auto ax = hn::Abs(mx), ay = hn::Abs(my), az = hn::Abs(mz);
    Signs16 signs;
    for (std::size_t i = 0; i < kGroupBlocks; i += hn::Lanes(d)) {
      const std::size_t b = group * kGroupBlocks + i;
      const auto at_middle = product(d, middle_x_, middle_y_, middle_z_, b, mx, my, mz);
      const auto around = hn::MulAdd(
          hn::Load(d, &half_x_[b]), ax,
          hn::MulAdd(hn::Load(d, &half_y_[b]), ay, hn::MulAdd(hn::Load(d, &half_z_[b]), az, bound)));
      signs.left |= bits(d, hn::Gt(at_middle, around)) << i;
      signs.right |= bits(d, hn::Lt(at_middle, hn::Neg(around))) << i;
    }
    return signs;
  }

  /// The rays of a block, all at once.
  HWY_INLINE Signs16 rays(std::size_t block, const Moment& m) const {
    const Lanes d;
    const auto mx = hn::Set(d, m.x), my = hn::Set(d, m.y), mz = hn::Set(d, m.z), bound = hn::Set(d, m.bound);
    Signs16 signs;
    for (std::size_t i = 0; i < kBlockRays; i += hn::Lanes(d)) {
      const auto value = product(d, x, y, z, block * kBlockRays + i, mx, my, mz);
      signs.left |= bits(d, hn::Gt(value, bound)) << i;
      signs.right |= bits(d, hn::Lt(value, hn::Neg(bound))) << i;
    }
    return signs;
  }

 private:
  using Blocks = std::array<float, kTileBlocks>;

  template <std::size_t kSize>
  static HWY_INLINE hn::Vec<Lanes> product(Lanes d, const std::array<float, kSize>& px,
                                           const std::array<float, kSize>& py,
                                           const std::array<float, kSize>& pz, std::size_t i,
                                           hn::Vec<Lanes> mx, hn::Vec<Lanes> my, hn::Vec<Lanes> mz) {
    return hn::MulAdd(hn::Load(d, &px[i]), mx,
                      hn::MulAdd(hn::Load(d, &py[i]), my, hn::Mul(hn::Load(d, &pz[i]), mz)));
  }

  void fill_gaps(const RayMask& rays, std::size_t count) {
    const std::size_t end = (count + kGroupRays - 1) / kGroupRays * kGroupRays;
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

  /// Of as many blocks as there are lanes, from block b on: one component. Returns its largest size in each.
  HWY_INLINE hn::Vec<Lanes> enclose(const std::array<float, kTileRays>& of, std::size_t b, Blocks& middles,
                                    Blocks& halves, float& sum) {
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
    hn::Store(half, d, &halves[b]);
    sum += hn::GetLane(hn::SumOfLanes(d, middle));
    return hn::Add(hn::Abs(middle), half);
  }

  alignas(64) Blocks middle_x_, middle_y_, middle_z_, half_x_, half_y_, half_z_;
  std::array<float, 3> axis_{};
  float largest_ = 0;
};

}  // namespace HWY_NAMESPACE
}  // namespace tetfmt::detail
HWY_AFTER_NAMESPACE();

#endif
