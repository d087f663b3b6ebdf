// SPDX-License-Identifier: AGPL-3.0-or-later
#include "bench/tester.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <utility>

#include "common/parse.hpp"

namespace tetbench {

using tetfmt::Hit;
using tetfmt::Index;
using tetfmt::Interval;
using tetfmt::Location;
using tetfmt::Outcome;
using tetfmt::Vec3f;

namespace {

Vec3d wide(const Vec3f& v) {
  return {static_cast<double>(v.x), static_cast<double>(v.y), static_cast<double>(v.z)};
}
Vec3f rounded(const Vec3d& p) {
  return {static_cast<float>(p[0]), static_cast<float>(p[1]), static_cast<float>(p[2])};
}
double dot(const Vec3d& a, const Vec3d& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

bool same_bits(double a, double b) {
  return std::bit_cast<std::uint64_t>(a) == std::bit_cast<std::uint64_t>(b);
}
/// Bit for bit, all but the number of steps.
bool same_answer(const Hit& a, const Hit& b) {
  return a.outcome == b.outcome && a.back == b.back && a.triangle == b.triangle && same_bits(a.t, b.t) &&
         same_bits(a.u, b.u) && same_bits(a.v, b.v) && a.side == b.side && a.tet == b.tet &&
         a.neighbor == b.neighbor && same_bits(a.side_u, b.side_u) && same_bits(a.side_v, b.side_v) &&
         a.face == b.face;
}
/// The first thing in which two answers differ, for people.
std::string difference(const Hit& a, const Hit& b) {
  const auto text = [](const Hit& hit) {
    return hit.outcome == Outcome::hit
               ? "side " + std::to_string(hit.side) + " at t = " + tetprep::number(hit.t)
               : "outcome " + std::to_string(static_cast<int>(hit.outcome));
  };
  if (a.outcome != b.outcome || a.side != b.side || !same_bits(a.t, b.t))
    return text(a) + " against " + text(b);
  return a.face == b.face ? "weights or names differ on " + text(a)
                          : "the face's corners differ on " + text(a);
}
bool same(const Hit& a, const Hit& b) {
  return same_answer(a, b) && a.steps == b.steps;
}
bool same(const Location& a, const Location& b) {
  return a.state == b.state && a.position == b.position && a.cell == b.cell && a.positive == b.positive &&
         a.face == b.face && a.entrance_count == b.entrance_count && a.entrances == b.entrances;
}

Finding differs(const std::string& text) {
  return {Fault::differs, text};
}
constexpr const char* kOthers = "layouts or views disagree: ";

/// Calls `work` with the other three views: unchecked of the other layout, checked of both.
template <class Work>
void with_other_views(const Scene& scene, Work&& work) {
  work(scene.view(1));
  work(scene.view(0).view());
  work(scene.view(1).view());
}

}  // namespace

Bench::Bench(const std::string& path)
    : scene(path), judge(scene), maker(scene.mesh(), scene.surface()), structures(scene) {
  for (const TracerKind& kind : tracer_kinds()) {
    if (kind.name == "embree-1") peers[0] = kind.make(structures);
    if (kind.name == "embree-1-robust") peers[1] = kind.make(structures);
  }
}

std::uint32_t Asked::number_of(const Start& start) {
  if (starts.empty() || !same(starts.back().location, start.location)) starts.push_back(start);
  return static_cast<std::uint32_t>(starts.size() - 1);
}

void Tester::run(std::uint64_t count) {
  constexpr std::size_t kSideBySide = 1024;
  while (tally_.rays < count) {
    switch (set_.flow) {
      case Flow::rays:
        single(dice_.below(8) == 0);
        break;
      case Flow::crossings:
        single(true);
        break;
      case Flow::shared:
        shared();
        break;
      case Flow::bounces:
        bounces();
        break;
      case Flow::segments:
        segment();
        break;
    }
    if (asked_.rays.size() + asked_.segments.size() >= kSideBySide) side_by_side();
  }
  side_by_side();
}

void Tester::report(const std::optional<Finding>& finding) {
  if (!finding) return;
  ++tally_.faults[static_cast<std::size_t>(finding->fault)];
  if (tally_.examples.size() == Tally::kExamples) return;
  Reproducer example = current_;
  example.fault = finding->fault;
  example.file = bench_.scene.path();
  example.set = set_.name;
  example.text = finding->text;
  tally_.examples.push_back(example);
}

void Tester::about(const Start& start, const Vec3d& direction, const Interval& interval) {
  current_.origin = start.place.position;
  current_.direction = direction;
  current_.t_min = interval.t_min;
  current_.t_max = interval.t_max;
  current_.from_side = start.side;
}

Start Tester::locate(const Vec3f& point) {
  const Scene& scene = bench_.scene;
  const tetfmt::Cell* from = near_ && dice_.below(2) == 0 ? &*near_ : nullptr;
  const Start start = bench_.judge.start(tetfmt::locate(scene.view(0), point, from), point);
  about(start, {}, {});
  report(bench_.judge.location(start));
  if (dice_.below(4) == 0)
    with_other_views(scene, [&](const auto& view) {
      if (!same(tetfmt::locate(view, point, from), start.location))
        report(differs(std::string(kOthers) + "locate"));
    });
  if (start.location.state == Location::State::inside) near_ = start.location.cell;
  return start;
}

Hit Tester::ray(const Start& start, const Vec3f& direction, const Interval& interval, bool crossings) {
  const Scene& scene = bench_.scene;
  const Judge& judge = bench_.judge;
  const ExactReference& reference = scene.reference();
  ++tally_.rays;
  about(start, wide(direction), interval);

  const ExactLine line(reference.surface(), start.place, wide(direction));
  const double t_min = std::max(interval.t_min, 0.0);
  std::vector<Crossing> truth;
  if (t_min <= interval.t_max)
    truth = crossings ? reference.crossings(line, t_min, interval.t_max)
                      : reference.first_crossing(line, t_min, interval.t_max);

  const Hit hit = tetfmt::first_hit(scene.view(0), start.location, direction, interval);
  report(judge.first_hit(line, start, interval, truth, hit, tally_));
  tally_.hits += hit.outcome == Outcome::hit ? 1 : 0;
  with_other_views(scene, [&](const auto& view) {
    if (!same(tetfmt::first_hit(view, start.location, direction, interval), hit))
      report(differs(std::string(kOthers) + "first_hit"));
  });

  const Outcome expected = truth.empty() ? Outcome::miss : Outcome::hit;
  const auto occlusion = [&](const auto& view) {
    const Outcome answer = tetfmt::occlusion(view, start.location, direction, interval);
    if (answer != expected)
      report(Finding{expected == Outcome::hit ? Fault::missed : Fault::false_hit, "occlusion along a ray"});
    return answer;
  };
  asked_.rays.push_back({asked_.number_of(start), direction, interval});
  asked_.hits.push_back(hit);
  asked_.blocked.push_back(occlusion(scene.view(0)));

  const Hit by_floats =
      tetfmt::first_hit(scene.view(0), start.location, direction, interval, tetfmt::Kernel::float_only);
  if (by_floats.outcome == Outcome::corrupt || (by_floats.outcome == Outcome::miss && !truth.empty()))
    ++tally_.float_lost;
  else if (by_floats.outcome == Outcome::hit && (truth.empty() || by_floats.side != truth[0].side()))
    ++tally_.float_wrong;

  if (crossings) {
    std::vector<Hit> hits;
    const Outcome outcome = tetfmt::all_hits(scene.view(0), start.location, direction, hits, interval);
    report(judge.all_hits(line, start, interval, truth, outcome, hits, tally_));
    tally_.crossings += hits.size();
    const bool whole = interval.t_min <= 0 && interval.t_max == std::numeric_limits<double>::infinity();
    if (set_.flow == Flow::crossings && reference.surface().closed && whole && hits.size() % 2 != 0)
      report(Finding{Fault::doubled, "all_hits reports an odd number of crossings of a closed surface"});
    if (dice_.below(4) == 0)
      with_other_views(scene, [&](const auto& view) {
        std::vector<Hit> others;
        const Outcome other = tetfmt::all_hits(view, start.location, direction, others, interval);
        if (other != outcome || !std::equal(hits.begin(), hits.end(), others.begin(), others.end(),
                                            [](const Hit& a, const Hit& b) { return same(a, b); }))
          report(differs(std::string(kOthers) + "all_hits"));
      });
    with_other_views(scene, occlusion);
    if (whole && start.side == tetfmt::kNone) {
      RayList asked;
      asked.add(0, {rounded(start.place.position), direction});
      for (std::size_t i = 0; i < bench_.peers.size(); ++i) {
        if (!bench_.peers[i]) continue;
        bench_.peers[i]->trace(asked, peers_answer_);
        judge.peer(line, truth, peers_answer_[0], tally_.peers[i]);
      }
    }
    if (whole && dice_.below(4) == 0) variants(start, direction, hit);
  }
  return hit;
}

void Tester::variants(const Start& start, const Vec3f& direction, const Hit& hit) {
  using tetfmt::Arithmetic;
  using tetfmt::Basis;
  for (std::size_t layout = 0; layout < 2; ++layout)
    for (const Basis basis : {Basis::shear, Basis::orthonormal, Basis::specialised})
      for (const Arithmetic arithmetic : {Arithmetic::exact, Arithmetic::float_first}) {
        const bool counted = layout == 0 && basis == Basis::shear && arithmetic == Arithmetic::exact;
        const Hit other = tetfmt::first_hit(bench_.scene.view(layout), start.location, direction,
                                            {arithmetic, basis}, counted ? &tally_.signs : nullptr);
        if (!same_answer(other, hit))
          report(differs("arithmetic " + std::to_string(static_cast<int>(arithmetic)) + " with basis " +
                         std::to_string(static_cast<int>(basis)) + " disagrees"));
      }
}

void Tester::single(bool crossings) {
  const Shot shot = bench_.maker.make(set_, dice_);
  ray(locate(shot.origin), shot.direction, shot.interval, crossings);
}

void Tester::shared() {
  const Start start = segment_end();
  std::vector<Vec3f> directions(1 + dice_.below(400));  // more and less than are walked together
  const Vec3d forward = dice_.direction();
  const double spread = std::exp2(dice_.between(-12, 0));
  const std::uint64_t kind = dice_.below(4);
  for (Vec3f& direction : directions) {
    Vec3d d = dice_.direction();
    if (kind == 0)
      for (std::size_t k = 0; k < 3; ++k) d[k] = forward[k] + spread * d[k];
    if (kind == 1 || (kind == 2 && dice_.below(4) == 0)) {
      const Surface& surface = bench_.scene.surface();
      const Vec3d vertex =
          wide(surface.vertices[surface.faces[dice_.below(surface.faces.size())][dice_.below(3)]]);
      for (std::size_t k = 0; k < 3; ++k) d[k] = vertex[k] - start.place.position[k];
    }
    direction = rounded(d);
    if (direction == Vec3f{}) direction = {1, 0, 0};
  }
  std::vector<Hit> alone, together(directions.size());
  for (const Vec3f& direction : directions) alone.push_back(ray(start, direction, {}, false));
  const auto compare = [&](const auto& view) {
    tetfmt::first_hits(view, start.location, directions, together);
    for (std::size_t i = 0; i < directions.size(); ++i) {
      if (same_answer(alone[i], together[i])) continue;
      about(start, wide(directions[i]), {});
      report(differs("first_hit and first_hits: " + difference(alone[i], together[i])));
    }
  };
  compare(bench_.scene.view(0));
  with_other_views(bench_.scene, compare);
  targets(start, alone);
}

void Tester::targets(const Start& from, const std::vector<Hit>& hits) {
  const Scene& scene = bench_.scene;
  std::vector<Start> ends = {from};
  for (const Hit& hit : hits) {
    if (hit.outcome != Outcome::hit) {
      ends.push_back(locate(bench_.maker.end_point(dice_)));
      continue;
    }
    const bool far = ends.size() % 2 == 0;
    const tetfmt::FileView& view = scene.view(0).view();
    ends.push_back(
        bench_.judge.start_on_side(far ? tetfmt::far_side(view, hit) : tetfmt::near_side(view, hit),
                                   far ? tetfmt::twin(hit.side) : hit.side));
  }
  const std::uint32_t number = asked_.number_of(from);
  std::vector<Location> places;
  std::vector<Outcome> alone, together(ends.size());
  for (const Start& to : ends) {
    places.push_back(to.location);
    alone.push_back(tetfmt::occlusion(scene.view(0), from.location, to.location));
    asked_.segments.push_back({number, asked_.number_of(to)});
    asked_.hidden.push_back(alone.back());
  }
  const auto compare = [&](const auto& view) {
    tetfmt::occlusions(view, from.location, places, together);
    for (std::size_t i = 0; i < ends.size(); ++i) {
      if (alone[i] == together[i]) continue;
      about(from, ends[i].place.position, {0, 1});
      report(differs("occlusion and occlusions from place to place"));
    }
  };
  compare(scene.view(0));
  with_other_views(scene, compare);
}

void Tester::side_by_side() {
  const Asked asked = std::exchange(asked_, {});
  std::vector<Location> places;
  for (const Start& start : asked.starts) places.push_back(start.location);
  std::vector<Hit> hits(asked.rays.size());
  std::vector<Outcome> blocked(asked.rays.size()), hidden(asked.segments.size());
  const auto compare = [&](const auto& view) {
    tetfmt::trace_batch(view, places, asked.rays, hits);
    tetfmt::occlude_batch(view, places, asked.rays, blocked);
    tetfmt::occlude_batch(view, places, asked.segments, hidden);
    for (std::size_t i = 0; i < hits.size(); ++i) {
      const tetfmt::BatchRay& ray = asked.rays[i];
      about(asked.starts[ray.from], wide(ray.direction), ray.interval);
      if (!same_answer(asked.hits[i], hits[i]))
        report(differs("first_hit and trace_batch: " + difference(asked.hits[i], hits[i])));
      if (asked.blocked[i] != blocked[i]) report(differs("occlusion and occlude_batch along a ray"));
    }
    for (std::size_t i = 0; i < hidden.size(); ++i) {
      if (asked.hidden[i] == hidden[i]) continue;
      about(asked.starts[asked.segments[i].from], asked.starts[asked.segments[i].to].place.position, {0, 1});
      report(differs("occlusion and occlude_batch from place to place"));
    }
  };
  compare(bench_.scene.view(0));
  with_other_views(bench_.scene, compare);
}

Start Tester::side_of(const Hit& hit, bool far) {
  const Scene& scene = bench_.scene;
  const Index side = far ? tetfmt::twin(hit.side) : hit.side;
  const auto place = [&](const auto& view) {
    return far ? tetfmt::far_side(view, hit) : tetfmt::near_side(view, hit);
  };
  const Start start = bench_.judge.start_on_side(place(scene.view(0).view()), side);
  report(bench_.judge.side_location(start, hit));
  if (!same(place(scene.view(1).view()), start.location))
    report(differs(std::string(kOthers) + "near_side or far_side"));
  leave(start);
  return start;
}

/// Many rays into the half space in front of the side, which only have to leave it: that takes no truth.
void Tester::leave(const Start& start) {
  constexpr int kRays = 32;
  const Surface& surface = bench_.scene.surface();
  const GridPoint normal = surface.normal(surface.faces[start.side / 2]);
  const double front = start.side % 2 == 0 ? 1 : -1;
  const Vec3d n = {front * static_cast<double>(normal[0]), front * static_cast<double>(normal[1]),
                   front * static_cast<double>(normal[2])};
  for (int i = 0; i < kRays; ++i) {
    Vec3f direction = rounded(dice_.direction());
    const double along = dot(n, wide(direction));
    // Twelve roundings at most: what is farther from zero has the right sign.
    if (!(std::abs(along) > 1e-14 * std::sqrt(dot(n, n)))) continue;
    if (along < 0) direction = {-direction.x, -direction.y, -direction.z};
    ++tally_.leaving;
    const Hit hit = tetfmt::first_hit(bench_.scene.view(0), start.location, direction);
    if (hit.outcome == Outcome::miss || (hit.outcome == Outcome::hit && hit.side / 2 != start.side / 2))
      continue;
    about(start, wide(direction), {});
    report(
        Finding{hit.outcome == Outcome::hit ? Fault::self_hit : Fault::hung, "a ray that leaves its side"});
  }
}

/// Directions off the side: diffuse, mirrored, refracted; and some that no renderer would ask for: into the
/// face, exactly along one of its edges, along an axis.
Vec3f Tester::bounce(const Start& start, const Vec3f& incoming) {
  const Surface& surface = bench_.scene.surface();
  const GridPoint normal = surface.normal(surface.faces[start.side / 2]);
  Vec3d n = {static_cast<double>(normal[0]), static_cast<double>(normal[1]), static_cast<double>(normal[2])};
  const double length = (start.side % 2 == 0 ? 1 : -1) * std::sqrt(dot(n, n));
  for (double& component : n) component /= length;
  Vec3d d = wide(incoming);
  const double speed = std::sqrt(dot(d, d)), along = dot(n, d);
  Vec3d result = dice_.direction();
  switch (dice_.below(8)) {
    case 0:
    case 1:
      for (std::size_t k = 0; k < 3; ++k) result[k] = d[k] - 2 * along * n[k];
      break;
    case 2:  // Snell, into glass, roughly: bent towards the normal
      for (std::size_t k = 0; k < 3; ++k)
        result[k] = d[k] / (1.5 * speed) + n[k] * (0.3 + 0.2 * dice_.unit());
      break;
    case 3: {
      const Face& face = surface.faces[start.side / 2];
      const auto corner = static_cast<std::size_t>(dice_.below(3));
      const Vec3d a = wide(surface.vertices[face[corner]]),
                  b = wide(surface.vertices[face[(corner + 1) % 3]]);
      result = {b[0] - a[0], b[1] - a[1], b[2] - a[2]};  // exact: both are on the grid
      break;
    }
    case 4: {
      const std::uint64_t axis = dice_.below(6);
      result = {};
      result[axis / 2] = axis % 2 == 0 ? 1 : -1;
      break;
    }
    case 5:
      break;  // any direction, into the face too
    default:
      if (const double height = dot(n, result); height < 0)
        for (std::size_t k = 0; k < 3; ++k) result[k] -= 2 * height * n[k];
      break;
  }
  const Vec3f direction = rounded(result);
  return direction == Vec3f{} ? incoming : direction;
}

void Tester::bounces() {
  const Shot shot = bench_.maker.make(set_, dice_);
  Vec3f direction = shot.direction;
  Start start = locate(shot.origin);
  for (int depth = 0; depth < 4; ++depth) {
    const Hit hit = ray(start, direction, {}, dice_.below(8) == 0);
    if (hit.outcome != Outcome::hit) return;
    start = side_of(hit, dice_.below(3) == 0);
    direction = bounce(start, direction);
  }
}

/// A place that float32 holds, or, of four, one on a side of a face.
Start Tester::segment_end() {
  if (dice_.below(4) == 0) {
    const RaySet& rays = ray_sets()[1];
    const Shot shot = bench_.maker.make(rays, dice_);
    const Start start = locate(shot.origin);
    const Hit hit = tetfmt::first_hit(bench_.scene.view(0), start.location, shot.direction);
    if (hit.outcome == Outcome::hit) return side_of(hit, dice_.below(2) == 0);
  }
  return locate(bench_.maker.end_point(dice_));
}

void Tester::segment() {
  const Scene& scene = bench_.scene;
  const Start from = segment_end();
  const Start to = dice_.below(64) == 0 ? from : segment_end();
  ++tally_.rays;
  about(from, to.place.position, {0, 1});
  Outcome expected = Outcome::miss;
  std::string what = "occlusion from place to place";
  if (from.place.position != to.place.position) {
    const ExactLine line(scene.surface(), from.place, to.place);
    const auto truth = scene.reference().first_crossing(line, 0, 1);
    if (!truth.empty()) {
      expected = Outcome::hit;
      what +=
          ": side " + std::to_string(truth[0].side()) + " is between, at t = " + std::to_string(truth[0].low);
    }
  } else if (from.side != to.side) {
    if (from.side == tetfmt::kNone || to.side == tetfmt::kNone) return;  // a line without a direction
    expected = Outcome::hit;
    what += ": the face itself is between";
  }
  if (to.side != tetfmt::kNone) what += "; to side " + std::to_string(to.side);
  tally_.hits += expected == Outcome::hit ? 1 : 0;
  const Outcome answer = tetfmt::occlusion(scene.view(0), from.location, to.location);
  const std::uint32_t number = asked_.number_of(from);
  asked_.segments.push_back({number, asked_.number_of(to)});
  asked_.hidden.push_back(answer);
  if (answer == Outcome::corrupt)
    report(Finding{Fault::hung, what});
  else if (answer != expected)
    report(Finding{expected == Outcome::hit ? Fault::missed : Fault::false_hit, what});
  with_other_views(scene, [&](const auto& view) {
    if (tetfmt::occlusion(view, from.location, to.location) != answer)
      report(differs(std::string(kOthers) + what));
  });
}

}  // namespace tetbench
