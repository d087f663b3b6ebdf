// SPDX-License-Identifier: AGPL-3.0-or-later
#include "trace/rays.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "common/failure.hpp"

namespace tetprep {
namespace {

using tetfmt::Outcome;

[[noreturn]] void fail_corrupt(const Part& part) {
  throw Failure(ExitCode::invalid,
                part.file.path() + ": a ray ran into bytes that are no mesh; run `tet validate` on the file");
}

/// Whether the ray may meet the box (Kay and Kajiya 1986). Errs on the side of yes: the box is taken a little
/// larger than rounding can move anything.
bool may_meet(const tetfmt::Bounds& box, Vec3 from, Vec3 direction, double t_max) {
  const std::array<double, 3> low{box.lower.x, box.lower.y, box.lower.z},
      high{box.upper.x, box.upper.y, box.upper.z}, o{from.x, from.y, from.z},
      d{direction.x, direction.y, direction.z};
  double first = 0, last = t_max;
  for (std::size_t i = 0; i < 3; ++i) {
    const double slack = 1e-6 * (std::abs(low[i]) + std::abs(high[i]) + std::abs(o[i]));
    const double a = (low[i] - slack - o[i]) / d[i], b = (high[i] + slack - o[i]) / d[i];
    // Where d is 0 these are infinite, or no numbers: comparisons with those change nothing.
    if (std::min(a, b) > first) first = std::min(a, b);
    if (std::max(a, b) < last) last = std::max(a, b);
  }
  return !(first > last);
}

}  // namespace

std::uint64_t RayCounts::total() const {
  return std::accumulate(rays.begin(), rays.end(), std::uint64_t{0});
}

void RayCounts::add(const RayCounts& other) {
  for (std::size_t i = 0; i < rays.size(); ++i) rays[i] += other.rays[i];
  hits += other.hits;
  walks += other.walks;
  steps += other.steps;
  lost += other.lost;
  most_steps = std::max(most_steps, other.most_steps);
}

bool Rays::is_hit(Outcome outcome, const Part& part) {
  if (outcome == Outcome::corrupt) {
    if (kernel_ == tetfmt::Kernel::exact) fail_corrupt(part);
    ++counts_.lost;
  }
  return outcome == Outcome::hit;
}

template <class TMax, class Walk>
void Rays::each_part(const Place& from, Vec3 direction, TMax t_max, Walk walk) const {
  for (std::size_t i = 0; i < scene_.parts.size(); ++i) {
    const Part& part = *scene_.parts[i];
    if (!from.everywhere.empty()) {
      if (!walk(i, from.everywhere[i])) return;
    } else if (i == from.part) {
      if (!walk(i, from.own)) return;
    } else {
      const Vec3 local = part.local(from.position);
      if (!may_meet(part.view().bounds(), local, direction, t_max())) continue;
      const tetfmt::Location location = tetfmt::locate(part.view(), rounded(local));
      if (location.state == tetfmt::Location::State::corrupt) fail_corrupt(part);
      if (!walk(i, location)) return;
    }
  }
}

SceneHit Rays::first_hit(RayKind kind, const Place& from, tetfmt::Vec3f direction, double t_max) {
  ++counts_.rays[static_cast<std::size_t>(kind)];
  SceneHit nearest;
  double limit = t_max;
  std::uint32_t steps = 0;
  each_part(
      from, vec3(direction), [&] { return limit; },
      [&](std::size_t i, const tetfmt::Location& location) {
        const Part& part = *scene_.parts[i];
        const tetfmt::Hit hit = tetfmt::first_hit(part.view(), location, direction, {0, limit}, kernel_);
        steps += hit.steps;
        if (is_hit(hit.outcome, part) && (!nearest || hit.t < nearest.hit.t)) {
          nearest = {hit, i};
          limit = std::min(limit, hit.t);
        }
        return true;
      });
  nearest.hit.steps = steps;
  ++counts_.walks;
  counts_.steps += steps;
  counts_.most_steps = std::max(counts_.most_steps, steps);
  if (kind == RayKind::camera) counts_.hits += static_cast<bool>(nearest);
  return nearest;
}

bool Rays::blocked(RayKind kind, const Place& from, tetfmt::Vec3f direction, double t_max) {
  if (kernel_ != tetfmt::Kernel::exact) return static_cast<bool>(first_hit(kind, from, direction, t_max));
  ++counts_.rays[static_cast<std::size_t>(kind)];
  bool blocked = false;
  each_part(
      from, vec3(direction), [&] { return t_max; },
      [&](std::size_t i, const tetfmt::Location& location) {
        const Part& part = *scene_.parts[i];
        blocked = is_hit(tetfmt::occlusion(part.view(), location, direction, {0, t_max}), part);
        return !blocked;
      });
  return blocked;
}

bool Rays::blocked(const Place& from, const LocatedLight& light) {
  ++counts_.rays[static_cast<std::size_t>(RayKind::shadow)];
  bool blocked = false;
  each_part(
      from, light.position - from.position, [] { return 1.0; },
      [&](std::size_t i, const tetfmt::Location& location) {
        const Part& part = *scene_.parts[i];
        blocked = is_hit(tetfmt::occlusion(part.view(), location, light.locations[i]), part);
        return !blocked;
      });
  return blocked;
}

Place Rays::side(const SceneHit& hit, const tetfmt::Location& location) const {
  const Part& part = *scene_.parts[hit.part];
  if (location.state == tetfmt::Location::State::corrupt) fail_corrupt(part);
  if (location.state == tetfmt::Location::State::absent)
    throw Failure(ExitCode::usage, part.file.path() +
                                       ": a ray goes on into space that the file leaves out (glass needs its "
                                       "inside); convert with --keep all");
  return {vec3(location.position) + part.offset, {}, hit.part, location};
}

Place Rays::near_side(const SceneHit& hit) const {
  return side(hit, tetfmt::near_side(scene_.parts[hit.part]->view(), hit.hit));
}

Place Rays::far_side(const SceneHit& hit) const {
  return side(hit, tetfmt::far_side(scene_.parts[hit.part]->view(), hit.hit));
}

}  // namespace tetprep
