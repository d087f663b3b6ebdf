// SPDX-License-Identifier: MIT
// Compiled once for each kind of processor, as tile.cpp is.
#include "batch_lanes.hpp"

#define HWY_DISABLED_TARGETS HWY_SSSE3
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "batch_lanes.cpp"
#include <hwy/foreach_target.h>
//
#include <hwy/highway.h>

#include <bit>
#include <cstring>
#include <vector>

#include "cells.hpp"

HWY_BEFORE_NAMESPACE();
namespace tetfmt::detail {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

using Floats = hn::CappedTag<float, 16>;
using Ids = hn::Rebind<std::uint32_t, Floats>;
using Signed = hn::Rebind<std::int32_t, Floats>;
using F = hn::Vec<Floats>;
using U = hn::Vec<Ids>;
using M = hn::Mask<Ids>;
constexpr std::size_t kWidth = hn::MaxLanes(Floats());
static_assert(kWidth == 1 || kWidth % 4 == 0);

/// Vectors of lanes that are walked in turn, so that one's loads are under way while another computes.
#ifndef TOGETHER
#define TOGETHER 2
#endif
#ifndef STEPS
#define STEPS 4
#endif
constexpr std::size_t kTogether = TOGETHER;
/// Steps between two looks at lanes that wait.
constexpr int kSteps = STEPS;

HWY_INLINE LaneMask to_bits(M mask) {
  std::array<std::uint8_t, 8> bytes{};
  hn::StoreMaskBits(Ids(), mask, bytes.data());
  return static_cast<LaneMask>(bytes[0] | bytes[1] << 8);
}
HWY_INLINE M from_bits(LaneMask bits) {
  const std::array<std::uint8_t, 8> bytes = {static_cast<std::uint8_t>(bits),
                                             static_cast<std::uint8_t>(bits >> 8)};
  return hn::LoadMaskBits(Ids(), bytes.data());
}
template <class Mask>
HWY_INLINE M as_ids(Mask mask) {
  return hn::RebindMask(Ids(), mask);
}
HWY_INLINE F select(M mask, F yes, F no) {
  return hn::IfThenElse(hn::RebindMask(Floats(), mask), yes, no);
}
HWY_INLINE U select(M mask, U yes, U no) {
  return hn::IfThenElse(mask, yes, no);
}

#if HWY_TARGET != HWY_SCALAR
/// Sixteen bytes from each of every fourth address: those of lanes q, 4 + q, ...
template <class D>
HWY_INLINE hn::Vec<D> load_blocks(D d, const std::uint8_t* base, std::size_t stride,
                                  const std::uint32_t* at) {
  if constexpr (hn::MaxLanes(D()) == 4) {
    return hn::BitCast(d, hn::LoadU(hn::Full128<std::uint8_t>(), base + stride * at[0]));
  } else {
    const hn::Half<D> half;
    return hn::Combine(d, load_blocks(half, base, stride, at + hn::MaxLanes(half)),
                       load_blocks(half, base, stride, at));
  }
}

#endif

struct Corners {
  F i, j, k;
};

template <bool kChecked, class Cells>
class Walk {
 public:
  Walk(const FileView& view, const Cells& cells, const Lines& lines, Lanes& lanes)
      : view_(view),
        lines_(lines),
        lanes_(lanes),
        cells_(reinterpret_cast<const std::uint32_t*>(cells.cells.data())),
        before_vertices_(reinterpret_cast<const std::uint8_t*>(view.vertices().data()) - 4) {}

  Waiting run() {
    for (std::size_t first = 0; first < kLanes; first += kWidth * kTogether) advance(first);
    return waiting_;
  }

 private:
  /// The part of the lanes' state that changes, of one vector.
  struct State {
    F x0, x1, x2, y0, y1, y2, z0, z1, z2;
    U i0, i1, i2, tet, previous, ref;
    M walking, ended, corrupt;
    std::size_t first;
  };

  HWY_INLINE State load(std::size_t first) const {
    const Floats f;
    const Ids u;
    State s;
    s.first = first;
    s.x0 = hn::Load(f, &lanes_.x[0][first]);
    s.x1 = hn::Load(f, &lanes_.x[1][first]);
    s.x2 = hn::Load(f, &lanes_.x[2][first]);
    s.y0 = hn::Load(f, &lanes_.y[0][first]);
    s.y1 = hn::Load(f, &lanes_.y[1][first]);
    s.y2 = hn::Load(f, &lanes_.y[2][first]);
    s.z0 = hn::Load(f, &lanes_.z[0][first]);
    s.z1 = hn::Load(f, &lanes_.z[1][first]);
    s.z2 = hn::Load(f, &lanes_.z[2][first]);
    s.i0 = hn::Load(u, &lanes_.ids[0][first]);
    s.i1 = hn::Load(u, &lanes_.ids[1][first]);
    s.i2 = hn::Load(u, &lanes_.ids[2][first]);
    s.tet = hn::Load(u, &lanes_.tet[first]);
    s.previous = hn::Load(u, &lanes_.previous[first]);
    s.ref = hn::Load(u, &lanes_.ref[first]);
    s.walking = from_bits(lanes_.walking >> first);
    s.ended = s.corrupt = from_bits(0);
    return s;
  }
  HWY_INLINE void store(const State& s) {
    const Floats f;
    const Ids u;
    const std::size_t first = s.first;
    hn::Store(s.x0, f, &lanes_.x[0][first]);
    hn::Store(s.x1, f, &lanes_.x[1][first]);
    hn::Store(s.x2, f, &lanes_.x[2][first]);
    hn::Store(s.y0, f, &lanes_.y[0][first]);
    hn::Store(s.y1, f, &lanes_.y[1][first]);
    hn::Store(s.y2, f, &lanes_.y[2][first]);
    hn::Store(s.z0, f, &lanes_.z[0][first]);
    hn::Store(s.z1, f, &lanes_.z[1][first]);
    hn::Store(s.z2, f, &lanes_.z[2][first]);
    hn::Store(s.i0, u, &lanes_.ids[0][first]);
    hn::Store(s.i1, u, &lanes_.ids[1][first]);
    hn::Store(s.i2, u, &lanes_.ids[2][first]);
    hn::Store(s.tet, u, &lanes_.tet[first]);
    hn::Store(s.previous, u, &lanes_.previous[first]);
    hn::Store(s.ref, u, &lanes_.ref[first]);
    const LaneMask all = kWidth == 32 ? ~LaneMask{0} : ((LaneMask{1} << kWidth) - 1) << first;
    const LaneMask started = lanes_.walking & all, walking = to_bits(s.walking) << first;
    const LaneMask ended = to_bits(s.ended) << first, corrupt = to_bits(s.corrupt) << first;
    waiting_.ended |= ended;
    waiting_.corrupt |= corrupt;
    waiting_.arrived |= started & ~walking & ~ended & ~corrupt;
    lanes_.walking = (lanes_.walking & ~all) | walking;
  }

  HWY_INLINE void advance(std::size_t first) {
    State s[kTogether];
    for (std::size_t k = 0; k < kTogether; ++k) s[k] = load(first + k * kWidth);
    for (int i = 0; i < kSteps; ++i)
      for (std::size_t k = 0; k < kTogether; ++k) step(s[k]);
    for (std::size_t k = 0; k < kTogether; ++k) store(s[k]);
  }

  HWY_INLINE Corners corners(U at, std::size_t first) const {
    const Floats f;
#if HWY_TARGET == HWY_SCALAR
    const std::uint8_t* const point = before_vertices_ + sizeof(Vec3f) * hn::GetLane(at);
    const auto coordinate = [&](std::size_t axis) {
      float value;
      std::memcpy(&value, point + lanes_.shuffle[first][4 * axis + 4], sizeof value);
      return hn::Set(f, value);
    };
    return {coordinate(0), coordinate(1), coordinate(2)};
#else
    const Ids u;
    const hn::Repartition<std::uint8_t, Ids> bytes;
    const hn::Repartition<std::uint64_t, Ids> pairs;
    alignas(64) std::array<std::uint32_t, kWidth> index;
    hn::Store(at, u, index.data());
    const auto row = [&](std::size_t q) HWY_ATTR {
      const auto block = load_blocks(u, before_vertices_, sizeof(Vec3f), &index[q]);
      const auto order = hn::Load(bytes, lanes_.shuffle[first + q * (kWidth / 4)].data());
      return hn::BitCast(u, hn::TableLookupBytes(hn::BitCast(bytes, block), order));
    };
    const U r0 = row(0), r1 = row(1), r2 = row(2), r3 = row(3);
    const auto a = hn::BitCast(pairs, hn::InterleaveLower(u, r0, r1)),
               b = hn::BitCast(pairs, hn::InterleaveLower(u, r2, r3));
    const auto c = hn::BitCast(pairs, hn::InterleaveUpper(u, r0, r1)),
               d = hn::BitCast(pairs, hn::InterleaveUpper(u, r2, r3));
    return {hn::BitCast(f, hn::InterleaveUpper(pairs, a, b)),
            hn::BitCast(f, hn::InterleaveLower(pairs, c, d)),
            hn::BitCast(f, hn::InterleaveUpper(pairs, c, d))};
#endif
  }

  HWY_INLINE U gather(U at) const {
    return hn::GatherIndex(Ids(), cells_, hn::BitCast(Signed(), at));
  }

  HWY_INLINE void step(State& s) {
    const Floats f;
    const Ids u;
    const Signed signed_ids;
    const auto of = [&](const PerLane<float>& values) HWY_ATTR { return hn::Load(f, &values[s.first]); };
    constexpr bool kTet20 = !Cells::kNeedsEntryRank;
    const U cell = kTet20 ? hn::Add(hn::ShiftLeft<2>(s.tet), s.tet) : hn::ShiftLeft<2>(s.tet);
    U apex = hn::IfThenElseZero(s.walking, hn::Xor(hn::Xor(gather(cell), s.i0), hn::Xor(s.i1, s.i2)));
    if constexpr (kChecked) {
      const M bad =
          hn::AndNot(hn::Lt(apex, hn::Set(u, static_cast<Index>(view_.vertices().size()))), s.walking);
      s.corrupt = hn::Or(s.corrupt, bad);
      s.walking = hn::AndNot(bad, s.walking);
      apex = hn::IfThenElseZero(s.walking, apex);
    }
    const Corners at = corners(apex, s.first);
    const F depth = hn::Sub(at.k, of(lanes_.origin[2]));
    const F x = hn::NegMulAdd(depth, of(lanes_.slope_i), hn::Sub(at.i, of(lanes_.origin[0])));
    const F y = hn::NegMulAdd(depth, of(lanes_.slope_j), hn::Sub(at.j, of(lanes_.origin[1])));
    const F z = hn::Mul(depth, of(lanes_.sign_k));

    const F error = of(lanes_.error), square = of(lanes_.square);
    const F size = hn::Add(hn::Abs(x), hn::Abs(y));
    const F cross0 = hn::MulSub(s.x0, y, hn::Mul(s.y0, x));
    const F bound0 = hn::MulAdd(error, hn::Add(hn::Add(hn::Abs(s.x0), hn::Abs(s.y0)), size), square);
    M left0 = as_ids(hn::Gt(cross0, hn::Zero(f)));
    const F x12 = select(left0, s.x2, s.x1), y12 = select(left0, s.y2, s.y1);
    const F cross1 = hn::MulSub(x12, y, hn::Mul(y12, x));
    const F bound1 = hn::MulAdd(error, hn::Add(hn::Add(hn::Abs(x12), hn::Abs(y12)), size), square);
    M left1 = as_ids(hn::Gt(cross1, hn::Zero(f)));
    const M sure = as_ids(hn::And(hn::Gt(hn::Abs(cross0), bound0), hn::Gt(hn::Abs(cross1), bound1)));
    const M unsure = hn::AndNot(sure, s.walking);
    if (HWY_UNLIKELY(!hn::AllFalse(u, unsure))) {
      std::array<std::array<Index, kWidth>, 4> ids;
      hn::StoreU(s.i0, u, ids[0].data());
      hn::StoreU(s.i1, u, ids[1].data());
      hn::StoreU(s.i2, u, ids[2].data());
      hn::StoreU(apex, u, ids[3].data());
      const Lefts lefts = exactly(ids, s.first, {to_bits(left0), to_bits(left1)}, to_bits(unsure));
      left0 = from_bits(lefts.first);
      left1 = from_bits(lefts.second);
    }

    // Exit opposite corner 0 if both say the same.
    const M differ = hn::And(hn::Xor(left0, left1), s.walking);
    const M exit0 = hn::AndNot(differ, s.walking), exit1 = hn::And(differ, left0),
            exit2 = hn::AndNot(left0, differ);
    const U out = select(exit1, s.i1, select(exit2, s.i2, s.i0));
    U entry_rank = hn::Zero(u);
    const U one = hn::Set(u, 1);
    const auto count = [&](U rank, U id, U other) HWY_ATTR {
      return select(as_ids(hn::Gt(hn::BitCast(signed_ids, id), hn::BitCast(signed_ids, other))),
                    hn::Add(rank, one), rank);
    };
    if constexpr (!kTet20) entry_rank = count(count(count(entry_rank, apex, s.i0), apex, s.i1), apex, s.i2);
    const auto replace = [&](M exit, U& id, F& px, F& py, F& pz) HWY_ATTR {
      id = select(exit, apex, id);
      px = select(exit, x, px);
      py = select(exit, y, py);
      pz = select(exit, z, pz);
    };
    replace(exit0, s.i0, s.x0, s.y0, s.z0);
    replace(exit1, s.i1, s.x1, s.y1, s.z1);
    replace(exit2, s.i2, s.x2, s.y2, s.z2);
    U ref;
    if constexpr (kTet20) {
      ref = gather(count(count(count(hn::Add(cell, one), out, s.i0), out, s.i1), out, s.i2));
    } else {
      const U exit_rank = count(count(count(hn::Zero(u), out, s.i0), out, s.i1), out, s.i2);
      const U three = hn::Set(u, 3);
      const auto nx = [&](U rank) HWY_ATTR {
        const U there = gather(hn::Add(hn::Add(cell, one), hn::Min(rank, hn::Set(u, 2))));
        return hn::IfThenElseZero(hn::Ne(rank, three), there);
      };
      ref = hn::Xor(s.previous, hn::Xor(nx(entry_rank), nx(exit_rank)));
    }
    const M beyond = as_ids(hn::Gt(hn::Min(s.z0, hn::Min(s.z1, s.z2)), of(lanes_.limit)));
    s.ref = select(s.walking, ref, s.ref);
    s.ended = hn::Or(s.ended, hn::And(beyond, s.walking));
    s.walking = hn::AndNot(beyond, s.walking);
    const M arrived = hn::Or(as_ids(hn::Lt(hn::BitCast(signed_ids, ref), hn::Zero(signed_ids))),
                             hn::Eq(ref, hn::Load(u, &lanes_.target[s.first])));
    s.walking = hn::AndNot(arrived, s.walking);
    if constexpr (kChecked) {
      const M bad = hn::AndNot(hn::Lt(ref, hn::Set(u, view_.tet_count())), s.walking);
      s.corrupt = hn::Or(s.corrupt, bad);
      s.walking = hn::AndNot(bad, s.walking);
    }
    if constexpr (!kTet20) s.previous = select(s.walking, s.tet, s.previous);
    s.tet = select(s.walking, ref, s.tet);
  }

  struct Lefts {
    LaneMask first, second;
  };
  HWY_NOINLINE Lefts exactly(const std::array<std::array<Index, kWidth>, 4>& ids, std::size_t first_lane,
                             Lefts lefts, LaneMask unsure) const {
    for (; unsure != 0; unsure &= unsure - 1) {
      const auto lane = static_cast<std::size_t>(std::countr_zero(unsure));
      const Line line = lines_.line(lanes_.ray[first_lane + lane]);
      const auto corner = [&](std::size_t k) { return Corner{view_.vertices()[ids[k][lane]], ids[k][lane]}; };
      const bool first = passes_left(line, corner(0), corner(3)).left;
      const bool second = passes_left(line, corner(first ? 2 : 1), corner(3)).left;
      const LaneMask bit = LaneMask{1} << lane;
      lefts.first = first ? lefts.first | bit : lefts.first & ~bit;
      lefts.second = second ? lefts.second | bit : lefts.second & ~bit;
    }
    return lefts;
  }

  const FileView& view_;
  const Lines& lines_;
  Lanes& lanes_;
  const std::uint32_t* cells_;
  const std::uint8_t* before_vertices_;
  Waiting waiting_;
};

template <bool kChecked>
Waiting advance(const FileView& view, const Lines& lines, Lanes& lanes) {
  return with_cells(view, [&](const auto& cells) {
    using Cells = std::remove_cvref_t<decltype(cells)>;
    return Walk<kChecked, Cells>(view, cells, lines, lanes).run();
  });
}

constexpr BatchTarget kBatchTarget = {HWY_STR(HWY_NAMESPACE), kWidth, advance<true>, advance<false>};

}  // namespace HWY_NAMESPACE
}  // namespace tetfmt::detail
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace tetfmt::detail {

std::span<const BatchTarget> batch_targets() {
  static const std::vector<BatchTarget> targets = [] {
    std::vector<BatchTarget> found;
#if HWY_ARCH_X86
    __builtin_cpu_init();
    const bool avx2 = __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma") &&
                      __builtin_cpu_supports("bmi") && __builtin_cpu_supports("bmi2");
#if HWY_TARGETS & HWY_AVX3
    if (avx2 && __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512vl") &&
        __builtin_cpu_supports("avx512dq") && __builtin_cpu_supports("avx512bw"))
      found.push_back(N_AVX3::kBatchTarget);
#endif
#if HWY_TARGETS & HWY_AVX2
    if (avx2) found.push_back(N_AVX2::kBatchTarget);
#endif
#if HWY_TARGETS & HWY_SSE4
    if (__builtin_cpu_supports("sse4.2")) found.push_back(N_SSE4::kBatchTarget);
#endif
#endif
    found.push_back(HWY_NAMESPACE::kBatchTarget);  // what the compiler assumes anyway: the last one compiled
    return found;
  }();
  return targets;
}

}  // namespace tetfmt::detail
#endif
