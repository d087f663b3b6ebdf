// SPDX-License-Identifier: MIT
#include "tetfmt/batch.hpp"

#include <algorithm>
#include <bit>
#include <cmath>

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
  double t_max(std::size_t i) const { return rays_[i].interval.t_max; }
  Index target(std::size_t) const { return kNone; }
  bool ordinary(std::size_t i, const Line& line) const {
    const Interval& interval = rays_[i].interval;
    return interval.t_max >= std::max(interval.t_min, 0.0) && interval.t_min < Interval{}.t_max &&
           can_be_followed(line);
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
    hits_[i] = {};
    hits_[i].outcome = Outcome::corrupt;
  }
  void miss(std::size_t i) const { hits_[i] = {}; }
  void hit(std::size_t i, const Leaving& leaving) const {
    Hit& hit = hits_[i];
    hit = {};
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
  double t_max(std::size_t) const { return Interval{}.t_max; }  // its end is in the target
  Index target(std::size_t i) const {
    const Location& to = places_[segments_[i].to];
    return to.state == Location::State::inside ? to.cell.tet : kNone;
  }
  bool ordinary(std::size_t i, const Line& line) const {
    using State = Location::State;
    const Location &from = places_[segments_[i].from], &to = places_[segments_[i].to];
    const bool same_tet =
        from.state == State::inside && to.state == State::inside && from.cell.tet == to.cell.tet;
    return (to.state == State::inside || to.state == State::outside) && !same_tet && can_be_followed(line);
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

/// Keeps the lanes full until all rays are answered.
template <class Cells, class Asked>
class Run final : Lines {
 public:
  Run(const FileView& view, const Cells& cells, const BatchTarget& target, const Asked& asked)
      : view_(view), cells_(cells), advance_(target.advance), width_(target.width), asked_(asked) {}

  void all() {
    for (std::size_t lane = 0; lane < kLanes; ++lane) refill(lane);
    while (lanes_.walking != 0) {
      const Waiting waiting = advance_(view_, *this, lanes_);
      for (LaneMask rest = waiting.ended; rest != 0; rest &= rest - 1) {
        const auto lane = static_cast<std::size_t>(std::countr_zero(rest));
        asked_.miss(lanes_.ray[lane]);
        refill(lane);
      }
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
    const std::size_t ray = lanes_.ray[lane];
    const Ref ref = lanes_.ref[lane];
    if (!is_side(ref)) {
      asked_.miss(ray);
      return refill(lane);
    }
    const Leaving leaving{lanes_.tet[lane],
                          lanes_.previous[lane],
                          {lanes_.ids[0][lane], lanes_.ids[1][lane], lanes_.ids[2][lane]},
                          kNone,
                          kNone,
                          ref,
                          0};
    switch (asked_.at_face(ray, leaving)) {
      case AtFace::hit:
        asked_.hit(ray, leaving);
        return refill(lane);
      case AtFace::miss:
        asked_.miss(ray);
        return refill(lane);
      case AtFace::through:
        break;
    }
    const Index beyond = twin(side_index(ref));
    const auto sides = view_.sides();
    if (beyond >= sides.size() || sides[beyond].tet >= view_.tet_count()) return give_up(lane);
    const std::array<Index, 3> ids = leaving.ids;
    if (!enter(lane, {side_ref(beyond), ids, sides[beyond].tet, 0})) return give_up(lane);
    lanes_.walking |= LaneMask{1} << lane;
  }

  /// Gives the lane the next ray that needs it.
  void refill(std::size_t lane) {
    while (next_ < asked_.size()) {
      const std::size_t ray = next_++;
      if (begin(lane, ray)) {
        lanes_.ray[lane] = static_cast<std::uint32_t>(ray);
        lanes_.walking |= LaneMask{1} << lane;
        since_[lane] = rounds_;
        return;
      }
    }
  }

  bool begin(std::size_t lane, std::size_t ray) {
    const Location* from = asked_.from(ray);
    if (!from) {
      asked_.corrupt(ray);
      return false;
    }
    if (start(lane, ray, *from)) return true;
    asked_.alone(ray);
    return false;
  }

  bool start(std::size_t lane, std::size_t ray, const Location& from) {
    using State = Location::State;
    if (from.state != State::inside && from.state != State::outside) return false;
    if (from.state == State::inside && !in_range(view_, from.cell)) return false;
    const Line line = asked_.flat_line(ray, from);
    if (!asked_.ordinary(ray, line)) return false;
    const double most = reach(line, view_.bounds());
    if (!(most >= 0x1p-50 && most <= 0x1p50)) return false;
    std::optional<Passage> passage;
    if (from.state == State::inside && from.face < kOutwardFaces.size())
      passage = leave_face(view_, line, from);
    if (!passage) passage = first_passage_exactly(ray, from);
    if (!passage || passage->ref >= view_.tet_count()) return false;
    const Index target = asked_.target(ray);
    if (passage->steps == 1 && passage->ref == target) return false;

    if (!enter(lane, *passage)) return false;

    const Vec3d &d = line.direction, &o = line.origin.point;
    const std::size_t k = Axes(d).largest;
    std::size_t i = (k + 1) % 3, j = (k + 2) % 3;
    if (d[k] < 0) std::swap(i, j);
    const std::array<std::size_t, 3> axes = {i, j, k};
    const auto slope_i = static_cast<float>(d[i] / d[k]), slope_j = static_cast<float>(d[j] / d[k]);
    const float sign = d[k] < 0 ? -1 : 1;
    std::array<float, 3> origin;
    double off = 0;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      origin[axis] = static_cast<float>(o[axes[axis]]);
      off = std::max(off, std::abs(o[axes[axis]] - double{origin[axis]}));
    }
    for (std::size_t c = 0; c < 3; ++c) {
      const Vec3f& p = view_.vertices()[passage->ids[c]];
      const float depth = coordinate(p, k) - origin[2];
      lanes_.x[c][lane] = (coordinate(p, i) - origin[0]) - depth * slope_i;
      lanes_.y[c][lane] = (coordinate(p, j) - origin[1]) - depth * slope_j;
      lanes_.z[c][lane] = depth * sign;
      lanes_.ids[c][lane] = passage->ids[c];
      lanes_.origin[c][lane] = origin[c];
    }
    lanes_.slope_i[lane] = slope_i;
    lanes_.slope_j[lane] = slope_j;
    lanes_.sign_k[lane] = sign;
    const double error = 9 * 0x1p-24 * most + 3 * off;
    lanes_.error[lane] = static_cast<float>(error);
    lanes_.square[lane] = static_cast<float>(4 * error * error) + std::numeric_limits<float>::min();
    const double length = asked_.t_max(ray) * std::abs(d[k]);
    lanes_.limit[lane] = length < 4 * most
                             ? static_cast<float>(length * (1 + 0x1p-20) + 4 * 0x1p-24 * most + 4 * off)
                             : std::numeric_limits<float>::infinity();
    lanes_.target[lane] = target;
    auto& shuffle = lanes_.shuffle[shuffle_slot(lane, width_)];
    for (std::size_t axis = 0; axis < 3; ++axis)
      for (std::size_t byte = 0; byte < 4; ++byte)
        shuffle[4 * (axis + 1) + byte] = static_cast<std::uint8_t>(4 * (axes[axis] + 1) + byte);
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

  std::optional<Passage> first_passage_exactly(std::size_t ray, const Location& from) const {
    const Line line = asked_.line(ray);
    return first_passage(view_, cells_, Signs(line, view_.bounds(), view_.vertices(), {}), line, from);
  }

  static constexpr std::uint64_t kRoundsBetweenLooks = 256;

  const FileView& view_;
  const Cells& cells_;
  Advance advance_;
  std::size_t width_;
  const Asked& asked_;
  std::size_t next_ = 0;
  std::uint64_t rounds_ = 0;
  PerLane<std::uint64_t> since_{};
  Lanes lanes_{};
};

template <class View, class Asked>
void answer(const View& view, const BatchTarget& target, const Asked& asked) {
  const FileView& file = file_of(view);
  if (file.tet_count() >= kMaxBatchTets) {
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
