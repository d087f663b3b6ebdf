// SPDX-License-Identifier: AGPL-3.0-or-later
#include "trace/rays.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>

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
  visits += other.visits;
  lost += other.lost;
  most_steps = std::max(most_steps, other.most_steps);
}

bool Rays::is_hit(Outcome outcome, const Part& part) {
  if (outcome == Outcome::corrupt) {
    if (walks_ != Walks::float_signs) fail_corrupt(part);
    ++counts_.lost;
  }
  return outcome == Outcome::hit;
}

void Rays::first_hits(std::span<const tetfmt::Location> eye, std::span<const tetfmt::Vec3f> directions,
                      std::span<SceneHit> hits) {
  batch_.hits.resize(directions.size());
  std::fill(hits.begin(), hits.end(), SceneHit{});
  for (std::size_t i = 0; i < scene_.parts.size(); ++i) {
    const Part& part = *scene_.parts[i];
    counts_.visits += tetprep::first_hits(walks_, part.view(), eye[i], directions, batch_.hits);
    for (std::size_t k = 0; k < hits.size(); ++k) {
      const tetfmt::Hit& found = batch_.hits[k];
      const std::uint32_t steps = hits[k].hit.steps + found.steps;
      if (is_hit(found.outcome, part) && (!hits[k] || found.t < hits[k].hit.t)) hits[k] = {found, i};
      hits[k].hit.steps = steps;
    }
  }
  counts_.rays[static_cast<std::size_t>(RayKind::camera)] += hits.size();
  for (const SceneHit& hit : hits) {
    counts_.hits += static_cast<bool>(hit);
    counts_.most_steps = std::max(counts_.most_steps, hit.hit.steps);
  }
}

void Rays::begin(std::span<const SceneRay> rays) {
  reach_.clear();
  for (const SceneRay& ray : rays) {
    ++counts_.rays[static_cast<std::size_t>(ray.kind)];
    reach_.push_back(ray.t_max);
  }
}

void Rays::gather(std::size_t part, std::span<const Place> places, std::span<const SceneRay> rays,
                  bool share) {
  const Part& here = *scene_.parts[part];
  batch_.places.clear(), batch_.rays.clear(), batch_.numbers.clear();
  std::optional<std::uint32_t> last;  // rays of one place follow each other, and share it here as well
  for (std::size_t k = 0; k < rays.size(); ++k) {
    const SceneRay& ray = rays[k];
    const Place& place = places[ray.from];
    const Vec3 local = here.local(place.position);
    const bool meets =
        place.part == part || may_meet(here.view().bounds(), local, vec3(ray.direction), reach_[k]);
    if (reach_[k] < 0 || !meets) continue;
    if (!share || last != ray.from) {
      batch_.places.push_back(place.part == part ? place.location
                                                 : tetfmt::locate(here.view(), rounded(local)));
      if (batch_.places.back().state == tetfmt::Location::State::corrupt) fail_corrupt(here);
      last = ray.from;
    }
    batch_.rays.push_back(
        {static_cast<std::uint32_t>(batch_.places.size() - 1), ray.direction, {0, reach_[k]}});
    batch_.numbers.push_back(k);
  }
}

void Rays::first_hits(std::span<const Place> places, std::span<const SceneRay> rays,
                      std::span<SceneHit> hits) {
  begin(rays);
  std::fill(hits.begin(), hits.end(), SceneHit{});
  for (std::size_t i = 0; i < scene_.parts.size(); ++i) {
    const Part& part = *scene_.parts[i];
    gather(i, places, rays, true);
    batch_.hits.resize(batch_.rays.size());
    tetprep::first_hits(walks_, part.view(), batch_.places, batch_.rays, batch_.hits);
    for (std::size_t k = 0; k < batch_.rays.size(); ++k) {
      const tetfmt::Hit& found = batch_.hits[k];
      SceneHit& nearest = hits[batch_.numbers[k]];
      if (!is_hit(found.outcome, part) || (nearest && found.t >= nearest.hit.t)) continue;
      nearest = {found, i};
      reach_[batch_.numbers[k]] = found.t;
    }
  }
}

template <class Ask>
void Rays::each_part_obstacles(std::span<const Place> places, std::span<const SceneRay> rays,
                               std::span<Outcome> outcomes, bool share, Ask ask) {
  begin(rays);
  std::fill(outcomes.begin(), outcomes.end(), Outcome::miss);
  for (std::size_t i = 0; i < scene_.parts.size(); ++i) {
    gather(i, places, rays, share);
    batch_.outcomes.resize(batch_.rays.size());
    ask(i);
    for (std::size_t k = 0; k < batch_.rays.size(); ++k) {
      if (!is_hit(batch_.outcomes[k], *scene_.parts[i])) continue;
      outcomes[batch_.numbers[k]] = Outcome::hit;
      reach_[batch_.numbers[k]] = -1;
    }
  }
}

void Rays::obstacles(std::span<const Place> places, std::span<const SceneRay> rays,
                     std::span<Outcome> outcomes) {
  each_part_obstacles(places, rays, outcomes, true, [&](std::size_t i) {
    occlusions(walks_, scene_.parts[i]->view(), batch_.places, batch_.rays, batch_.outcomes);
  });
}

void Rays::obstacles(std::span<const Place> places, std::span<const SceneRay> rays, const LocatedLight& light,
                     std::span<Outcome> outcomes) {
  each_part_obstacles(places, rays, outcomes, false, [&](std::size_t i) {
    occlusions(walks_, scene_.parts[i]->view(), batch_.places, light.locations[i], batch_.outcomes);
  });
}

Place Rays::side(const SceneHit& hit, const tetfmt::Location& location) const {
  const Part& part = *scene_.parts[hit.part];
  if (location.state == tetfmt::Location::State::corrupt) fail_corrupt(part);
  if (location.state == tetfmt::Location::State::absent)
    throw Failure(ExitCode::invalid, part.file.path() +
                                         ": a ray goes on into space that the file leaves out (glass needs "
                                         "its inside); convert with --keep all");
  return {vec3(location.position) + part.offset, hit.part, location};
}

Place Rays::near_side(const SceneHit& hit) const {
  return side(hit, tetfmt::near_side(scene_.parts[hit.part]->view(), hit.hit));
}

Place Rays::far_side(const SceneHit& hit) const {
  return side(hit, tetfmt::far_side(scene_.parts[hit.part]->view(), hit.hit));
}

}  // namespace tetprep
