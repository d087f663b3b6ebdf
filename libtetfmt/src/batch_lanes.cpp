// SPDX-License-Identifier: MIT
// Compiled once for each kind of processor, as tile.cpp is.
#include "batch_lanes.hpp"

#include "processor.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "batch_lanes.cpp"
#include <hwy/foreach_target.h>
//
#include <hwy/cache_control.h>
#include <hwy/highway.h>

#include <bit>
#include <cmath>
#include <cstring>
#include <limits>
#include <type_traits>
#include <vector>

#include "cells.hpp"

HWY_BEFORE_NAMESPACE();
namespace tetfmt::detail {
namespace HWY_NAMESPACE {

#if HWY_TARGET == HWY_SCALAR

// A lane alone gains nothing.
constexpr BatchTarget kBatchTarget = {HWY_STR(HWY_NAMESPACE), 1, nullptr, nullptr};

#else

namespace hn = hwy::HWY_NAMESPACE;

using Floats = hn::CappedTag<float, 16>;
using Ids = hn::Rebind<std::uint32_t, Floats>;
using Signed = hn::Rebind<std::int32_t, Floats>;
using F = hn::Vec<Floats>;
using U = hn::Vec<Ids>;
using M = hn::Mask<Ids>;
constexpr std::size_t kWidth = hn::MaxLanes(Floats());
static_assert(kWidth % 4 == 0 && kLanes % kWidth == 0);

/// Steps between two looks at lanes that wait.
constexpr std::size_t kSteps = 4;

// (A number of just as many bytes as Highway stores: a wider one would wait for the memory.)
using MaskBits = std::conditional_t<kWidth == 16, std::uint16_t, std::uint8_t>;
static_assert(kWidth <= 16 && std::endian::native == std::endian::little);
HWY_INLINE LaneMask to_bits(M mask) {
  std::array<std::uint8_t, 8> bytes{};
  hn::StoreMaskBits(Ids(), mask, bytes.data());
  MaskBits bits;
  std::memcpy(&bits, bytes.data(), sizeof bits);
  return bits;
}
HWY_INLINE M from_bits(LaneMask lanes) {
  std::array<std::uint8_t, 8> bytes{};
  const auto bits = static_cast<MaskBits>(lanes);
  std::memcpy(bytes.data(), &bits, sizeof bits);
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

struct Points {
  F x, y, z;
};

/// Sixteen bytes from each of the points of ids 0, 4, ... of a vector: the coordinates and what lies before.
/// (There is something: a file begins with its header.)
template <class D>
HWY_INLINE hn::Vec<D> load_blocks(D d, const Vec3f* vertices, const Index* ids) {
  if constexpr (hn::MaxLanes(D()) == 4) {
    const auto* const before = reinterpret_cast<const std::uint8_t*>(vertices + *ids) - 4;
    return hn::BitCast(d, hn::LoadU(hn::Full128<std::uint8_t>(), before));
  } else {
    const hn::Half<D> half;
    return hn::Combine(d, load_blocks(half, vertices, ids + hn::MaxLanes(half)),
                       load_blocks(half, vertices, ids));
  }
}

HWY_INLINE Points load_points(const Vec3f* vertices, const Index* ids,
                              const std::array<std::uint8_t, 16>* shuffle) {
  const Floats f;
  const Ids u;
  const hn::Repartition<std::uint8_t, Ids> bytes;
  const hn::Repartition<std::uint64_t, Ids> pairs;
  const auto row = [&](std::size_t q) HWY_ATTR {
    const auto block = hn::BitCast(bytes, load_blocks(u, vertices, ids + q));
    const auto order = hn::Load(bytes, shuffle[q * (kWidth / 4)].data());
    return hn::BitCast(u, hn::TableLookupBytes(block, order));
  };
  const U r0 = row(0), r1 = row(1), r2 = row(2), r3 = row(3);
  const auto a = hn::BitCast(pairs, hn::InterleaveLower(u, r0, r1)),
             b = hn::BitCast(pairs, hn::InterleaveLower(u, r2, r3));
  const auto c = hn::BitCast(pairs, hn::InterleaveUpper(u, r0, r1)),
             d = hn::BitCast(pairs, hn::InterleaveUpper(u, r2, r3));
  return {hn::BitCast(f, hn::InterleaveUpper(pairs, a, b)), hn::BitCast(f, hn::InterleaveLower(pairs, c, d)),
          hn::BitCast(f, hn::InterleaveUpper(pairs, c, d))};
}

/// One turn of all lanes. What one half of a step stores, the other reads only after all vectors had their
/// turn.
template <class Cells>
class Walk {
 public:
  Walk(const FileView& view, const Cells& cells, const Lines& lines, Lanes& lanes)
      : view_(view),
        lines_(lines),
        lanes_(lanes),
        cells_(reinterpret_cast<const std::uint32_t*>(cells.cells.data())) {}

  Waiting run() {
    const LaneMask started = lanes_.walking;
    for (std::size_t step = 0; step < kSteps; ++step) {
      for (std::size_t first = 0; first < kLanes; first += kWidth) cross(first);
      for (std::size_t first = 0; first < kLanes; first += kWidth) fetch_refs(first);
      for (std::size_t first = 0; first < kLanes; first += kWidth) fetch_apexes(first);
    }
    Waiting waiting;
    for (std::size_t first = 0; first < kLanes; first += kWidth) stop_arrived(first);
    waiting.ended = ended_;
    waiting.corrupt = corrupt_ & ~ended_;
    lanes_.walking &= ~waiting.corrupt;
    waiting.arrived = started & ~lanes_.walking & ~ended_ & ~corrupt_;
    return waiting;
  }

 private:
  HWY_INLINE M walking(std::size_t first) const { return from_bits(lanes_.walking >> first); }
  HWY_INLINE void stop(std::size_t first, M lanes) { lanes_.walking &= ~(to_bits(lanes) << first); }

  /// Those before no tetrahedron, or before their target.
  HWY_INLINE M arrived(U ref, std::size_t first) const {
    const Signed signed_ids;
    return hn::Or(as_ids(hn::Lt(hn::BitCast(signed_ids, ref), hn::Zero(signed_ids))),
                  hn::Eq(ref, hn::Load(Ids(), &lanes_.target[first])));
  }
  HWY_INLINE void stop_arrived(std::size_t first) {
    stop(first, arrived(hn::Load(Ids(), &lanes_.ref[first]), first));
  }

  /// What lies across the faces; and has memory look for it. (Lane by lane: faster than gathers, by far.)
  HWY_INLINE void fetch_refs(std::size_t first) {
    Lanes& lanes = lanes_;
    const std::uint32_t* const cells = cells_;
    const Index tet_count = view_.tet_count();
    for (std::size_t lane = first; lane < first + kWidth; ++lane) {
      Ref ref = cells[lanes.at[lane]];
      if constexpr (Cells::kNeedsEntryRank)
        ref = lanes.previous[lane] ^ (ref & lanes.keep[lane]) ^
              (cells[lanes.at_entry[lane]] & lanes.keep_entry[lane]);
      lanes.ref[lane] = ref;
      const Index tet = ref & (Index{0} - static_cast<Index>(ref < tet_count));  // no branch
      lanes.cell[lane] = kStride * tet;
      hwy::Prefetch(cells + std::size_t{kStride} * tet);
    }
  }

  /// The vertices that come with the tetrahedra.
  HWY_INLINE void fetch_apexes(std::size_t first) {
    Lanes& lanes = lanes_;
    const std::uint32_t* const cells = cells_;
    const auto vertex_count = static_cast<Index>(view_.vertices().size());
    for (std::size_t lane = first; lane < first + kWidth; ++lane) {
      Index apex = cells[lanes.cell[lane]] ^ lanes.edges[lane];
      if (HWY_UNLIKELY(apex >= vertex_count)) {
        if (lanes.ref[lane] < view_.tet_count()) corrupt_ |= LaneMask{1} << lane & lanes.walking;
        apex = 0;
      }
      lanes.apex[lane] = apex;
      hwy::Prefetch(view_.vertices().data() + apex);
    }
  }

  /// Through the tetrahedra to their exit faces.
  HWY_INLINE void cross(std::size_t first) {
    Lanes& lanes = lanes_;
    const Floats f;
    const Ids u;
    const Signed signed_ids;
    const auto of = [&](PerLane<float>& values) HWY_ATTR { return hn::Load(f, &values[first]); };
    const auto ids_of = [&](PerLane<Index>& values) HWY_ATTR { return hn::Load(u, &values[first]); };
    constexpr bool kTet20 = !Cells::kNeedsEntryRank;
    const U ref = ids_of(lanes.ref), apex = ids_of(lanes.apex);
    U i0 = ids_of(lanes.ids[0]), i1 = ids_of(lanes.ids[1]), i2 = ids_of(lanes.ids[2]);
    M walking = hn::AndNot(arrived(ref, first), from_bits((lanes.walking & ~corrupt_) >> first));
    const M exists = hn::Lt(ref, hn::Set(u, view_.tet_count()));
    corrupt_ |= to_bits(hn::AndNot(exists, walking)) << first;
    walking = hn::And(walking, exists);
    U tet = ids_of(lanes.tet);
    if constexpr (!kTet20) hn::Store(select(walking, tet, ids_of(lanes.previous)), u, &lanes.previous[first]);
    tet = select(walking, ref, tet);
    hn::Store(tet, u, &lanes.tet[first]);

    const Points corner = load_points(view_.vertices().data(), &lanes.apex[first], &lanes.shuffle[first]);
    const F depth = hn::Sub(corner.z, of(lanes.origin[2]));
    const F x = hn::NegMulAdd(depth, of(lanes.slope_i), hn::Sub(corner.x, of(lanes.origin[0])));
    const F y = hn::NegMulAdd(depth, of(lanes.slope_j), hn::Sub(corner.y, of(lanes.origin[1])));
    const F z = hn::Mul(depth, of(lanes.sign_k));

    F x0 = of(lanes.x[0]), x1 = of(lanes.x[1]), x2 = of(lanes.x[2]);
    F y0 = of(lanes.y[0]), y1 = of(lanes.y[1]), y2 = of(lanes.y[2]);
    const F error = of(lanes.error), square = of(lanes.square);
    const F size = hn::Add(hn::Abs(x), hn::Abs(y));
    const F cross0 = hn::MulSub(x0, y, hn::Mul(y0, x));
    const F bound0 = hn::MulAdd(error, hn::Add(hn::Add(hn::Abs(x0), hn::Abs(y0)), size), square);
    M left0 = as_ids(hn::Gt(cross0, hn::Zero(f)));
    const F x12 = select(left0, x2, x1), y12 = select(left0, y2, y1);
    const F cross1 = hn::MulSub(x12, y, hn::Mul(y12, x));
    const F bound1 = hn::MulAdd(error, hn::Add(hn::Add(hn::Abs(x12), hn::Abs(y12)), size), square);
    M left1 = as_ids(hn::Gt(cross1, hn::Zero(f)));
    const M sure = as_ids(hn::And(hn::Gt(hn::Abs(cross0), bound0), hn::Gt(hn::Abs(cross1), bound1)));
    const M unsure = hn::AndNot(sure, walking);
    if (HWY_UNLIKELY(!hn::AllFalse(u, unsure))) {
      const Lefts lefts = exactly(first, {to_bits(left0), to_bits(left1)}, to_bits(unsure));
      left0 = from_bits(lefts.first);
      left1 = from_bits(lefts.second);
    }

    // Exit opposite corner 0 if both say the same.
    const M differ = hn::And(hn::Xor(left0, left1), walking);
    const M exit0 = hn::AndNot(differ, walking), exit1 = hn::And(differ, left0),
            exit2 = hn::AndNot(left0, differ);
    const U out = select(exit1, i1, select(exit2, i2, i0)), one = hn::Set(u, 1);
    const auto count = [&](U rank, U id, U other) HWY_ATTR {
      return select(as_ids(hn::Gt(hn::BitCast(signed_ids, id), hn::BitCast(signed_ids, other))),
                    hn::Add(rank, one), rank);
    };
    [[maybe_unused]] U entry_rank = hn::Zero(u);
    if constexpr (!kTet20) entry_rank = count(count(count(entry_rank, apex, i0), apex, i1), apex, i2);
    i0 = select(exit0, apex, i0);
    i1 = select(exit1, apex, i1);
    i2 = select(exit2, apex, i2);
    const F z0 = select(exit0, z, of(lanes.z[0])), z1 = select(exit1, z, of(lanes.z[1])),
            z2 = select(exit2, z, of(lanes.z[2]));
    hn::Store(i0, u, &lanes.ids[0][first]);
    hn::Store(i1, u, &lanes.ids[1][first]);
    hn::Store(i2, u, &lanes.ids[2][first]);
    hn::Store(select(exit0, x, x0), f, &lanes.x[0][first]);
    hn::Store(select(exit1, x, x1), f, &lanes.x[1][first]);
    hn::Store(select(exit2, x, x2), f, &lanes.x[2][first]);
    hn::Store(select(exit0, y, y0), f, &lanes.y[0][first]);
    hn::Store(select(exit1, y, y1), f, &lanes.y[1][first]);
    hn::Store(select(exit2, y, y2), f, &lanes.y[2][first]);
    hn::Store(z0, f, &lanes.z[0][first]);
    hn::Store(z1, f, &lanes.z[1][first]);
    hn::Store(z2, f, &lanes.z[2][first]);
    hn::Store(hn::Xor(hn::Xor(i0, i1), i2), u, &lanes.edges[first]);

    const U word = hn::Add(kTet20 ? hn::Add(hn::ShiftLeft<2>(tet), tet) : hn::ShiftLeft<2>(tet), one);
    if constexpr (kTet20) {
      // (of lanes that do not walk, any word of the cell)
      const U at = count(count(count(word, out, i0), out, i1), out, i2);
      hn::Store(select(walking, at, ids_of(lanes.at)), u, &lanes.at[first]);
    } else {
      const U exit_rank = count(count(count(hn::Zero(u), out, i0), out, i1), out, i2);
      const auto words = [&](U rank, PerLane<Index>& at, PerLane<Index>& keep) HWY_ATTR {
        const M last = hn::Eq(rank, hn::Set(u, 3));
        hn::Store(select(walking, select(last, word, hn::Add(word, rank)), ids_of(at)), u, &at[first]);
        hn::Store(select(walking, select(last, hn::Zero(u), hn::Set(u, ~Index{0})), ids_of(keep)), u,
                  &keep[first]);
      };
      words(exit_rank, lanes.at, lanes.keep);
      words(entry_rank, lanes.at_entry, lanes.keep_entry);
    }
    const M beyond = hn::And(as_ids(hn::Gt(hn::Min(z0, hn::Min(z1, z2)), of(lanes.limit))), walking);
    ended_ |= to_bits(beyond) << first;
    const LaneMask all = ((LaneMask{1} << kWidth) - 1) << first;
    lanes.walking = (lanes.walking & ~all) | to_bits(hn::AndNot(beyond, walking)) << first;
  }

  struct Lefts {
    LaneMask first, second;
  };
  HWY_NOINLINE Lefts exactly(std::size_t first, Lefts lefts, LaneMask unsure) const {
    for (; unsure != 0; unsure &= unsure - 1) {
      const auto in_vector = static_cast<std::size_t>(std::countr_zero(unsure)), lane = first + in_vector;
      const Line line = lines_.line(lanes_.ray[lane]);
      const auto corner = [&](Index id) { return Corner{view_.vertices()[id], id}; };
      const Corner apex = corner(lanes_.apex[lane]);
      const bool left0 = passes_left(line, corner(lanes_.ids[0][lane]), apex).left;
      const bool left1 = passes_left(line, corner(lanes_.ids[left0 ? 2 : 1][lane]), apex).left;
      const LaneMask bit = LaneMask{1} << in_vector;
      lefts.first = left0 ? lefts.first | bit : lefts.first & ~bit;
      lefts.second = left1 ? lefts.second | bit : lefts.second & ~bit;
    }
    return lefts;
  }

  const FileView& view_;
  const Lines& lines_;
  Lanes& lanes_;
  static constexpr std::uint32_t kStride = Cells::kNeedsEntryRank ? 4 : 5;
  const std::uint32_t* cells_;
  LaneMask ended_ = 0, corrupt_ = 0;
};

/// Whatever the order of the coordinates: x, y, z.
alignas(64) constexpr auto kInOrder = [] {
  std::array<std::array<std::uint8_t, 16>, kWidth> shuffles{};
  for (auto& shuffle : shuffles)
    for (std::size_t byte = 0; byte < 16; ++byte) shuffle[byte] = static_cast<std::uint8_t>(byte);
  return shuffles;
}();

/// Puts coordinates into the order i, j, k.
class Order {
 public:
  explicit Order(const Points& d) {
    const F x = hn::Abs(d.x), y = hn::Abs(d.y), z = hn::Abs(d.z);
    y_more_ = hn::Gt(y, x);
    z_most_ = hn::Gt(z, hn::IfThenElse(y_more_, y, x));
    swapped_ = hn::Lt(most(d), hn::Zero(Floats()));
  }
  HWY_INLINE Points operator()(const Points& p) const {
    const F after = hn::IfThenElse(z_most_, p.x, hn::IfThenElse(y_more_, p.z, p.y));
    const F before = hn::IfThenElse(z_most_, p.y, hn::IfThenElse(y_more_, p.x, p.z));
    return {hn::IfThenElse(swapped_, before, after), hn::IfThenElse(swapped_, after, before), most(p)};
  }
  /// As Walks::axes has it.
  HWY_INLINE U axes() const {
    const auto if_set = [](hn::Mask<Floats> mask, std::uint32_t value)
                            HWY_ATTR { return hn::IfThenElseZero(as_ids(mask), hn::Set(Ids(), value)); };
    return hn::Add(hn::IfThenElse(as_ids(z_most_), hn::Set(Ids(), 2), if_set(y_more_, 1)),
                   if_set(swapped_, 3));
  }

 private:
  HWY_INLINE F most(const Points& p) const {
    return hn::IfThenElse(z_most_, p.z, hn::IfThenElse(y_more_, p.y, p.x));
  }
  hn::Mask<Floats> y_more_, z_most_, swapped_;
};

HWY_INLINE F largest(F x, F y, F z) {
  return hn::Max(hn::Max(hn::Abs(x), hn::Abs(y)), hn::Abs(z));
}
HWY_INLINE Points minus(const Points& p, const Points& q) {
  return {hn::Sub(p.x, q.x), hn::Sub(p.y, q.y), hn::Sub(p.z, q.z)};
}

/// By which face rays leave the tetrahedra that they start in: section 5 of the spec, "Starting inside".
HWY_INLINE U exits(const Points& x, const Points& y, F x3, F y3, F error, U positive) {
  const Floats f;
  const Ids u;
  M sure = as_ids(hn::Eq(error, error));
  const F square =
      hn::MulAdd(hn::Mul(hn::Set(f, 4), error), error, hn::Set(f, std::numeric_limits<float>::min()));
  const auto left = [&](F ax, F ay, F bx, F by) HWY_ATTR {
    const F cross = hn::MulSub(ax, by, hn::Mul(ay, bx));
    const F size = hn::Add(hn::Add(hn::Abs(ax), hn::Abs(ay)), hn::Add(hn::Abs(bx), hn::Abs(by)));
    sure = hn::And(sure, as_ids(hn::Gt(hn::Abs(cross), hn::MulAdd(error, size, square))));
    return hn::Xor(as_ids(hn::Lt(cross, hn::Zero(f))), hn::Ne(positive, hn::Zero(u)));
  };
  const M l01 = left(x.x, y.x, x.y, y.y), l02 = left(x.x, y.x, x.z, y.z), l03 = left(x.x, y.x, x3, y3);
  const M l12 = left(x.y, y.y, x.z, y.z), l13 = left(x.y, y.y, x3, y3), l23 = left(x.z, y.z, x3, y3);
  // kOutwardFaces, edge by edge.
  const M exit0 = hn::AndNot(l13, hn::And(l12, l23)), exit1 = hn::AndNot(hn::Or(l23, l02), l03),
          exit2 = hn::AndNot(l03, hn::And(l01, l13)), exit3 = hn::AndNot(hn::Or(l12, l01), l02);
  U exit = hn::Set(u, Starts::unsure);
  exit = select(hn::And(exit0, sure), hn::Set(u, Starts::exit0), exit);
  exit = select(hn::And(exit1, sure), hn::Set(u, Starts::exit1), exit);
  exit = select(hn::And(exit2, sure), hn::Set(u, Starts::exit2), exit);
  return select(hn::And(exit3, sure), hn::Set(u, Starts::exit3), exit);
}

/// The bounds are those of the spec.
HWY_INLINE void prepare(const FileView& view, Starts& starts, std::size_t first) {
  const Floats f;
  const Ids u;
  const auto of = [&](const PerLane<float>& values) HWY_ATTR { return hn::Load(f, &values[first]); };
  const auto points = [&](const std::array<PerLane<float>, 3>& p) HWY_ATTR {
    return Points{of(p[0]), of(p[1]), of(p[2])};
  };
  const auto put = [&](F value, PerLane<float>& values) HWY_ATTR { hn::Store(value, f, &values[first]); };
  const auto set = [&](float value) HWY_ATTR { return hn::Set(f, value); };
  const auto with = [&](const Vec3f& p) HWY_ATTR { return Points{set(p.x), set(p.y), set(p.z)}; };

  const Points position = points(starts.position), direction = points(starts.direction);
  const Points low = minus(with(view.bounds().lower), position),
               high = minus(with(view.bounds().upper), position);
  const F reach =
      hn::Mul(hn::Max(largest(low.x, low.y, low.z), largest(high.x, high.y, high.z)), set(1 + 0x1p-20f));
  const F from_zero = largest(position.x, position.y, position.z);
  const F error = hn::MulAdd(set(12 * 0x1p-24f), reach, hn::Mul(set(3 * 0x1p-24f), from_zero));

  const Order order(direction);
  const Points d = order(direction), o = order(position);
  const F slope_i = hn::Div(d.x, d.z), slope_j = hn::Div(d.y, d.z), length = hn::Abs(d.z);
  const F sign = hn::CopySign(set(1), d.z);
  put(o.x, starts.origin[0]);
  put(o.y, starts.origin[1]);
  put(o.z, starts.origin[2]);
  put(slope_i, starts.slope_i);
  put(slope_j, starts.slope_j);
  put(sign, starts.sign_k);
  put(error, starts.error);
  put(hn::MulAdd(hn::Mul(set(4), error), error, set(std::numeric_limits<float>::min())), starts.square);
  put(hn::MulAdd(hn::Mul(of(starts.t_max), length), set(1 + 0x1p-20f), error), starts.limit);
  hn::Store(order.axes(), u, &starts.axes[first]);

  std::array<Points, 3> corners;
  for (std::size_t c = 0; c < 3; ++c) {
    corners[c] = order(load_points(view.vertices().data(), &starts.ids[c][first], kInOrder.data()));
    const Points p = minus(corners[c], o);
    put(hn::NegMulAdd(p.z, slope_i, p.x), starts.x[c]);
    put(hn::NegMulAdd(p.z, slope_j, p.y), starts.y[c]);
    put(hn::Mul(p.z, sign), starts.z[c]);
  }

  // Whether the ray goes through the face: its edges, projected.
  const Points b = minus(corners[1], corners[0]), c = minus(corners[2], corners[0]);
  const F bx = hn::NegMulAdd(b.z, slope_i, b.x), by = hn::NegMulAdd(b.z, slope_j, b.y);
  const F cx = hn::NegMulAdd(c.z, slope_i, c.x), cy = hn::NegMulAdd(c.z, slope_j, c.y);
  const F bound = hn::MulAdd(hn::Mul(set(128 * 0x1p-24f), largest(b.x, b.y, b.z)), largest(c.x, c.y, c.z),
                             set(std::numeric_limits<float>::min()));
  const M through = as_ids(hn::Gt(hn::MulSub(bx, cy, hn::Mul(by, cx)), bound));
  const U kind = hn::Load(u, &starts.kind[first]);
  const M known = hn::Eq(kind, hn::Set(u, Starts::known)),
          within_cell = hn::Eq(kind, hn::Set(u, Starts::within));

  const auto within = [&](F value, float least, float most) HWY_ATTR {
    return as_ids(hn::And(hn::Ge(value, set(least)), hn::Le(value, set(most))));
  };
  const M finite = hn::And(within(hn::Add(hn::Add(hn::Abs(o.x), hn::Abs(o.y)), hn::Abs(o.z)), 0, 0x1p60f),
                           within(hn::Add(hn::Abs(slope_i), hn::Abs(slope_j)), 0, 2));
  const M usual =
      hn::And(finite, hn::And(within(reach, 0x1p-50f, 0x1p50f), within(length, 0x1p-60f, 0x1p60f)));

  const auto status = [&](std::uint32_t value) HWY_ATTR { return hn::Set(u, value); };
  U found = select(hn::Or(through, known), status(Starts::ready), status(Starts::unsure));
  if (!hn::AllFalse(u, within_cell)) {
    const Points apex =
        minus(order(load_points(view.vertices().data(), &starts.apex[first], kInOrder.data())), o);
    const U exit = exits(points(starts.x), points(starts.y), hn::NegMulAdd(apex.z, slope_i, apex.x),
                         hn::NegMulAdd(apex.z, slope_j, apex.y), error, hn::Load(u, &starts.positive[first]));
    found = select(within_cell, exit, found);
  }
  hn::Store(select(usual, found, status(Starts::unusual)), u, &starts.status[first]);
}

void prepare(const FileView& view, Starts& starts) {
  for (std::size_t first = 0; first < kLanes; first += kWidth) prepare(view, starts, first);
}

Waiting advance(const FileView& view, const Lines& lines, Lanes& lanes) {
  return with_cells(view, [&](const auto& cells) {
    using Cells = std::remove_cvref_t<decltype(cells)>;
    return Walk<Cells>(view, cells, lines, lanes).run();
  });
}

constexpr BatchTarget kBatchTarget = {HWY_STR(HWY_NAMESPACE), kWidth, prepare, advance};

#endif

}  // namespace HWY_NAMESPACE
}  // namespace tetfmt::detail
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace tetfmt::detail {

std::span<const BatchTarget> batch_targets() {
  static const std::vector<BatchTarget> targets = [] {
    std::vector<BatchTarget> found;
#if HWY_TARGETS & HWY_AVX3
    if (has_avx512()) found.push_back(N_AVX3::kBatchTarget);
#endif
#if HWY_TARGETS & HWY_AVX2
    if (has_avx2()) found.push_back(N_AVX2::kBatchTarget);
#endif
#if HWY_TARGETS & HWY_SSE4
    if (has_sse4()) found.push_back(N_SSE4::kBatchTarget);
#endif
    found.push_back(HWY_NAMESPACE::kBatchTarget);  // what the compiler assumes anyway: the last one compiled
    return found;
  }();
  return targets;
}

}  // namespace tetfmt::detail
#endif
