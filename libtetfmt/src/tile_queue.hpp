// SPDX-License-Identifier: MIT
// The visits that wait. Compiled once a kind of processor: see tile.cpp.
#if defined(TETFMT_TILE_QUEUE_HPP) == defined(HWY_TARGET_TOGGLE)
#ifdef TETFMT_TILE_QUEUE_HPP
#undef TETFMT_TILE_QUEUE_HPP
#else
#define TETFMT_TILE_QUEUE_HPP
#endif

#include <hwy/highway.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <vector>

#include "tile.hpp"

HWY_BEFORE_NAMESPACE();
namespace tetfmt::detail {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

/// A face that rays go through. Its corners are points relative to the rays' origin, scaled: coordinate by
/// coordinate, the last unused.
struct Crossing {
  alignas(32) std::array<double, 4> x, y, z;
  std::array<float, 3> depths;  ///< of the corners
  std::array<Index, 3> ids;
};

/// A visit that waits: these rays enter a tetrahedron by that face.
struct Pending {
  Crossing by;
  Index tet;
  Ref previous;
  std::uint32_t steps;  ///< at most this many visits, so far, of each ray
  RayMask rays;
};

/// No ray is in two visits, so there are no more than rays.
class Queue {
 public:
  Queue() : pool_(kTileRays + 1) {
    order_.fill(kNone);
    keys_.fill(kNoKey);
    for (std::size_t i = 0; i < pool_.size(); ++i) free_[i] = static_cast<std::uint16_t>(i);
  }
  /// Whatever a walk that was cut short may have left.
  void clear() {
    std::fill_n(order_.begin(), count_, kNone);
    std::fill_n(keys_.begin(), count_, kNoKey);
    count_ = 0;
    taken_ = kNotTaken;
    for (std::size_t i = 0; i < pool_.size(); ++i) free_[i] = static_cast<std::uint16_t>(i);
  }
  bool empty() const { return count_ == 0; }
  bool idle() const { return empty() && taken_ == kNotTaken; }

  /// The visit of `tet` by way of `previous`, if one waits.
  HWY_INLINE Pending* find(Index tet, Ref previous) {
    const hn::CappedTag<std::uint64_t, 8> d;
    const auto wanted = hn::Set(d, key(tet, previous));
    for (std::size_t i = 0; i < count_; i += hn::Lanes(d)) {
      const intptr_t at = hn::FindFirstTrue(d, hn::Eq(hn::Load(d, &keys_[i]), wanted));
      if (at >= 0) return &pool_[order_[i + static_cast<std::size_t>(at)] & kSlot];
    }
    return nullptr;
  }

  /// Room for one more. All but its tetrahedron and reference are for the caller to fill in.
  HWY_INLINE Pending& add(Index tet, Ref previous, float depth) {
    const std::uint16_t slot = free_[count_ + (taken_ != kNotTaken ? 1 : 0)];
    keys_[count_] = key(tet, previous);
    // Depths are not negative, so their bits order them; their last bits give way to the slot.
    order_[count_++] = (std::bit_cast<std::uint32_t>(std::max(depth, 0.0f)) & ~kSlot) | slot;
    Pending& visit = pool_[slot];
    visit.tet = tet;
    visit.previous = previous;
    return visit;
  }

  /// Takes out the nearest. It stays as it is until release().
  HWY_INLINE const Pending& take() {
    const hn::CappedTag<std::uint32_t, 16> d;
    auto least = hn::Load(d, order_.data());
    for (std::size_t i = hn::Lanes(d); i < count_; i += hn::Lanes(d))
      least = hn::Min(least, hn::Load(d, &order_[i]));
    const auto nearest = hn::MinOfLanes(d, least);
    std::size_t at = 0;
    for (intptr_t found = -1; found < 0; at += found < 0 ? hn::Lanes(d) : static_cast<std::size_t>(found))
      found = hn::FindFirstTrue(d, hn::Eq(hn::Load(d, &order_[at]), nearest));
    const auto slot = static_cast<std::uint16_t>(order_[at] & kSlot);
    --count_;
    order_[at] = order_[count_];
    keys_[at] = keys_[count_];
    order_[count_] = kNone;
    keys_[count_] = kNoKey;
    taken_ = slot;
    return pool_[slot];
  }
  void release() {
    free_[count_] = taken_;
    taken_ = kNotTaken;
  }

 private:
  static constexpr std::uint32_t kSlot = 2047;
  static_assert(kTileRays + 1 <= kSlot);
  static constexpr std::uint16_t kNotTaken = 0xFFFF;
  static constexpr std::uint64_t kNoKey = ~std::uint64_t{0};
  static constexpr std::size_t kRoom = kTileRays + 16;  ///< whole registers can be read

  static std::uint64_t key(Index tet, Ref previous) { return std::uint64_t{tet} << 32 | previous; }

  std::size_t count_ = 0;
  std::uint16_t taken_ = kNotTaken;
  alignas(64) std::array<std::uint32_t, kRoom> order_;  ///< of the waiting ones; then kNone
  alignas(64) std::array<std::uint64_t, kRoom> keys_;   ///< of the same; then kNoKey
  /// Slots of the pool; those from the number in use on are free.
  std::array<std::uint16_t, kTileRays + 1> free_;
  std::vector<Pending> pool_;
};

}  // namespace HWY_NAMESPACE
}  // namespace tetfmt::detail
HWY_AFTER_NAMESPACE();

#endif
