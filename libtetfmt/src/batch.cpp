// SPDX-License-Identifier: MIT
#include "tetfmt/batch.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <vector>

#include "batch.hpp"
#include "batch_lanes.hpp"
#include "follow.hpp"

namespace tetfmt {
namespace detail {
namespace {

const FileView& file_of(const FileView& view) {
  return view;
}
const FileView& file_of(const TrustedView& view) {
  return view.view();
}

/// Copied at once; a Hit made where it is needed is put together piece by piece.
const Hit kMiss;

/// The end of a ray at a constrained face.
enum class AtFace { hit, miss, through };

template <class View>
class RayBatch {
 public:
  RayBatch(const View& view, std::span<const Location> places, std::span<const BatchRay> rays)
      : view_(view), file_(file_of(view)), places_(places), rays_(rays) {}
  std::size_t size() const { return rays_.size(); }
  const Location* from(std::size_t i) const {
    return rays_[i].from < places_.size() ? &places_[rays_[i].from] : nullptr;
  }
  /// Without the lift of its origin.
  Line flat_line(std::size_t i, const Location& from) const {
    return {{from.position, {}}, to_vec3d(rays_[i].direction), {}, false};
  }
  Line line(std::size_t i) const { return line_from(file_, *from(i), rays_[i].direction); }
  Index target(std::size_t) const { return kNone; }
  bool ordinary(std::size_t i) const {
    const Interval& interval = rays_[i].interval;
    return interval.t_max >= std::max(interval.t_min, 0.0) && interval.t_min < Interval{}.t_max;
  }
  void describe(std::size_t i, Starts& starts, std::size_t n) const {
    const BatchRay& ray = rays_[i];
    const auto& position = places_[ray.from].position;
    for (std::size_t axis = 0; axis < 3; ++axis)
      starts.position[axis][n] = static_cast<float>(position[axis]);
    starts.direction[0][n] = ray.direction.x;
    starts.direction[1][n] = ray.direction.y;
    starts.direction[2][n] = ray.direction.z;
    starts.t_max[n] = static_cast<float>(ray.interval.t_max);
  }
  AtFace at_face(std::size_t i, const Leaving& leaving) const {
    const auto& [t_min, t_max] = rays_[i].interval;
    const bool ends = t_max < Interval{}.t_max;
    if (!(t_min > 0) && !ends) return AtFace::hit;
    const auto corner = [&](std::size_t k) {
      return Corner{file_.vertices()[leaving.ids[k]], leaving.ids[k]};
    };
    const Line exact = line(i);
    if (t_min > 0 && !behind(corner(0), corner(1), corner(2), exact, t_min)) return AtFace::through;
    return ends && behind(corner(0), corner(1), corner(2), exact, t_max) ? AtFace::miss : AtFace::hit;
  }

 protected:
  const View& view_;
  const FileView& file_;
  std::span<const Location> places_;
  std::span<const BatchRay> rays_;
};

template <class View>
class FirstHits : public RayBatch<View> {
 public:
  FirstHits(const View& view, std::span<const Location> places, std::span<const BatchRay> rays,
            std::span<Hit> hits)
      : RayBatch<View>(view, places, rays), hits_(hits) {}
  void corrupt(std::size_t i) const {
    hits_[i] = kMiss;
    hits_[i].outcome = Outcome::corrupt;
  }
  void miss(std::size_t i) const { hits_[i] = kMiss; }
  void hit(std::size_t i, const Leaving& leaving) const {
    Hit& hit = hits_[i];
    hit = kMiss;
    describe_hit(this->file_, this->flat_line(i, *this->from(i)), leaving, hit);
    const Interval& interval = this->rays_[i].interval;
    if (hit.outcome == Outcome::hit) hit.t = std::clamp(hit.t, std::max(interval.t_min, 0.0), interval.t_max);
  }
  void alone(std::size_t i) const {
    hits_[i] = first_hit(this->view_, *this->from(i), this->rays_[i].direction, this->rays_[i].interval);
    hits_[i].steps = 0;
  }

 private:
  std::span<Hit> hits_;
};

template <class View>
class Occlusions : public RayBatch<View> {
 public:
  Occlusions(const View& view, std::span<const Location> places, std::span<const BatchRay> rays,
             std::span<Outcome> outcomes)
      : RayBatch<View>(view, places, rays), outcomes_(outcomes) {}
  void corrupt(std::size_t i) const { outcomes_[i] = Outcome::corrupt; }
  void miss(std::size_t i) const { outcomes_[i] = Outcome::miss; }
  void hit(std::size_t i, const Leaving&) const { outcomes_[i] = Outcome::hit; }
  void alone(std::size_t i) const {
    outcomes_[i] = occlusion(this->view_, *this->from(i), this->rays_[i].direction, this->rays_[i].interval);
  }

 private:
  std::span<Outcome> outcomes_;
};

template <class View>
class Segments {
 public:
  Segments(const View& view, std::span<const Location> places, std::span<const BatchSegment> segments,
           std::span<Outcome> outcomes)
      : view_(view), file_(file_of(view)), places_(places), segments_(segments), outcomes_(outcomes) {}
  std::size_t size() const { return segments_.size(); }
  const Location* from(std::size_t i) const {
    return segments_[i].from < places_.size() && segments_[i].to < places_.size()
               ? &places_[segments_[i].from]
               : nullptr;
  }
  Line flat_line(std::size_t i, const Location& from) const {
    const Location& to = places_[segments_[i].to];
    return {{from.position, {}}, minus(to.position, from.position), {to.position, {}}, true};
  }
  Line line(std::size_t i) const {
    const Location& from = places_[segments_[i].from];
    Line line = flat_line(i, from);
    line.origin.lift = lift_of(file_, from);
    line.toward.lift = lift_of(file_, places_[segments_[i].to]);
    return line;
  }
  Index target(std::size_t i) const {
    const Location& to = places_[segments_[i].to];
    return to.state == Location::State::inside ? to.cell.tet : kNone;
  }
  void describe(std::size_t i, Starts& starts, std::size_t n) const {
    const auto &from = places_[segments_[i].from].position, &to = places_[segments_[i].to].position;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      starts.position[axis][n] = static_cast<float>(from[axis]);
      starts.direction[axis][n] = static_cast<float>(to[axis] - from[axis]);
    }
    starts.t_max[n] = std::numeric_limits<float>::infinity();  // its end is in the target
  }
  bool ordinary(std::size_t i) const {
    using State = Location::State;
    const Location &from = places_[segments_[i].from], &to = places_[segments_[i].to];
    const bool same_tet =
        from.state == State::inside && to.state == State::inside && from.cell.tet == to.cell.tet;
    return (to.state == State::inside || to.state == State::outside) && !same_tet;
  }
  AtFace at_face(std::size_t i, const Leaving& leaving) const {
    const auto corner = [&](std::size_t k) {
      return Corner{file_.vertices()[leaving.ids[k]], leaving.ids[k]};
    };
    const Location& to = places_[segments_[i].to];
    return behind(corner(0), corner(1), corner(2), Place{to.position, lift_of(file_, to)}) ? AtFace::miss
                                                                                           : AtFace::hit;
  }
  void corrupt(std::size_t i) const { outcomes_[i] = Outcome::corrupt; }
  void miss(std::size_t i) const { outcomes_[i] = Outcome::miss; }
  void hit(std::size_t i, const Leaving&) const { outcomes_[i] = Outcome::hit; }
  void alone(std::size_t i) const { outcomes_[i] = occlusion(view_, *from(i), places_[segments_[i].to]); }

 private:
  const View& view_;
  const FileView& file_;
  std::span<const Location> places_;
  std::span<const BatchSegment> segments_;
  std::span<Outcome> outcomes_;
};

/// kOutwardFaces, turned inwards: of cells that are not positive, and of those that are.
constexpr auto kInwardFaces = [] {
  std::array<std::array<std::array<std::uint8_t, 3>, 4>, 2> faces = {kOutwardFaces, kOutwardFaces};
  for (auto& face : faces[1]) std::swap(face[1], face[2]);
  return faces;
}();

/// Lanes::shuffle for each of Walks::axes.
constexpr auto kShuffles = [] {
  std::array<std::array<std::uint8_t, 16>, 6> shuffles{};
  for (std::size_t axes = 0; axes < 6; ++axes) {
    const std::size_t k = axes % 3;
    std::size_t i = (k + 1) % 3, j = (k + 2) % 3;
    if (axes >= 3) std::swap(i, j);
    for (std::size_t byte = 0; byte < 4; ++byte) {
      shuffles[axes][4 + byte] = static_cast<std::uint8_t>(4 * (i + 1) + byte);
      shuffles[axes][8 + byte] = static_cast<std::uint8_t>(4 * (j + 1) + byte);
      shuffles[axes][12 + byte] = static_cast<std::uint8_t>(4 * (k + 1) + byte);
    }
  }
  return shuffles;
}();

/// Keeps the lanes full until all rays are answered.
template <class Cells, class Asked>
class Run final : Lines {
 public:
  Run(const FileView& view, const Cells& cells, const BatchTarget& target, const Asked& asked)
      : view_(view), cells_(cells), target_(target), asked_(asked) {}

  void all() {
    for (std::size_t lane = 0; lane < kLanes; ++lane) refill(lane);
    while (lanes_.walking != 0) {
      const Waiting waiting = target_.advance(view_, *this, lanes_);
      for (LaneMask rest = waiting.ended; rest != 0; rest &= rest - 1)
        refill(static_cast<std::size_t>(std::countr_zero(rest)));
      for (LaneMask rest = waiting.arrived; rest != 0; rest &= rest - 1)
        arrive(static_cast<std::size_t>(std::countr_zero(rest)));
      for (LaneMask rest = waiting.corrupt; rest != 0; rest &= rest - 1)
        give_up(static_cast<std::size_t>(std::countr_zero(rest)));
      if (++rounds_ % kRoundsBetweenLooks == 0) end_circles();
    }
  }

 private:
  Line line(std::uint32_t ray) const override { return asked_.line(ray); }

  void give_up(std::size_t lane) {
    asked_.alone(lanes_.ray[lane]);
    refill(lane);
  }

  /// Walks that take suspiciously long are left to the walk of one ray, which counts its steps.
  void end_circles() {
    for (LaneMask rest = lanes_.walking; rest != 0; rest &= rest - 1) {
      const auto lane = static_cast<std::size_t>(std::countr_zero(rest));
      if (rounds_ - since_[lane] <= view_.tet_count()) continue;
      lanes_.walking &= ~(LaneMask{1} << lane);
      give_up(lane);
    }
  }

  void arrive(std::size_t lane) {
    const std::uint32_t ray = lanes_.ray[lane];
    const Ref ref = lanes_.ref[lane];
    const std::array<Index, 3> ids = {lanes_.ids[0][lane], lanes_.ids[1][lane], lanes_.ids[2][lane]};
    if (ends_at(ray, lanes_.tet[lane], ids, ref)) return refill(lane);
    const Index beyond = twin(side_index(ref));
    const auto sides = view_.sides();
    if (beyond >= sides.size() || sides[beyond].tet >= view_.tet_count()) return give_up(lane);
    if (!enter(lane, {side_ref(beyond), ids, sides[beyond].tet, 0})) return give_up(lane);
    lanes_.walking |= LaneMask{1} << lane;
  }

  /// Answers a ray that leaves `tet` through the face `ids` to something else than a tetrahedron it goes on
  /// in; false if it passes through.
  bool ends_at(std::uint32_t ray, Index tet, const std::array<Index, 3>& ids, Ref ref) {
    if (!is_side(ref)) return true;
    const Leaving leaving{tet, kHull, ids, kNone, kNone, ref, 0};
    const AtFace what = asked_.at_face(ray, leaving);
    if (what == AtFace::hit) asked_.hit(ray, leaving);
    return what != AtFace::through;
  }

  /// Gives the lane the next walk, if there is one.
  void refill(std::size_t lane) {
    if (begun_ == starts_ready_ && !prepare_more()) return;
    const std::size_t n = order_[begun_++];
    move_walk(starts_, n, lane);
    lanes_.shuffle[shuffle_slot(lane, target_.width)] = kShuffles[starts_.axes[n]];
    lanes_.walking |= LaneMask{1} << lane;
    since_[lane] = rounds_;
  }
  void move_walk(const Walks& from, std::size_t n, std::size_t lane) {
    const auto* source = reinterpret_cast<const std::byte*>(&from) + 4 * n;
    auto* target = reinterpret_cast<std::byte*>(static_cast<Walks*>(&lanes_)) + 4 * lane;
    [&]<std::size_t... kField>(std::index_sequence<kField...>) {
      (std::memcpy(target + kField * sizeof(PerLane<Index>), source + kField * sizeof(PerLane<Index>), 4),
       ...);
    }
    (std::make_index_sequence<sizeof(Walks) / sizeof(PerLane<Index>)>());
  }

  /// Until there are walks to begin; false if there are no more rays.
  bool prepare_more() {
    do {
      std::size_t count = 0;
      for (const auto& [ray, passage] : known_) {
        starts_.kind[count] = Starts::known;
        count += stage(count, ray, passage);
      }
      known_.clear();
      while (count + known_.size() < kLanes && next_ < asked_.size()) count += begin(count, next_++);
      begun_ = starts_ready_ = 0;
      if (count == 0 && known_.empty()) return false;
      if (count == 0) continue;
      target_.prepare(view_, starts_);
      for (std::size_t n = 0; n < count; ++n) {
        if (starts_.status[n] == Starts::ready)
          order_[starts_ready_++] = static_cast<std::uint8_t>(n);
        else
          begin_otherwise(starts_.ray[n], starts_.status[n]);
      }
    } while (starts_ready_ == 0);
    return true;
  }

  /// Stages a ray, or answers it, or notes that it needs a closer look.
  bool begin(std::size_t n, std::size_t ray) {
    const Location* from = asked_.from(ray);
    if (!from) {
      asked_.corrupt(ray);
      return false;
    }
    asked_.miss(ray);  // until it meets something
    using State = Location::State;
    const bool inside = from->state == State::inside;
    if (!asked_.ordinary(ray) || !(inside || from->state == State::outside) ||
        (inside && !in_range(view_, from->cell))) {
      asked_.alone(ray);
      return false;
    }
    const auto number = static_cast<std::uint32_t>(ray);
    if (!inside) {
      begin_otherwise(number, Starts::unsure);
      return false;
    }
    const auto& [tet, v, neighbors] = from->cell;
    starts_.positive[n] = from->positive ? ~std::uint32_t{0} : 0;
    if (from->face >= kOutwardFaces.size()) {
      starts_.kind[n] = Starts::within;
      return stage(n, number, {kHull, {v[0], v[1], v[2]}, tet, 0}, v[3]);
    }
    starts_.kind[n] = Starts::on_face;
    const auto& f = kInwardFaces[from->positive][from->face];
    return stage(n, number, {neighbors[from->face], {v[f[0]], v[f[1]], v[f[2]]}, tet, 0});
  }

  /// A ray that is not ready to go by its first tetrahedron.
  void begin_otherwise(std::uint32_t ray, std::uint32_t status) {
    const Location& from = *asked_.from(ray);
    std::optional<Passage> passage;
    if (status <= Starts::exit3) {
      const auto& v = from.cell.vertices;
      const auto& f = kInwardFaces[!from.positive][status];  // outwards, that is
      passage = Passage{from.cell.tet, {v[f[0]], v[f[1]], v[f[2]]}, from.cell.neighbors[status], 1};
    } else if (status == Starts::unsure) {
      const Line line = asked_.line(ray);
      if (!can_be_followed(line)) return asked_.alone(ray);
      passage = first_passage(view_, cells_, Signs(line, view_.bounds(), view_.vertices(), {}), line, from);
      if (!passage && from.state == Location::State::outside) return;  // a miss
    }
    if (!passage) return asked_.alone(ray);
    const Ref ref = passage->ref;
    if (ref < view_.tet_count() && ref != asked_.target(ray))
      known_.push_back({ray, *passage});
    else if (passage->steps == 0 || ref < kSideBit || !ends_at(ray, from.cell.tet, passage->ids, ref))
      asked_.alone(ray);
  }

  /// `apex` is computed unless it is known.
  bool stage(std::size_t n, std::uint32_t ray, const Passage& passage, std::optional<Index> known_apex = {}) {
    const auto& [i0, i1, i2] = passage.ids;
    const Index apex = known_apex ? *known_apex : cells_.vertex_xor(passage.ref) ^ i0 ^ i1 ^ i2;
    if (apex >= view_.vertices().size()) {
      asked_.alone(ray);
      return false;
    }
    asked_.describe(ray, starts_, n);
    starts_.ids[0][n] = i0;
    starts_.ids[1][n] = i1;
    starts_.ids[2][n] = i2;
    starts_.ref[n] = passage.ref;
    starts_.tet[n] = passage.previous;
    starts_.apex[n] = apex;
    starts_.target[n] = asked_.target(ray);
    starts_.ray[n] = ray;
    return true;
  }

  /// Puts the lane before the passage's tetrahedron, which exists.
  bool enter(std::size_t lane, const Passage& passage) {
    const auto& [i0, i1, i2] = passage.ids;
    const Index apex = cells_.vertex_xor(passage.ref) ^ i0 ^ i1 ^ i2;
    if (apex >= view_.vertices().size()) return false;
    lanes_.ref[lane] = passage.ref;
    lanes_.tet[lane] = passage.previous;
    lanes_.apex[lane] = apex;
    return true;
  }

  static constexpr std::uint64_t kRoundsBetweenLooks = 256;

  const FileView& view_;
  const Cells& cells_;
  const BatchTarget& target_;
  const Asked& asked_;
  std::size_t next_ = 0;
  std::uint64_t rounds_ = 0;
  PerLane<std::uint64_t> since_{};
  struct Begun {
    std::uint32_t ray;
    Passage passage;
  };
  std::vector<Begun> known_;  ///< rays whose first passage is known, not yet staged
  std::size_t begun_ = 0, starts_ready_ = 0;
  std::array<std::uint8_t, kLanes> order_{};  ///< of the starts that are ready
  Starts starts_{};
  Lanes lanes_{};
};

template <class View, class Asked>
void answer(const View& view, const BatchTarget& target, const Asked& asked) {
  const FileView& file = file_of(view);
  if (!target.advance || file.tet_count() >= kMaxBatchTets || asked.size() > kNone) {
    for (std::size_t i = 0; i < asked.size(); ++i) asked.from(i) ? asked.alone(i) : asked.corrupt(i);
    return;
  }
  with_cells(file, [&](const auto& cells) {
    using Cells = std::remove_cvref_t<decltype(cells)>;
    Run<Cells, Asked>(file, cells, target, asked).all();
  });
}

}  // namespace

void trace_batch(const BatchTarget& target, const FileView& view, std::span<const Location> places,
                 std::span<const BatchRay> rays, std::span<Hit> hits) {
  answer(view, target, FirstHits(view, places, rays, hits));
}
void trace_batch(const BatchTarget& target, const TrustedView& view, std::span<const Location> places,
                 std::span<const BatchRay> rays, std::span<Hit> hits) {
  answer(view, target, FirstHits(view, places, rays, hits));
}
void occlude_batch(const BatchTarget& target, const FileView& view, std::span<const Location> places,
                   std::span<const BatchRay> rays, std::span<Outcome> outcomes) {
  answer(view, target, Occlusions(view, places, rays, outcomes));
}
void occlude_batch(const BatchTarget& target, const TrustedView& view, std::span<const Location> places,
                   std::span<const BatchRay> rays, std::span<Outcome> outcomes) {
  answer(view, target, Occlusions(view, places, rays, outcomes));
}
void occlude_batch(const BatchTarget& target, const FileView& view, std::span<const Location> places,
                   std::span<const BatchSegment> segments, std::span<Outcome> outcomes) {
  answer(view, target, Segments(view, places, segments, outcomes));
}
void occlude_batch(const BatchTarget& target, const TrustedView& view, std::span<const Location> places,
                   std::span<const BatchSegment> segments, std::span<Outcome> outcomes) {
  answer(view, target, Segments(view, places, segments, outcomes));
}

}  // namespace detail

void trace_batch(const FileView& view, std::span<const Location> places, std::span<const BatchRay> rays,
                 std::span<Hit> hits) {
  detail::trace_batch(detail::batch_targets().front(), view, places, rays, hits);
}
void trace_batch(const TrustedView& view, std::span<const Location> places, std::span<const BatchRay> rays,
                 std::span<Hit> hits) {
  detail::trace_batch(detail::batch_targets().front(), view, places, rays, hits);
}
void occlude_batch(const FileView& view, std::span<const Location> places, std::span<const BatchRay> rays,
                   std::span<Outcome> outcomes) {
  detail::occlude_batch(detail::batch_targets().front(), view, places, rays, outcomes);
}
void occlude_batch(const TrustedView& view, std::span<const Location> places, std::span<const BatchRay> rays,
                   std::span<Outcome> outcomes) {
  detail::occlude_batch(detail::batch_targets().front(), view, places, rays, outcomes);
}
void occlude_batch(const FileView& view, std::span<const Location> places,
                   std::span<const BatchSegment> segments, std::span<Outcome> outcomes) {
  detail::occlude_batch(detail::batch_targets().front(), view, places, segments, outcomes);
}
void occlude_batch(const TrustedView& view, std::span<const Location> places,
                   std::span<const BatchSegment> segments, std::span<Outcome> outcomes) {
  detail::occlude_batch(detail::batch_targets().front(), view, places, segments, outcomes);
}

}  // namespace tetfmt
