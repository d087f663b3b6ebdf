// SPDX-License-Identifier: MIT
// What a tile of rays is asked: see TileWalk. Compiled once a kind of processor: see tile.cpp.
#if defined(TETFMT_TILE_TASKS_HPP) == defined(HWY_TARGET_TOGGLE)
#ifdef TETFMT_TILE_TASKS_HPP
#undef TETFMT_TILE_TASKS_HPP
#else
#define TETFMT_TILE_TASKS_HPP
#endif

#include <hwy/highway.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <span>

#include "follow.hpp"
#include "tile.hpp"
#include "tile_signs.hpp"

HWY_BEFORE_NAMESPACE();
namespace tetfmt::detail {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

/// Which face each ray meets first, and where.
class FirstHitsTask {
 public:
  static constexpr bool kEndsInTets = false;

  FirstHitsTask(const FileView& view, const Location& from, std::span<const Vec3f> directions,
                std::span<Hit> hits)
      : view_(view), from_(from), directions_(directions), hits_(hits) {}

  std::size_t size() const { return directions_.size(); }
  RayMask set_rays(TileRays& rays, const Line&) const {
    const std::size_t n = directions_.size();
    std::size_t r = 0;
    bool all = true;
#if HWY_TARGET != HWY_SCALAR
    const Lanes d;
    for (; r + hn::Lanes(d) <= n; r += hn::Lanes(d)) {
      static_assert(sizeof(Vec3f) == 3 * sizeof(float));
      hn::Vec<Lanes> x, y, z;
      hn::LoadInterleaved3(d, &directions_[r].x, x, y, z);
      const auto largest = hn::Max(hn::Max(hn::Abs(x), hn::Abs(y)), hn::Abs(z)),
                 sum = hn::Add(hn::Add(x, y), z);
      all = all && hn::AllTrue(d, hn::And(hn::And(hn::Ge(largest, hn::Set(d, kLeast)),
                                                  hn::Le(largest, hn::Set(d, kMost))),
                                          hn::Eq(sum, sum)));
      hn::Store(x, d, &rays.x[r]);
      hn::Store(y, d, &rays.y[r]);
      hn::Store(z, d, &rays.z[r]);
    }
#endif
    for (; r < n; ++r) {
      all = all && suits(directions_[r]);
      rays.x[r] = directions_[r].x;
      rays.y[r] = directions_[r].y;
      rays.z[r] = directions_[r].z;
    }
    RayMask walked;
    if (all) {
      walked = RayMask::first(n);
    } else {
      for (r = 0; r < n; ++r)
        if (suits(directions_[r])) walked.add(r);
    }
    if (walked.any()) rays.enclose(walked, n);
    return walked;
  }
  void line(Line& line, std::size_t r) const {
    line.direction = to_vec3d(directions_[r]);
  }

  std::uint64_t alone(std::size_t r) const {
    hits_[r] = first_hit(view_, from_, directions_[r]);
    return std::exchange(hits_[r].steps, 0);
  }
  void leave(const RayMask& rays) const {
    static constexpr Hit kMiss;
    rays.for_each([&](std::size_t r) { hits_[r] = kMiss; });
  }

  bool ends_in(Index, std::size_t) const {
    return false;
  }
  bool meet_alone(const Line& line, const Leaving& leaving, std::size_t r) const {
    describe_hit(view_, line, leaving, hits_[r]);
    hits_[r].steps = 0;
    return hits_[r].outcome == Outcome::hit;
  }
  bool meet(const Line& line, const Leaving& leaving, const RayMask& rays, const TileRays& tile) const {
    const FaceMet face = face_met(view_, leaving);
    if (face.side == kNone) return false;
    const auto vertices = view_.vertices();
    const auto& v = face.piece->vertices;
    const Vec3f &a = vertices[v[0]], &b = vertices[v[1]], &c = vertices[v[2]];
    Hit hit;  // all that the rays have in common
    describe_hit(view_, face, leaving, {}, hit);
    const auto describe = [&](std::size_t r, const TrianglePoint& at) {
      if (face.whole != face.piece) return describe_hit(view_, face, leaving, at, hits_[r]);
      Hit& met = hits_[r];
      met = hit;
      met.t = at.t;
      met.u = met.side_u = at.u;
      met.v = met.side_v = at.v;
    };
    const auto alone = [&](std::size_t r) {
      return intersect(line.origin.point, to_vec3d(directions_[r]), a, b, c);
    };
#if HWY_NATIVE_FMA
    const Points points(triangle_from(line.origin.point, a, b, c));
    rays.for_each_block([&](std::size_t block, std::uint32_t active) {
      alignas(64) std::array<double, kBlockRays> t, u, v2;
      const std::uint32_t grazing = points.find(tile, block, active, t, u, v2);
      for (; active != 0; active &= active - 1) {
        const auto lane = static_cast<std::size_t>(std::countr_zero(active));
        const std::size_t r = block * kBlockRays + lane;
        describe(r, (grazing >> lane & 1u) == 0 ? TrianglePoint{t[lane], u[lane], v2[lane]} : alone(r));
      }
    });
#else
    (void)tile;
    rays.for_each([&](std::size_t r) { describe(r, alone(r)); });
#endif
    return true;
  }

 private:
  static constexpr float kLeast = 0x1p-60f, kMost = 0x1p60f;
  static bool suits(const Vec3f& d) {
    const float largest = std::max({std::abs(d.x), std::abs(d.y), std::abs(d.z)}), sum = d.x + d.y + d.z;
    return largest >= kLeast && largest <= kMost && sum == sum;
  }

#if HWY_NATIVE_FMA
  /// intersect() for some rays at a time, operation by operation: where most rays hit, it is most of the
  /// work.
  class Points {
   public:
    explicit Points(const TriangleFrom& triangle) : triangle_(triangle) {}

    /// Of a block's `active` rays. Returns those that graze the triangle, for which this is no good.
    HWY_INLINE std::uint32_t find(const TileRays& tile, std::size_t block, std::uint32_t active,
                                  std::array<double, kBlockRays>& t, std::array<double, kBlockRays>& u,
                                  std::array<double, kBlockRays>& v) const {
      std::uint32_t grazing = 0;
      for (std::size_t i = 0; i < kBlockRays; i += hn::Lanes(D())) {
        if ((active >> i & ((1u << hn::Lanes(D())) - 1)) == 0) continue;
        const std::size_t first = block * kBlockRays + i;
        const hn::Rebind<float, D> f;
        const V x = hn::PromoteTo(D(), hn::Load(f, &tile.x[first])),
                y = hn::PromoteTo(D(), hn::Load(f, &tile.y[first])),
                z = hn::PromoteTo(D(), hn::Load(f, &tile.z[first]));
        const Sum nx = product(set(triangle_.normal[0]), x), ny = product(set(triangle_.normal[1]), y),
                  nz = product(set(triangle_.normal[2]), z);
        const Sum nxy = sum(nx.value, ny.value), nxyz = sum(nxy.value, nz.value);
        const V along = hn::Add(
            nxyz.value, hn::Add(hn::Add(hn::Add(nx.rest, ny.rest), nz.rest), hn::Add(nxy.rest, nxyz.rest)));
        const V direction2 = hn::Add(hn::Add(hn::Mul(x, x), hn::Mul(y, y)), hn::Mul(z, z));
        grazing |= bits(D(), hn::Le(hn::Mul(along, along),
                                    hn::Mul(set(kGrazing2), hn::Mul(set(triangle_.normal2), direction2))))
                   << i;
        const V zero = hn::Zero(D()), one = set(1);
        const auto clamp = [&](V value, V most) {
          return hn::Add(hn::Min(hn::Max(value, zero), most), zero);
        };
        const V at_u = clamp(hn::Div(dot(triangle_.for_u, x, y, z), along), one);
        hn::Store(hn::Add(hn::Max(hn::Div(set(triangle_.height), along), zero), zero), D(), &t[i]);
        hn::Store(at_u, D(), &u[i]);
        hn::Store(clamp(hn::Div(dot(triangle_.for_v, x, y, z), along), hn::Sub(one, at_u)), D(), &v[i]);
      }
      return grazing;
    }

   private:
    using D = hn::CappedTag<double, 8>;
    using V = hn::Vec<D>;
    struct Sum {
      V value, rest;
    };
    static HWY_INLINE Sum sum(V p, V q) {
      const V value = hn::Add(p, q), from_q = hn::Sub(value, p);
      return {value, hn::Add(hn::Sub(p, hn::Sub(value, from_q)), hn::Sub(q, from_q))};
    }
    static HWY_INLINE Sum product(V p, V q) {
      const V value = hn::Mul(p, q);
      return {value, hn::MulSub(p, q, value)};
    }
    static HWY_INLINE V set(double value) { return hn::Set(D(), value); }
    static HWY_INLINE V dot(const Vec3d& n, V x, V y, V z) {
      return hn::Add(hn::Add(hn::Mul(set(n[0]), x), hn::Mul(set(n[1]), y)), hn::Mul(set(n[2]), z));
    }
    TriangleFrom triangle_;
  };
#endif

  const FileView& view_;
  const Location& from_;
  std::span<const Vec3f> directions_;
  std::span<Hit> hits_;
};

/// Whether anything lies between the tile's origin and each target. The rays are the exact lines from one to
/// the other; their directions in TileRays are rounded, to a length of 1 in the largest component.
class OcclusionsTask {
 public:
  static constexpr bool kEndsInTets = true;

  OcclusionsTask(const FileView& view, const Location& from, std::span<const Location> targets,
                 std::span<Outcome> outcomes)
      : view_(view), from_(from), targets_(targets), outcomes_(outcomes) {}

  std::size_t size() const { return targets_.size(); }
  RayMask set_rays(TileRays& rays, const Line& line) {
    RayMask walked;
    for (std::size_t r = 0; r < targets_.size(); ++r) {
      tets_[r] = kNone;
      if (!set_ray(rays, line, r)) continue;
      walked.add(r);
      if (targets_[r].state != Location::State::inside) continue;
      tets_[r] = targets_[r].cell.tet;
      filter_[tets_[r] / 64 % filter_.size()] |= std::uint64_t{1} << (tets_[r] % 64);
    }
    if (walked.any()) rays.enclose(walked, targets_.size());
    return walked;
  }
  void line(Line& line, std::size_t r) const {
    const Location& to = targets_[r];
    line.direction = minus(to.position, line.origin.point);
    line.toward = place(to);
    line.through_point = true;
  }

  /// The targets in `tet` are seen. Takes them out of `rays` and returns them.
  HWY_INLINE RayMask entering(Index tet, RayMask& rays) const {
    RayMask there;
    if ((filter_[tet / 64 % filter_.size()] >> (tet % 64) & 1u) == 0) return there;
    return find(tet, rays);
  }
  bool ends_in(Index tet, std::size_t r) const {
    if (tets_[r] != tet) return false;
    outcomes_[r] = Outcome::miss;
    return true;
  }
  bool meet(const Line&, const Leaving& leaving, const RayMask& rays, const TileRays&) const {
    meet(leaving, rays);
    return true;
  }
  bool meet_alone(const Line&, const Leaving& leaving, std::size_t r) const {
    RayMask ray;
    ray.add(r);
    meet(leaving, ray);
    return true;
  }
  std::uint64_t alone(std::size_t r) const {
    outcomes_[r] = occlusion(view_, from_, targets_[r]);
    return 0;
  }
  void leave(const RayMask& rays) const {
    rays.for_each([&](std::size_t r) { outcomes_[r] = Outcome::miss; });
  }

 private:
  void meet(const Leaving& leaving, const RayMask& rays) const {
    std::array<Corner, 3> corners;
    std::array<Vec3d, 3> at;
    for (std::size_t k = 0; k < 3; ++k) {
      corners[k] = {view_.vertices()[leaving.ids[k]], leaving.ids[k]};
      at[k] = to_vec3d(corners[k].point);
    }
    rays.for_each([&](std::size_t r) {
      const Vec3d& to = targets_[r].position;
      const int sign = certified_sign(minus(at[0], to), minus(at[1], to), minus(at[2], to));
      const bool late = sign != 0 ? sign > 0 : behind(corners[0], corners[1], corners[2], place(targets_[r]));
      outcomes_[r] = late ? Outcome::miss : Outcome::hit;  // the face may be met after the end
    });
  }
  Place place(const Location& to) const { return {to.position, lift_of(view_, to)}; }

  /// False if there is no line to follow, or nothing on it.
  bool set_ray(TileRays& rays, const Line& line, std::size_t r) const {
    const Location& to = targets_[r];
    using State = Location::State;
    if (to.state != State::inside && to.state != State::outside) return false;
    if (to.state == State::inside && from_.state == State::inside && to.cell.tet == from_.cell.tet)
      return false;
    const Vec3d d = minus(to.position, line.origin.point);
    const double largest = std::max({std::abs(d[0]), std::abs(d[1]), std::abs(d[2])});
    if (!is_finite(d) || largest == 0) return false;
    rays.x[r] = static_cast<float>(d[0] / largest);
    rays.y[r] = static_cast<float>(d[1] / largest);
    rays.z[r] = static_cast<float>(d[2] / largest);
    return true;
  }
  HWY_NOINLINE RayMask find(Index tet, RayMask& rays) const {
    const hn::CappedTag<std::uint32_t, kBlockRays> d;
    RayMask there;
    rays.for_each_block([&](std::size_t block, std::uint32_t active) {
      std::uint32_t equal = 0;
      for (std::size_t i = 0; i < kBlockRays; i += hn::Lanes(d))
        equal |= bits(d, hn::Eq(hn::Load(d, &tets_[block * kBlockRays + i]), hn::Set(d, tet))) << i;
      if ((equal &= active) == 0) return;
      there.add_block(block, equal);
    });
    leave(there);
    rays = rays - there;
    return there;
  }

  const FileView& view_;
  const Location& from_;
  std::span<const Location> targets_;
  std::span<Outcome> outcomes_;
  alignas(64) std::array<Index, kTileRays> tets_;  ///< of the targets
  /// Bit t % 64 of word t / 64 % size: whether tetrahedron t may hold a target.
  std::array<std::uint64_t, 128> filter_{};
};

}  // namespace HWY_NAMESPACE
}  // namespace tetfmt::detail
HWY_AFTER_NAMESPACE();

#endif
