// SPDX-License-Identifier: MIT
#include "tetfmt/traverse.hpp"

#include "follow.hpp"

namespace tetfmt {
namespace {

using namespace detail;

bool never(const Leaving&) {
  return false;
}

/// True as soon as the line is certainly beyond t_max: a point o + t d is t |d_k| away from o along axis k,
/// and the exit face is no nearer than the nearest of its vertices.
class PastEnd {
 public:
  PastEnd(const FileView& view, const Line& line, double t_max) : vertices_(view.vertices()), axis_(0) {
    axis_ = Axes(line.direction).largest;
    sign_ = line.direction[axis_] < 0 ? -1 : 1;
    origin_ = line.origin.point[axis_];
    const double length = t_max * std::abs(line.direction[axis_]);
    depth_ = length + 0x1p-50 * (length + reach(line, view.bounds()));  // two roundings each, and to spare
  }
  bool operator()(const Leaving& leaving) const {
    if (leaving.apex != kNone && !beyond(leaving.apex)) return false;
    return beyond(leaving.ids[0]) && beyond(leaving.ids[1]) && beyond(leaving.ids[2]);
  }

 private:
  bool beyond(Index id) const {
    return sign_ * (double{coordinate(vertices_[id], axis_)} - origin_) > depth_;
  }

  std::span<const Vec3f> vertices_;
  std::size_t axis_;
  double sign_ = 1, origin_ = 0, depth_ = 0;
};

/// Where the face that a walk leaves by lies along its line. Exact.
class Bounded {
 public:
  Bounded(const FileView& view, const Line& line, const Interval& interval)
      : vertices_(view.vertices()), line_(line), interval_(interval) {}
  bool too_early(const Leaving& at) const { return interval_.t_min > 0 && !after(at, interval_.t_min); }
  bool too_late(const Leaving& at) const { return ends() && after(at, interval_.t_max); }
  bool ends() const { return interval_.t_max < std::numeric_limits<double>::infinity(); }

 private:
  bool after(const Leaving& at, double t) const {
    const auto corner = [&](std::size_t k) { return Corner{vertices_[at.ids[k]], at.ids[k]}; };
    return behind(corner(0), corner(1), corner(2), line_, t);
  }
  std::span<const Vec3f> vertices_;
  const Line& line_;
  Interval interval_;
};

/// What there is to say of a ray before any step; nothing if it is to be followed.
std::optional<Outcome> outcome_before(const Location& from, const Line& line, const Interval& interval) {
  if (from.state == Location::State::corrupt) return Outcome::corrupt;
  if (from.state == Location::State::absent) return Outcome::absent;
  const bool empty =
      !(interval.t_max >= std::max(interval.t_min, 0.0)) || !(interval.t_min < Interval{}.t_max);
  if (empty || !can_be_followed(line)) return Outcome::miss;
  return std::nullopt;
}

/// Follows a ray and calls on_hit(leaving) at each constrained face within the interval, which says whether
/// to stop there.
template <bool kChecked, class OnHit>
Followed follow_ray(const FileView& view, const Location& from, const Line& line, const Interval& interval,
                    Kernel kernel, OnHit&& on_hit) {
  const Bounded bounded(view, line, interval);
  return with_cells(view, [&](const auto& cells) {
    const Signs exact(line, view.bounds(), view.vertices(), {});
    const auto go = [&](const auto& signs) {
      bool late = false;
      const auto at_face = [&](const Leaving& leaving) {
        if (bounded.too_early(leaving)) return false;
        late = bounded.too_late(leaving);
        return late || on_hit(leaving);
      };
      Followed followed = bounded.ends()
                              ? follow<kChecked>(view, cells, line, from, exact, signs,
                                                 PastEnd(view, line, interval.t_max), at_face)
                              : follow<kChecked>(view, cells, line, from, exact, signs, never, at_face);
      if (late) followed.outcome = Outcome::miss;
      return followed;
    };
    if (kernel == Kernel::exact) return go(exact);
    return go(FloatSigns<ShearProjection, NoCounts>(exact, view.bounds()));
  });
}

template <bool kChecked>
Hit first_hit_in(const FileView& view, const Location& from, const Vec3f& direction, const Interval& interval,
                 Kernel kernel) {
  Hit hit;  // written in place all the way: copies of it cost as much as some steps
  const Line line = line_from(view, from, direction);
  if (const auto outcome = outcome_before(from, line, interval)) {
    hit.outcome = *outcome;
    return hit;
  }
  const Followed followed =
      follow_ray<kChecked>(view, from, line, interval, kernel, [&](const Leaving& leaving) {
        describe_hit(view, line, leaving, hit);
        return true;
      });
  if (followed.outcome != Outcome::hit) hit.outcome = followed.outcome;
  if (hit.outcome == Outcome::hit) hit.t = std::clamp(hit.t, std::max(interval.t_min, 0.0), interval.t_max);
  hit.steps = followed.steps;
  return hit;
}

template <bool kChecked>
Outcome occlusion_in(const FileView& view, const Location& from, const Vec3f& direction,
                     const Interval& interval) {
  const Line line = line_from(view, from, direction);
  if (const auto outcome = outcome_before(from, line, interval)) return *outcome;
  return follow_ray<kChecked>(view, from, line, interval, Kernel::exact, [](const Leaving&) { return true; })
      .outcome;
}

template <bool kChecked>
Outcome occlusion_in(const FileView& view, const Location& from, const Location& to) {
  for (const Location* place : {&from, &to})
    if (place->state == Location::State::corrupt) return Outcome::corrupt;
  if (from.state == Location::State::absent) return Outcome::absent;
  if (to.state == Location::State::absent) return Outcome::hit;  // behind the faces that close it off
  Line line = line_from(view, from, {});
  line.toward = {to.position, lift_of(view, to)};
  line.through_point = true;
  for (std::size_t i = 0; i < 3; ++i) line.direction[i] = to.position[i] - from.position[i];
  if (!is_finite(line.direction)) return Outcome::miss;
  const bool same_tet =
      from.state == to.state && from.state == Location::State::inside && from.cell.tet == to.cell.tet;
  if (same_tet) return Outcome::miss;  // which is convex
  if (line.direction == Vec3d{}) {
    const bool two_sides = from.face != Location::kNoFace && to.face != Location::kNoFace;
    return two_sides ? Outcome::hit : Outcome::miss;
  }

  const Index target = to.state == Location::State::inside ? to.cell.tet : kNone;
  const auto vertices = view.vertices();
  bool late = false;
  const auto reached = [&](const Leaving& leaving) { return leaving.ref == target; };
  const auto at_face = [&](const Leaving& at) {
    const auto corner = [&](std::size_t k) { return Corner{vertices[at.ids[k]], at.ids[k]}; };
    late = behind(corner(0), corner(1), corner(2), line.toward);
    return true;
  };
  return with_cells(view, [&](const auto& cells) {
    const Signs signs(line, view.bounds(), vertices, {});
    const Outcome outcome = follow<kChecked>(view, cells, line, from, signs, signs, reached, at_face).outcome;
    return late ? Outcome::miss : outcome;
  });
}

template <bool kChecked>
Outcome all_hits_in(const FileView& view, const Location& from, const Vec3f& direction,
                    std::vector<Hit>& hits, const Interval& interval) {
  const Line line = line_from(view, from, direction);
  if (const auto outcome = outcome_before(from, line, interval)) return *outcome;
  double least = std::max(interval.t_min, 0.0);
  bool sound = true;
  const Followed followed =
      follow_ray<kChecked>(view, from, line, interval, Kernel::exact, [&](const Leaving& leaving) {
        Hit hit;
        describe_hit(view, line, leaving, hit);
        sound = hit.outcome == Outcome::hit;
        if (!sound) return true;
        hit.t = least = std::clamp(hit.t, least, interval.t_max);  // in order, whatever the roundings
        hit.steps = leaving.steps;
        hits.push_back(hit);
        return false;
      });
  return sound ? followed.outcome : Outcome::corrupt;
}

}  // namespace

Hit first_hit(const FileView& view, const Location& from, Vec3f direction, const Interval& interval,
              Kernel kernel) {
  return first_hit_in<true>(view, from, direction, interval, kernel);
}
Hit first_hit(const TrustedView& view, const Location& from, Vec3f direction, const Interval& interval,
              Kernel kernel) {
  return first_hit_in<false>(view.view(), from, direction, interval, kernel);
}

Outcome occlusion(const FileView& view, const Location& from, Vec3f direction, const Interval& interval) {
  return occlusion_in<true>(view, from, direction, interval);
}
Outcome occlusion(const TrustedView& view, const Location& from, Vec3f direction, const Interval& interval) {
  return occlusion_in<false>(view.view(), from, direction, interval);
}

Outcome occlusion(const FileView& view, const Location& from, const Location& to) {
  return occlusion_in<true>(view, from, to);
}
Outcome occlusion(const TrustedView& view, const Location& from, const Location& to) {
  return occlusion_in<false>(view.view(), from, to);
}

Outcome all_hits(const FileView& view, const Location& from, Vec3f direction, std::vector<Hit>& hits,
                 const Interval& interval) {
  return all_hits_in<true>(view, from, direction, hits, interval);
}
Outcome all_hits(const TrustedView& view, const Location& from, Vec3f direction, std::vector<Hit>& hits,
                 const Interval& interval) {
  return all_hits_in<false>(view.view(), from, direction, hits, interval);
}

}  // namespace tetfmt
