// SPDX-License-Identifier: MIT
// The walk of one tile of rays. Compiled once a kind of processor: see tile.cpp.
#if defined(TETFMT_TILE_WALK_HPP) == defined(HWY_TARGET_TOGGLE)
#ifdef TETFMT_TILE_WALK_HPP
#undef TETFMT_TILE_WALK_HPP
#else
#define TETFMT_TILE_WALK_HPP
#endif

#include <hwy/highway.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

#include "follow.hpp"
#include "tile.hpp"
#include "tile_queue.hpp"
#include "tile_signs.hpp"

HWY_BEFORE_NAMESPACE();
namespace tetfmt::detail {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

/// Walks the rays of a task, and tells it what becomes of them. A task (tile_tasks.hpp) has
///
///   size()               how many rays there are
///   set_rays(rays, l)    fills in and encloses directions, as close to the exact ones as float is
///                        (l: a line from the origin); returns the rays that have one: others go alone
///   line(l, r)           makes l the exact line of ray r
///   entering(tet, rays)  takes those that end in the tetrahedron out of `rays`, and returns them
///   meet(l, leaving, rays, all)   these meet a constrained face; false if its indices do not exist
///   ends_in(tet, r), meet_alone(l, leaving, r)   the same two for one ray and its line
///   alone(r)             ray r is to be answered from its start, by itself; returns its steps
///   leave(rays)          these met nothing
template <bool kChecked, class Cells, class Task>
class TileWalk {
 public:
  TileWalk(const FileView& view, const Cells& cells, const Location& from, Task& task, Queue& queue)
      : view_(view),
        cells_(cells),
        from_(from),
        vertices_(view.vertices()),
        line_(line_from(view, from, {1, 0, 0})),
        task_(task),
        queue_(queue) {}

  std::uint64_t run() {
    RayMask rays = task_.set_rays(rays_, line_);
    unanswered_ = RayMask::first(task_.size());
    if (const RayMask rest = unanswered_ - rays; rest.any()) one_by_one(rest);
    const double most = reach(line_, view_.bounds());
    if (most >= 0x1p-200 && most <= 0x1p200) {  // so it is in every valid file
      scale_ = std::ldexp(1.0, -std::ilogb(most) - 1);
      rays = may_meet_surface(rays);
      if (from_.state == Location::State::inside)
        start_inside(rays);
      else
        start_outside(rays);
      while (!queue_.empty()) {
        visit(queue_.take());
        queue_.release();
      }
    } else {
      one_by_one(rays);
    }
    task_.leave(unanswered_);
    return visits_ + lone_steps_;
  }

 private:
  Vec3d relative(Index id) const {
    const Vec3f& p = vertices_[id];
    return {(double{p.x} - line_.origin.point[0]) * scale_, (double{p.y} - line_.origin.point[1]) * scale_,
            (double{p.z} - line_.origin.point[2]) * scale_};
  }
  HWY_INLINE void set_corner(Crossing& c, std::size_t k, Index id, const Vec3d& p) const {
    c.x[k] = p[0];
    c.y[k] = p[1];
    c.z[k] = p[2];
    const auto& axis = rays_.axis();
    c.depths[k] = static_cast<float>(p[0]) * axis[0] + static_cast<float>(p[1]) * axis[1] +
                  static_cast<float>(p[2]) * axis[2];
    c.ids[k] = id;
  }
  Crossing crossing(const std::array<Index, 3>& ids) const {
    Crossing c{};
    for (std::size_t k = 0; k < 3; ++k) set_corner(c, k, ids[k], relative(ids[k]));
    return c;
  }

  /// Of the edges from each corner to `p`.
  HWY_INLINE Moments moments(const Crossing& c, const Vec3d& p) const {
    const hn::CappedTag<double, 4> d;
    const hn::Rebind<float, decltype(d)> f;
    const auto px = hn::Set(d, p[0]), py = hn::Set(d, p[1]), pz = hn::Set(d, p[2]);
    Moments m;
    for (std::size_t i = 0; i < 4; i += hn::Lanes(d)) {
      const auto ex = hn::Sub(hn::Load(d, &c.x[i]), px), ey = hn::Sub(hn::Load(d, &c.y[i]), py),
                 ez = hn::Sub(hn::Load(d, &c.z[i]), pz);
      rays_.set_moments(f, hn::DemoteTo(f, hn::Sub(hn::Mul(ey, pz), hn::Mul(ez, py))),
                        hn::DemoteTo(f, hn::Sub(hn::Mul(ez, px), hn::Mul(ex, pz))),
                        hn::DemoteTo(f, hn::Sub(hn::Mul(ex, py), hn::Mul(ey, px))), i, m);
    }
    return m;
  }

  /// Parts a group of `rays` by kCount edges from the corners `a` to `b`, whose moments begin with the
  /// `first` of `m`. Returns those that each edge passes on the left; of rays that are not in the set,
  /// anything.
  template <std::size_t kCount>
  HWY_INLINE std::array<GroupBits, kCount> part(const Moments& m, std::size_t first,
                                                const std::array<Index, kCount>& a, Index b,
                                                std::size_t group, const RayMask& rays,
                                                std::uint32_t blocks) {
    std::array<Signs16, kCount> coarse;
    std::uint64_t open = 0;  // bit 16 k + b: block b by edge k
    for (std::size_t k = 0; k < kCount; ++k) {
      coarse[k] = rays_.blocks(group, m, first + k);
      open |= std::uint64_t{~(coarse[k].left | coarse[k].right) & blocks} << (16 * k);
    }
    std::array<GroupBits, kCount> left;
    for (std::size_t k = 0; k < kCount; ++k) left[k] = GroupBits::of_blocks(coarse[k].left);
    for (; open != 0; open &= open - 1) {
      const auto bit = static_cast<std::size_t>(std::countr_zero(open)), k = bit / 16, at = bit % 16;
      const std::size_t block = group * kGroupBlocks + at;
      const Signs16 fine = rays_.rays(block, m, first + k);
      std::uint32_t found = fine.left;
      if (const std::uint32_t unsure = ~(fine.left | fine.right) & rays.block(block)) [[unlikely]]
        found |= exactly(a[k], b, block, unsure);
      left[k] = left[k].with(at, found);
    }
    return left;
  }
  /// The rays that the edge from `a` to `b` passes on the left, of moment k.
  RayMask left(const Moments& m, std::size_t k, Index a, Index b, const RayMask& rays) {
    RayMask result;
    rays.for_each_group([&](std::size_t g) {
      const GroupBits group(rays.group[g]);
      store(part<1>(m, k, {a}, b, g, rays, group.blocks())[0] & group, g, result);
    });
    return result;
  }
  static HWY_INLINE void store(const GroupBits& rays, std::size_t g, RayMask& mask) {
    rays.store(mask.group[g]);
    mask.groups |= static_cast<std::uint32_t>(rays.blocks() != 0) << g;
  }

  HWY_NOINLINE std::uint32_t exactly(Index a, Index b, std::size_t block, std::uint32_t rays) {
    std::uint32_t result = 0;
    Line line = line_;
    for (std::uint32_t rest = rays; rest != 0; rest &= rest - 1) {
      const auto lane = static_cast<std::size_t>(std::countr_zero(rest));
      task_.line(line, block * kBlockRays + lane);
      if (passes_left(line, {vertices_[a], a}, {vertices_[b], b}).left) result |= 1u << lane;
    }
    return result;
  }

  /// Those of `rays` that do not certainly miss the box around the surface: those that may pass through a
  /// face of it that the origin sees.
  HWY_NOINLINE RayMask may_meet_surface(const RayMask& rays) const {
    const Bounds& box = view_.surface_bounds();
    const std::array<std::array<float, 3>, 2> ends = {
        {{box.lower.x, box.lower.y, box.lower.z}, {box.upper.x, box.upper.y, box.upper.z}}};
    RayMask result;
    bool inside = true;
    for (std::size_t k = 0; k < 3; ++k) {
      const double o = line_.origin.point[k];
      const bool below = o<ends[0][k], above = o> ends[1][k];
      if (!below && !above) continue;
      inside = false;
      // The corners in the order in which they run counter-clockwise about a ray that goes in.
      const std::size_t i = (k + (below ? 1 : 2)) % 3, j = 3 - k - i;
      std::array<Vec3d, 4> corners;
      for (std::size_t c = 0; c < 4; ++c) {
        Vec3d at;
        at[k] = ends[below ? 0 : 1][k];
        at[i] = ends[c == 1 || c == 2 ? 1 : 0][i];
        at[j] = ends[c >= 2 ? 1 : 0][j];
        for (std::size_t axis = 0; axis < 3; ++axis)
          corners[c][axis] = (at[axis] - line_.origin.point[axis]) * scale_;
      }
      RayMask through = rays;
      for (std::size_t c = 0; c < 4; ++c) {
        Crossing edge{};
        for (std::size_t axis = 0; axis < 3; ++axis)
          (axis == 0 ? edge.x : axis == 1 ? edge.y : edge.z)[0] = corners[c][axis];
        through = not_right(moments(edge, corners[(c + 1) % 4]), through);
      }
      result |= through;
    }
    return inside ? rays : result;
  }
  /// Those that the edge of the first moment does not certainly pass on the right.
  RayMask not_right(const Moments& m, const RayMask& rays) const {
    RayMask result;
    rays.for_each_group([&](std::size_t g) {
      const GroupBits group(rays.group[g]);
      const Signs16 coarse = rays_.blocks(g, m, 0);
      GroupBits passed = group - GroupBits::of_blocks(coarse.right);
      for (std::uint32_t open = group.blocks() & ~(coarse.left | coarse.right); open != 0; open &= open - 1) {
        const auto at = static_cast<std::size_t>(std::countr_zero(open));
        const std::uint32_t right = rays_.rays(g * kGroupBlocks + at, m, 0).right;
        passed = passed - GroupBits::of_blocks(0).with(at, right);
      }
      store(passed, g, result);
    });
    return result;
  }

  HWY_NOINLINE void start_inside(const RayMask& rays) {
    const auto& v = from_.cell.vertices;
    if (!in_range(view_, from_.cell)) return one_by_one(rays);
    std::array<std::array<RayMask, 4>, 4> lefts;
    for (std::size_t b = 1; b < 4; ++b) {
      const Moments m = moments(crossing({v[0], v[1], v[2]}), relative(v[b]));
      for (std::size_t a = 0; a < b; ++a) {
        lefts[a][b] = left(m, a, v[a], v[b], rays);
        lefts[b][a] = rays - lefts[a][b];
      }
    }
    RayMask rest = rays;
    for (std::size_t k = 0; k < 4; ++k) {
      auto f = kOutwardFaces[k];
      if (!from_.positive) std::swap(f[1], f[2]);
      RayMask through = lefts[f[0]][f[1]] & lefts[f[1]][f[2]] & lefts[f[2]][f[0]] & rest;
      rest = rest - through;
      if (through.any())
        leave(from_.cell.tet, from_.cell.neighbors[k], crossing({v[f[0]], v[f[1]], v[f[2]]}), through, 1);
    }
    if (rest.any()) one_by_one(rest);
  }

  HWY_NOINLINE void start_outside(const RayMask& rays) {
    RayMask rest = rays;
    const auto try_face = [&](const HullFace& face, bool inwards) {
      auto v = face.vertices;
      if (face.tet >= view_.tet_count() || std::max({v[0], v[1], v[2]}) >= vertices_.size()) return;
      if (!inwards) std::swap(v[1], v[2]);
      const Crossing by = crossing(v);
      const auto edge = [&](std::size_t a, std::size_t b) {
        return left(moments(by, relative(v[b])), a, v[a], v[b], rest);
      };
      const RayMask through = edge(0, 1) & edge(1, 2) & edge(2, 0);
      rest = rest - through;
      // Not merged with those that enter the tetrahedron by another of its hull faces: `previous` does not
      // tell.
      if (through.any()) wait(face.tet, kHull, by, through, 0);
    };
    if (from_.entrance_count <= from_.entrances.size()) {
      for (std::size_t i = 0; i < from_.entrance_count && rest.any(); ++i) {
        const Entrance entrance = unpack_entrance(from_.entrances[i]);
        if (entrance.face < view_.hull().size()) try_face(view_.hull()[entrance.face], entrance.inwards);
      }
      return;
    }
    for (const HullFace& face : view_.hull()) {
      if (!rest.any()) return;
      if (const auto inwards = seen_from(view_, cells_, face, line_.origin)) try_face(face, *inwards);
    }
  }

  /// What a walk together cannot decide; then each ray has its own answer, whatever it is.
  HWY_NOINLINE void one_by_one(const RayMask& rays) {
    unanswered_ = unanswered_ - rays;
    rays.for_each([&](std::size_t r) { lone_steps_ += task_.alone(r); });
  }

  /// `rays` leave `tet` by the face `by` for what `ref` names.
  HWY_INLINE void leave(Index tet, Ref ref, const Crossing& by, RayMask& rays, std::uint32_t steps) {
    if (is_tet(ref)) {
      if constexpr (Task::kEndsInTets) {
        unanswered_ = unanswered_ - task_.entering(ref, rays);
        if (!rays.any()) return;
      }
      if (Pending* const other = queue_.find(ref, tet)) {
        other->rays |= rays;
        other->steps = std::max(other->steps, steps);
      } else {
        wait(ref, tet, by, rays, steps);
      }
    } else if (ref != kHull) {
      meet(tet, ref, by, rays);
    }
  }
  HWY_NOINLINE void meet(Index tet, Ref ref, const Crossing& by, const RayMask& rays) {
    if (!task_.meet(line_, Leaving{tet, kHull, by.ids, kNone, kNone, ref, 0}, rays, rays_))
      return one_by_one(rays);
    unanswered_ = unanswered_ - rays;
  }

  HWY_INLINE void wait(Index tet, Ref previous, const Crossing& by, const RayMask& rays,
                       std::uint32_t steps) {
    Pending& next = queue_.add(tet, previous, by.depths[0] + by.depths[1] + by.depths[2]);
    next.by = by;
    next.steps = steps;
    next.rays = rays;
  }

  /// The rest of the way of a ray that has few beside it: a step of its own costs much less than a visit.
  HWY_NOINLINE void walk_alone(const Pending& in, std::size_t r) {
    Line line = line_;
    task_.line(line, r);
    RayMask ray;
    ray.add(r);
    bool sound = true, met = false;
    const auto on_exit = [&](const Leaving& leaving) -> Continue {
      if (is_tet(leaving.ref)) {
        met = Task::kEndsInTets && task_.ends_in(leaving.ref, r);
        if (!met) return {leaving.ref, leaving.tet};
      } else if (leaving.ref != kHull) {
        sound = met = task_.meet_alone(line, leaving, r);
      }
      return {};
    };
    const Signs signs(line, view_.bounds(), vertices_, {});
    const auto steps = walk<kChecked>(view_, cells_, signs, in.tet, in.previous, in.by.ids, on_exit);
    if (!steps || !sound) return one_by_one(ray);
    lone_steps_ += *steps;
    if (met) unanswered_ = unanswered_ - ray;
  }

  void visit(const Pending& in) {
    // More visits than rays: tetrahedra are smaller than what lies between the rays.
    if (visits_ > task_.size() && in.rays.fewer_than(kFewRays))
      return in.rays.for_each([&](std::size_t r) { walk_alone(in, r); });
    ++visits_;
    const Index tet = in.tet;
    // No ray has come this far in a valid file, but the path may be one of several rays' parts.
    if (in.steps >= view_.tet_count()) return one_by_one(in.rays);
    if constexpr (kChecked) {
      if (tet >= view_.tet_count()) return one_by_one(in.rays);
    }
    const Index i3 = cells_.vertex_xor(tet) ^ in.by.ids[0] ^ in.by.ids[1] ^ in.by.ids[2];
    if constexpr (kChecked) {
      if (i3 >= vertices_.size()) return one_by_one(in.rays);
    }
    const Vec3d p3 = relative(i3);
    const Moments m = moments(in.by, p3);
    std::array<RayMask, 3> exits = {RayMask(RayMask::Uninitialised()), RayMask(RayMask::Uninitialised()),
                                    RayMask(RayMask::Uninitialised())};
    for (std::size_t g = 0; g < kGroups; ++g) {
      const GroupBits rays(in.rays.group[g]);
      if ((in.rays.groups >> g & 1u) == 0) {
        for (RayMask& exit : exits) rays.store(exit.group[g]);  // none
        continue;
      }
      const auto left = part<3>(m, 0, in.by.ids, i3, g, in.rays, rays.blocks());
      store((rays & left[0] & left[2]) | ((rays - left[0]) - left[1]), g, exits[0]);
      store((rays & left[0]) - left[2], g, exits[1]);
      store((rays - left[0]) & left[1], g, exits[2]);
    }
    std::size_t entry_rank = 0;
    if constexpr (Cells::kNeedsEntryRank) entry_rank = rank(i3, in.by.ids[0], in.by.ids[1], in.by.ids[2]);
    std::uint32_t taken = 0;
    for (std::uint32_t k = 0; k < 3; ++k) taken |= static_cast<std::uint32_t>(exits[k].any()) << k;
    for (; taken != 0; taken &= taken - 1) {
      const auto k = static_cast<std::size_t>(std::countr_zero(taken));
      Crossing by = in.by;
      const std::size_t exit_rank = rank(by.ids[k], by.ids[(k + 1) % 3], by.ids[(k + 2) % 3], i3);
      set_corner(by, k, i3, p3);
      leave(tet, cells_.next(tet, in.previous, entry_rank, exit_rank), by, exits[k], in.steps + 1);
    }
  }

  /// As many rays walk alone faster than together, once that the tile has turned out to share little.
  static constexpr int kFewRays = 6;

  const FileView& view_;
  const Cells& cells_;
  const Location& from_;
  std::span<const Vec3f> vertices_;
  Line line_;
  Task& task_;
  Queue& queue_;
  double scale_ = 1;
  RayMask unanswered_;
  TileRays rays_;
  std::uint64_t visits_ = 0;      ///< each for all rays that were in it
  std::uint64_t lone_steps_ = 0;  ///< of rays that went alone
};

}  // namespace HWY_NAMESPACE
}  // namespace tetfmt::detail
HWY_AFTER_NAMESPACE();

#endif
