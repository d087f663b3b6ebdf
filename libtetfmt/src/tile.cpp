// SPDX-License-Identifier: MIT
// Compiled once for each kind of processor, by Highway's headers; which one runs is chosen here, so that
// nothing of Highway is needed to link.
#include "tile.hpp"

#define HWY_DISABLED_TARGETS HWY_SSSE3
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "tile.cpp"
#include <hwy/foreach_target.h>
//
#include <hwy/highway.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "follow.hpp"

HWY_BEFORE_NAMESPACE();
namespace tetfmt::detail {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

/// Sixteen floats at a time, whatever the width of the registers.
using Lanes = hn::CappedTag<float, kBlockRays>;

struct TileRays {
  alignas(64) std::array<float, kTileRays> x, y, z;
  /// Of each block, the middle and half the extent of its directions.
  alignas(64) std::array<float, kBlocks> middle_x, middle_y, middle_z, half_x, half_y, half_z;
};

/// A moment (a - o) x (b - o), scaled, and the bound for the error of its product with a direction.
struct Moment {
  float x, y, z, bound;
};

struct Signs16 {
  std::uint32_t left = 0, right = 0;
};

HWY_INLINE std::uint32_t bits(Lanes d, hn::Mask<Lanes> mask) {
  std::array<std::uint8_t, 8> bytes{};
  hn::StoreMaskBits(d, mask, bytes.data());
  return static_cast<std::uint32_t>(bytes[0] | bytes[1] << 8);
}

/// The sixteen blocks at once: blocks that lie on one side.
HWY_INLINE Signs16 block_signs(const TileRays& rays, const Moment& m) {
  const Lanes d;
  const auto mx = hn::Set(d, m.x), my = hn::Set(d, m.y), mz = hn::Set(d, m.z), bound = hn::Set(d, m.bound);
  const auto ax = hn::Abs(mx), ay = hn::Abs(my), az = hn::Abs(mz);
  Signs16 signs;
  for (std::size_t i = 0; i < kBlocks; i += hn::Lanes(d)) {
    const auto at_middle = hn::MulAdd(
        hn::Load(d, &rays.middle_x[i]), mx,
        hn::MulAdd(hn::Load(d, &rays.middle_y[i]), my, hn::Mul(hn::Load(d, &rays.middle_z[i]), mz)));
    const auto around = hn::MulAdd(
        hn::Load(d, &rays.half_x[i]), ax,
        hn::MulAdd(hn::Load(d, &rays.half_y[i]), ay, hn::MulAdd(hn::Load(d, &rays.half_z[i]), az, bound)));
    signs.left |= bits(d, hn::Gt(at_middle, around)) << i;
    signs.right |= bits(d, hn::Lt(at_middle, hn::Neg(around))) << i;
  }
  return signs;
}

HWY_INLINE Signs16 ray_signs(const TileRays& rays, std::size_t block, const Moment& m) {
  const Lanes d;
  const auto mx = hn::Set(d, m.x), my = hn::Set(d, m.y), mz = hn::Set(d, m.z), bound = hn::Set(d, m.bound);
  Signs16 signs;
  for (std::size_t i = 0; i < kBlockRays; i += hn::Lanes(d)) {
    const std::size_t r = block * kBlockRays + i;
    const auto product =
        hn::MulAdd(hn::Load(d, &rays.x[r]), mx,
                   hn::MulAdd(hn::Load(d, &rays.y[r]), my, hn::Mul(hn::Load(d, &rays.z[r]), mz)));
    signs.left |= bits(d, hn::Gt(product, bound)) << i;
    signs.right |= bits(d, hn::Lt(product, hn::Neg(bound))) << i;
  }
  return signs;
}

/// Four bits to four blocks.
constexpr std::array<std::uint64_t, 16> kSpread = [] {
  std::array<std::uint64_t, 16> table{};
  for (unsigned i = 0; i < 16; ++i)
    for (unsigned b = 0; b < 4; ++b)
      if (i >> b & 1u) table[i] |= std::uint64_t{0xFFFF} << (16 * b);
  return table;
}();

/// Corners of a face as points relative to the rays' origin, scaled: coordinate by coordinate, the last
/// unused.
struct Corners {
  alignas(32) std::array<double, 4> x, y, z;
};

/// A visit that waits: these rays enter a tetrahedron by the face `ids`.
struct Pending {
  Corners at;
  RayMask rays;
  std::array<Index, 3> ids;
  std::uint32_t steps;  ///< at most this many visits, so far, of each ray
};

/// The visits that wait. No ray is in two of them, so there are no more than rays.
class Queue {
 public:
  bool empty() const { return count_ == 0; }
  /// The visit of `tet` by way of `previous`, if one waits.
  Pending* find(Index tet, Ref previous) {
    const std::uint64_t key = std::uint64_t{tet} << 32 | previous;
    for (std::size_t i = 0; i < count_; ++i)
      if (keys_[i] == key) return &pool_[slots_[i]];
    return nullptr;
  }
  Pending& add(Index tet, Ref previous, float depth) {
    keys_[count_] = std::uint64_t{tet} << 32 | previous;
    depths_[count_] = depth;
    return pool_[slots_[count_++]];
  }
  struct Next {
    Index tet;
    Ref previous;
    const Pending* visit;  ///< until the next take()
  };
  /// Takes out the nearest.
  Next take() {
    std::size_t nearest = 0;
    for (std::size_t i = 1; i < count_; ++i)
      if (depths_[i] < depths_[nearest]) nearest = i;
    --count_;
    const std::uint16_t taken = slots_[nearest];
    const std::uint64_t key = keys_[nearest];
    keys_[nearest] = keys_[count_];
    depths_[nearest] = depths_[count_];
    slots_[nearest] = slots_[count_];
    slots_[count_] = slots_[kTileRays];  // lend the spare one
    slots_[kTileRays] = taken;
    return {static_cast<Index>(key >> 32), static_cast<Ref>(key), &pool_[taken]};
  }

  Queue() : pool_(kTileRays + 1) {
    for (std::size_t i = 0; i <= kTileRays; ++i) slots_[i] = static_cast<std::uint16_t>(i);
  }

 private:
  std::size_t count_ = 0;
  std::array<std::uint64_t, kTileRays> keys_;
  std::array<float, kTileRays> depths_;
  std::array<std::uint16_t, kTileRays + 1>
      slots_;  ///< of the waiting ones, then the free ones, then the one taken
  std::vector<Pending> pool_;
};

template <bool kChecked, class Cells>
class TileWalk {
 public:
  TileWalk(const FileView& view, const Cells& cells, const Location& from, std::span<const Vec3f> directions,
           std::span<Hit> hits, Queue& queue)
      : view_(view),
        cells_(cells),
        from_(from),
        directions_(directions),
        hits_(hits),
        vertices_(view.vertices()),
        line_(line_from(view, from, {1, 0, 0})),
        queue_(queue) {}

  std::uint64_t run() {
    const double most = reach(line_, view_.bounds());
    if (most >= 0x1p-200 && most <= 0x1p200) {  // so it is in every valid file
      scale_ = std::ldexp(1.0, -std::ilogb(most) - 1);
      walk_all();
    } else {
      one_by_one(all());
    }
    static const Hit kMiss;
    (all() - met_).for_each([&](std::size_t r) { hits_[r] = kMiss; });
    return visits_;
  }

 private:
  void walk_all() {
    set_rays();
    if (from_.state == Location::State::inside)
      start_inside();
    else
      start_outside();
    while (!queue_.empty()) visit(queue_.take());
  }

  /// Copies the directions, component by component, and finds the boxes around them.
  void set_rays() {
    const std::size_t n = directions_.size();
    for (std::size_t r = 0; r < kTileRays; ++r) {
      const Vec3f& direction = directions_[std::min(r, n - 1)];
      rays_.x[r] = direction.x;
      rays_.y[r] = direction.y;
      rays_.z[r] = direction.z;
    }
    const Lanes d;
    for (std::size_t b = 0; b < kBlocks; ++b) {
      const auto extent = [&](const std::array<float, kTileRays>& of, float& middle, float& half) {
        auto low = hn::Load(d, &of[b * kBlockRays]), high = low;
        for (std::size_t i = hn::Lanes(d); i < kBlockRays; i += hn::Lanes(d)) {
          const auto more = hn::Load(d, &of[b * kBlockRays + i]);
          low = hn::Min(low, more);
          high = hn::Max(high, more);
        }
        const float least = hn::GetLane(hn::MinOfLanes(d, low)), most = hn::GetLane(hn::MaxOfLanes(d, high));
        middle = (least + most) / 2;
        half = std::max(most - middle, middle - least) * (1 + 0x1p-22f);
      };
      extent(rays_.x, rays_.middle_x[b], rays_.half_x[b]);
      extent(rays_.y, rays_.middle_y[b], rays_.half_y[b]);
      extent(rays_.z, rays_.middle_z[b], rays_.half_z[b]);
    }
    for (std::size_t b = 0; b < kBlocks; ++b) {
      axis_[0] += rays_.middle_x[b];
      axis_[1] += rays_.middle_y[b];
      axis_[2] += rays_.middle_z[b];
      largest_ = std::max({largest_, std::abs(rays_.middle_x[b]) + rays_.half_x[b],
                           std::abs(rays_.middle_y[b]) + rays_.half_y[b],
                           std::abs(rays_.middle_z[b]) + rays_.half_z[b]});
    }
  }

  Vec3d relative(Index id) const {
    const Vec3f& p = vertices_[id];
    return {(double{p.x} - line_.origin.point[0]) * scale_, (double{p.y} - line_.origin.point[1]) * scale_,
            (double{p.z} - line_.origin.point[2]) * scale_};
  }
  Corners corners(const std::array<Index, 3>& ids) const {
    Corners c{};
    for (std::size_t k = 0; k < 3; ++k) set_corner(c, k, relative(ids[k]));
    return c;
  }
  static void set_corner(Corners& c, std::size_t k, const Vec3d& p) {
    c.x[k] = p[0];
    c.y[k] = p[1];
    c.z[k] = p[2];
  }
  float depth(const Corners& c) const {
    return static_cast<float>(c.x[0] + c.x[1] + c.x[2]) * axis_[0] +
           static_cast<float>(c.y[0] + c.y[1] + c.y[2]) * axis_[1] +
           static_cast<float>(c.z[0] + c.z[1] + c.z[2]) * axis_[2];
  }

  struct Moments {
    alignas(16) std::array<float, 4> x, y, z, bound;
    Moment operator[](std::size_t k) const { return {x[k], y[k], z[k], bound[k]}; }
  };
  /// Of the edges from each corner to `p`.
  Moments moments(const Corners& c, const Vec3d& p) const {
    const hn::CappedTag<double, 4> d;
    const hn::Rebind<float, decltype(d)> f;
    const auto px = hn::Set(d, p[0]), py = hn::Set(d, p[1]), pz = hn::Set(d, p[2]);
    Moments m;
    for (std::size_t i = 0; i < 4; i += hn::Lanes(d)) {
      const auto ex = hn::Sub(hn::Load(d, &c.x[i]), px), ey = hn::Sub(hn::Load(d, &c.y[i]), py),
                 ez = hn::Sub(hn::Load(d, &c.z[i]), pz);
      const auto x = hn::Sub(hn::Mul(ey, pz), hn::Mul(ez, py)), y = hn::Sub(hn::Mul(ez, px), hn::Mul(ex, pz)),
                 z = hn::Sub(hn::Mul(ex, py), hn::Mul(ey, px));
      const auto size = hn::Add(hn::Add(hn::Abs(x), hn::Abs(y)), hn::Abs(z));
      const auto bound = hn::MulAdd(size, hn::Set(d, 0x1p-21 * largest_), hn::Set(d, 0x1p-45 * largest_));
      hn::Store(hn::DemoteTo(f, x), f, &m.x[i]);
      hn::Store(hn::DemoteTo(f, y), f, &m.y[i]);
      hn::Store(hn::DemoteTo(f, z), f, &m.z[i]);
      hn::Store(hn::DemoteTo(f, bound), f, &m.bound[i]);
    }
    return m;
  }

  /// Which of `rays` the edge from `a` to `b` passes on the left.
  HWY_INLINE RayMask left(const Moment& m, Index a, Index b, const RayMask& rays) {
    const Signs16 coarse = block_signs(rays_, m);
    RayMask result;
    for (std::size_t w = 0; w < 4; ++w) result.words[w] = kSpread[coarse.left >> (4 * w) & 15u];
    for (std::uint32_t open = ~(coarse.left | coarse.right) & 0xFFFF; open != 0; open &= open - 1) {
      const auto block = static_cast<std::size_t>(std::countr_zero(open));
      const std::uint32_t active = rays.block(block);
      if (active == 0) continue;
      const Signs16 fine = ray_signs(rays_, block, m);
      std::uint32_t bits = fine.left;
      if (const std::uint32_t unsure = ~(fine.left | fine.right) & active)
        bits |= exactly(a, b, block, unsure);
      result.words[block / 4] |= std::uint64_t{bits} << (16 * (block % 4));
    }
    return result;
  }

  HWY_NOINLINE std::uint32_t exactly(Index a, Index b, std::size_t block, std::uint32_t rays) {
    std::uint32_t result = 0;
    for (std::uint32_t rest = rays; rest != 0; rest &= rest - 1) {
      const auto lane = static_cast<std::size_t>(std::countr_zero(rest));
      Line line = line_;
      line.direction = to_vec3d(directions_[std::min(block * kBlockRays + lane, directions_.size() - 1)]);
      if (passes_left(line, {vertices_[a], a}, {vertices_[b], b}).left) result |= 1u << lane;
    }
    return result;
  }

  HWY_NOINLINE void start_inside() {
    const auto& v = from_.cell.vertices;
    if (!in_range(view_, from_.cell)) return one_by_one(all());
    std::array<std::array<RayMask, 4>, 4> lefts;
    for (std::size_t b = 1; b < 4; ++b) {
      const Moments m = moments(corners({v[0], v[1], v[2]}), relative(v[b]));
      for (std::size_t a = 0; a < b; ++a) {
        lefts[a][b] = left(m[a], v[a], v[b], all());
        lefts[b][a] = all() - lefts[a][b];
      }
    }
    RayMask rest = all();
    for (std::size_t k = 0; k < 4; ++k) {
      auto f = kOutwardFaces[k];
      if (!from_.positive) std::swap(f[1], f[2]);
      const RayMask through = lefts[f[0]][f[1]] & lefts[f[1]][f[2]] & lefts[f[2]][f[0]] & rest;
      rest = rest - through;
      const std::array<Index, 3> ids = {v[f[0]], v[f[1]], v[f[2]]};
      if (through.any()) leave(from_.cell.tet, from_.cell.neighbors[k], ids, corners(ids), through, 1);
    }
    if (rest.any()) one_by_one(rest);
  }

  HWY_NOINLINE void start_outside() {
    RayMask rest = all();
    for (const HullFace& face : view_.hull()) {
      const std::optional<bool> inwards = seen_from(view_, cells_, face, line_.origin);
      if (!inwards || !rest.any()) continue;
      auto v = face.vertices;
      if (!*inwards) std::swap(v[1], v[2]);
      const Corners at = corners(v);
      const auto edge = [&](std::size_t a, std::size_t b) {
        return left(moments(at, relative(v[b]))[a], v[a], v[b], rest);
      };
      const RayMask through = edge(0, 1) & edge(1, 2) & edge(2, 0) & rest;
      rest = rest - through;
      // Not merged with those that enter the tetrahedron by another of its hull faces: `previous` does not
      // tell.
      if (through.any()) wait(face.tet, kHull, v, at, through, 0);
    }
  }

  RayMask all() const { return RayMask::first(directions_.size()); }
  /// What a walk together cannot decide; then each ray has its own answer, whatever it is.
  HWY_NOINLINE void one_by_one(const RayMask& rays) {
    met_ = met_ | rays;
    rays.for_each([&](std::size_t r) {
      hits_[r] = first_hit(view_, from_, directions_[r]);
      visits_ += hits_[r].steps;
      hits_[r].steps = 0;
    });
  }

  HWY_INLINE void enter(Index tet, Ref previous, const std::array<Index, 3>& ids, const Corners& at,
                        const RayMask& rays, std::uint32_t steps) {
    if (Pending* const other = queue_.find(tet, previous)) {
      other->rays = other->rays | rays;
      other->steps = std::max(other->steps, steps);
      return;
    }
    wait(tet, previous, ids, at, rays, steps);
  }

  void wait(Index tet, Ref previous, const std::array<Index, 3>& ids, const Corners& at, const RayMask& rays,
            std::uint32_t steps) {
    Pending& next = queue_.add(tet, previous, depth(at));
    next.at = at;
    next.rays = rays;
    next.ids = ids;
    next.steps = steps;
  }

  HWY_INLINE void leave(Index tet, Ref ref, const std::array<Index, 3>& ids, const Corners& at,
                        const RayMask& rays, std::uint32_t steps) {
    if (is_tet(ref)) return enter(ref, tet, ids, at, rays, steps);
    if (ref != kHull) meet(tet, ref, ids, rays);
  }

  /// The rays' hits on one face: intersect(), some rays at a time, operation by operation: where
  /// most rays hit, this is most of the work.
  HWY_NOINLINE void meet(Index tet, Ref ref, const std::array<Index, 3>& ids, const RayMask& rays) {
    const Leaving leaving{tet, kHull, ids, kNone, kNone, ref, 0};
    const FaceMet face = face_met(view_, leaving);
    if (face.side == kNone) return one_by_one(rays);
    met_ = met_ | rays;
    const auto& v = face.piece->vertices;
    const Vec3f &a = vertices_[v[0]], &b = vertices_[v[1]], &c = vertices_[v[2]];
#if HWY_NATIVE_FMA
    const TriangleFrom triangle = triangle_from(line_.origin.point, a, b, c);
    const hn::CappedTag<double, 8> d;
    const hn::Rebind<float, decltype(d)> f;
    using V = hn::Vec<decltype(d)>;
    struct Sum {
      V value, rest;
    };
    const auto sum = [](V p, V q) {
      const V value = hn::Add(p, q), from_q = hn::Sub(value, p);
      return Sum{value, hn::Add(hn::Sub(p, hn::Sub(value, from_q)), hn::Sub(q, from_q))};
    };
    const auto product = [](V p, V q) {
      const V value = hn::Mul(p, q);
      return Sum{value, hn::MulSub(p, q, value)};
    };
    const auto set = [&](double value) { return hn::Set(d, value); };
    const auto dot = [&](const Vec3d& n, V x, V y, V z) {
      return hn::Add(hn::Add(hn::Mul(set(n[0]), x), hn::Mul(set(n[1]), y)), hn::Mul(set(n[2]), z));
    };
    for (std::size_t block = 0; block < kBlocks; ++block) {
      const std::uint32_t active = rays.block(block);
      if (active == 0) continue;
      for (std::size_t i = 0; i < kBlockRays; i += hn::Lanes(d)) {
        std::uint32_t rest = active >> i & ((1u << hn::Lanes(d)) - 1);
        if (rest == 0) continue;
        const std::size_t first = block * kBlockRays + i;
        const V x = hn::PromoteTo(d, hn::Load(f, &rays_.x[first])),
                y = hn::PromoteTo(d, hn::Load(f, &rays_.y[first])),
                z = hn::PromoteTo(d, hn::Load(f, &rays_.z[first]));
        const Sum nx = product(set(triangle.normal[0]), x), ny = product(set(triangle.normal[1]), y),
                  nz = product(set(triangle.normal[2]), z);
        const Sum nxy = sum(nx.value, ny.value), nxyz = sum(nxy.value, nz.value);
        const V along = hn::Add(
            nxyz.value, hn::Add(hn::Add(hn::Add(nx.rest, ny.rest), nz.rest), hn::Add(nxy.rest, nxyz.rest)));
        const V direction2 = hn::Add(hn::Add(hn::Mul(x, x), hn::Mul(y, y)), hn::Mul(z, z));
        const auto grazing = hn::Le(hn::Mul(along, along),
                                    hn::Mul(set(kGrazing2), hn::Mul(set(triangle.normal2), direction2)));
        const V zero = hn::Zero(d), one = set(1);
        const auto clamp = [&](V value, V most) {
          return hn::Add(hn::Min(hn::Max(value, zero), most), zero);
        };
        const V t = hn::Add(hn::Max(hn::Div(set(triangle.height), along), zero), zero);
        const V u = clamp(hn::Div(dot(triangle.for_u, x, y, z), along), one);
        const V w = clamp(hn::Div(dot(triangle.for_v, x, y, z), along), hn::Sub(one, u));
        alignas(64) std::array<double, 8> ts, us, ws, slow;
        hn::Store(t, d, ts.data());
        hn::Store(u, d, us.data());
        hn::Store(w, d, ws.data());
        hn::Store(hn::IfThenElseZero(grazing, one), d, slow.data());
        for (; rest != 0; rest &= rest - 1) {
          const auto lane = static_cast<std::size_t>(std::countr_zero(rest));
          const std::size_t r = first + lane;
          TrianglePoint at{ts[lane], us[lane], ws[lane]};
          if (slow[lane] != 0) at = intersect(line_.origin.point, to_vec3d(directions_[r]), a, b, c);
          describe_hit(view_, face, leaving, at, hits_[r]);
        }
      }
    }
#else
    rays.for_each([&](std::size_t r) {
      describe_hit(view_, face, leaving, intersect(line_.origin.point, to_vec3d(directions_[r]), a, b, c),
                   hits_[r]);
    });
#endif
    rays.for_each([&](std::size_t r) { hits_[r].steps = 0; });
  }

  void visit(const Queue::Next& next) {
    ++visits_;
    const auto& [tet, previous, pending] = next;
    const Pending& in = *pending;
    // No ray has come this far in a valid file, but the path may be one of several rays' parts.
    if (in.steps >= view_.tet_count()) return one_by_one(in.rays);
    if constexpr (kChecked) {
      if (tet >= view_.tet_count()) return one_by_one(in.rays);
    }
    const auto& [i0, i1, i2] = in.ids;
    const Index i3 = cells_.vertex_xor(tet) ^ i0 ^ i1 ^ i2;
    if constexpr (kChecked) {
      if (i3 >= vertices_.size()) return one_by_one(in.rays);
    }
    const Vec3d p3 = relative(i3);
    const Moments m = moments(in.at, p3);
    const RayMask l0 = left(m[0], i0, i3, in.rays), l1 = left(m[1], i1, i3, in.rays),
                  l2 = left(m[2], i2, i3, in.rays);
    const std::array<RayMask, 3> exits = {(in.rays & l0 & l2) | ((in.rays - l0) - l1), (in.rays & l0) - l2,
                                          (in.rays - l0) & l1};
    std::size_t entry_rank = 0;
    if constexpr (Cells::kNeedsEntryRank) entry_rank = rank(i3, i0, i1, i2);
    for (std::size_t k = 0; k < 3; ++k) {
      if (!exits[k].any()) continue;
      std::array<Index, 3> ids = in.ids;
      const std::size_t exit_rank = rank(ids[k], ids[(k + 1) % 3], ids[(k + 2) % 3], i3);
      ids[k] = i3;
      Corners at = in.at;
      set_corner(at, k, p3);
      leave(tet, cells_.next(tet, previous, entry_rank, exit_rank), ids, at, exits[k], in.steps + 1);
    }
  }

  const FileView& view_;
  const Cells& cells_;
  const Location& from_;
  std::span<const Vec3f> directions_;
  std::span<Hit> hits_;
  std::span<const Vec3f> vertices_;
  Line line_;
  Queue& queue_;
  double scale_ = 1;
  std::array<float, 3> axis_{};
  float largest_ = 0;  ///< component of a direction, or slightly more
  RayMask met_;
  TileRays rays_;
  std::uint64_t visits_ = 0;
};

template <bool kChecked>
std::uint64_t trace_tile(const FileView& view, const Location& from, std::span<const Vec3f> directions,
                         std::span<Hit> hits) {
  static thread_local Queue queue;
  return with_cells(view, [&](const auto& cells) {
    using Cells = std::remove_cvref_t<decltype(cells)>;
    return TileWalk<kChecked, Cells>(view, cells, from, directions, hits, queue).run();
  });
}

constexpr TileTarget kTarget = {HWY_STR(HWY_NAMESPACE), trace_tile<true>, trace_tile<false>};

}  // namespace HWY_NAMESPACE
}  // namespace tetfmt::detail
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace tetfmt::detail {

std::span<const TileTarget> tile_targets() {
  static const std::vector<TileTarget> targets = [] {
    std::vector<TileTarget> found;
#if HWY_ARCH_X86
    __builtin_cpu_init();
    const bool avx2 = __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma") &&
                      __builtin_cpu_supports("bmi") && __builtin_cpu_supports("bmi2");
#if HWY_TARGETS & HWY_AVX3
    if (avx2 && __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512vl") &&
        __builtin_cpu_supports("avx512dq") && __builtin_cpu_supports("avx512bw"))
      found.push_back(N_AVX3::kTarget);
#endif
#if HWY_TARGETS & HWY_AVX2
    if (avx2) found.push_back(N_AVX2::kTarget);
#endif
#if HWY_TARGETS & HWY_SSE4
    if (__builtin_cpu_supports("sse4.2")) found.push_back(N_SSE4::kTarget);
#endif
#endif
    found.push_back(HWY_NAMESPACE::kTarget);  // what the compiler assumes anyway: the last one compiled
    return found;
  }();
  return targets;
}

}  // namespace tetfmt::detail
#endif
