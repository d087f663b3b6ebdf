// SPDX-License-Identifier: AGPL-3.0-or-later
#include "tet/ray_answers.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <vector>

namespace tetprep {
namespace {

using tetfmt::Hit;
using tetfmt::Index;
using tetfmt::Location;
using tetfmt::Outcome;

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

constexpr std::array<Column, 7> kFirst = {{{"triangle", "<i4"},
                                           {"t", "<f8"},
                                           {"u", "<f8"},
                                           {"v", "<f8"},
                                           {"side", "<i4"},
                                           {"tet", "<i4"},
                                           {"neighbor", "<i4"}}};
constexpr std::array<Column, 1> kAny = {{{"blocked", "<i4"}}};
constexpr std::array<Column, 12> kAll = {{{"ray", "<i8"},
                                          {"hit", "<i4"},
                                          {"triangle", "<i4"},
                                          {"t", "<f8"},
                                          {"u", "<f8"},
                                          {"v", "<f8"},
                                          {"side", "<i4"},
                                          {"tet", "<i4"},
                                          {"neighbor", "<i4"},
                                          {"region", "<i4"},
                                          {"beyond", "<i4"},
                                          {"length", "<f8"}}};
constexpr std::array<Column, 3> kPaths = {{{"ray", "<i8"}, {"region", "<i4"}, {"length", "<f8"}}};

/// Indices that there are none of are kNone, which is -1 here.
std::int32_t signed_index(Index index) {
  return static_cast<std::int32_t>(index);
}

/// The number of the region that holds a tetrahedron: kNone if there is none, or the file does not tell.
Index region_id(const tetfmt::FileView& view, Index tet) {
  const Index region = view.region_of(tet);
  return region == tetfmt::kNone ? tetfmt::kNone : view.regions()[region].id;
}

double norm(const tetfmt::Vec3f& v) {
  const double x = v.x, y = v.y, z = v.z;
  return std::sqrt(x * x + y * y + z * z);  // float32: no square leaves double's range
}

Answered first(const Asked& asked, Rows& rows) {
  const auto& [view, from, number, direction, interval, kernel] = asked;
  Hit hit = tetfmt::first_hit(view, from, direction, interval, kernel);
  Answered answered = Answered::fully;
  // Float signs can go in circles on a sound mesh: only the exact walk may blame the file.
  if (hit.outcome == Outcome::corrupt && kernel != tetfmt::Kernel::exact &&
      tetfmt::first_hit(view, from, direction, interval).outcome != Outcome::corrupt) {
    hit = {};
    answered = Answered::lost;
  }
  const Answered added = add_row(hit, rows);
  return added == Answered::fully ? answered : added;
}

Answered any(const Asked& asked, Rows& rows) {
  return add_row(tetfmt::occlusion(asked.view, asked.from, asked.direction, asked.interval), rows);
}

Answered all(const Asked& asked, Rows& rows) {
  const auto& view = asked.view;
  std::vector<Hit> hits;
  const Outcome outcome = tetfmt::all_hits(view, asked.from, asked.direction, hits, asked.interval);
  if (outcome == Outcome::corrupt) return Answered::corrupt;
  const double unit = norm(asked.direction);
  for (std::size_t i = 0; i < hits.size(); ++i) {
    const Hit& hit = hits[i];
    const bool last = i + 1 == hits.size();
    const double until = !last ? hits[i + 1].t : outcome == Outcome::absent ? kNaN : asked.interval.t_max;
    rows.add(asked.number, static_cast<std::int32_t>(i), signed_index(hit.triangle), hit.t, hit.u, hit.v,
             std::int32_t{hit.back}, signed_index(hit.tet), signed_index(hit.neighbor),
             signed_index(region_id(view, hit.tet)), signed_index(region_id(view, hit.neighbor)),
             (until - hit.t) * unit);
  }
  return outcome == Outcome::absent && hits.empty() ? Answered::absent : Answered::fully;
}

/// From the ray's start, even where the interval begins later: so that the region it begins in is known.
Answered paths(const Asked& asked, Rows& rows) {
  const auto& view = asked.view;
  const double t_min = std::max(asked.interval.t_min, 0.0), t_max = asked.interval.t_max;
  std::vector<Hit> hits;
  const Outcome outcome = tetfmt::all_hits(view, asked.from, asked.direction, hits, {0, t_max});
  if (outcome == Outcome::corrupt) return Answered::corrupt;
  if (norm(asked.direction) == 0 || !(t_min <= t_max)) return Answered::fully;

  constexpr std::int64_t kLeftOut = -1;
  std::map<std::int64_t, double> lengths;  // by region
  double since = 0;
  const auto stretch = [&](std::int64_t region, double until) {
    const double begin = std::max(since, t_min);
    if (until > begin) lengths[region] += (until - begin) * norm(asked.direction);
    since = until;
  };
  const auto region_of = [&](Index tet) {
    const Index id = region_id(view, tet);
    return id == tetfmt::kNone ? kLeftOut : std::int64_t{id};
  };
  const bool inside = asked.from.state == Location::State::inside;
  std::int64_t region = inside ? region_of(asked.from.cell.tet) : 0;  // outside of the hull is region 0
  for (const Hit& hit : hits) {
    stretch(region, hit.t);
    region = region_of(hit.neighbor);
  }
  if (outcome != Outcome::absent) {
    stretch(region, t_max);
  } else if (since < t_max) {
    lengths[kLeftOut] = kNaN;  // what is there, and how far it goes, the file does not say
  }
  for (const auto& [id, length] : lengths) rows.add(asked.number, static_cast<std::int32_t>(id), length);
  return outcome == Outcome::absent && hits.empty() ? Answered::absent : Answered::fully;
}

}  // namespace

std::span<const Column> columns_of(Answer answer) {
  switch (answer) {
    case Answer::any:
      return kAny;
    case Answer::all:
      return kAll;
    case Answer::paths:
      return kPaths;
    case Answer::first:
      break;
  }
  return kFirst;
}

Answered add_row(const Hit& hit, Rows& rows) {
  constexpr std::int32_t kNo = -1;
  switch (hit.outcome) {
    case Outcome::corrupt:
      return Answered::corrupt;
    case Outcome::absent:
      rows.add(std::int32_t{-2}, kNaN, 0.0, 0.0, kNo, kNo, kNo);
      return Answered::absent;
    case Outcome::miss:
      rows.add(kNo, hit.t, 0.0, 0.0, kNo, kNo, kNo);
      return Answered::fully;
    case Outcome::hit:
      break;
  }
  rows.add(signed_index(hit.triangle), hit.t, hit.u, hit.v, std::int32_t{hit.back}, signed_index(hit.tet),
           signed_index(hit.neighbor));
  return Answered::fully;
}

Answered add_row(Outcome outcome, Rows& rows) {
  if (outcome == Outcome::corrupt) return Answered::corrupt;
  const bool absent = outcome == Outcome::absent;
  rows.add(std::int32_t{absent ? -2 : outcome == Outcome::hit ? 1 : 0});
  return absent ? Answered::absent : Answered::fully;
}

Answered answer_ray(Answer answer, const Asked& asked, Rows& rows) {
  switch (answer) {
    case Answer::any:
      return any(asked, rows);
    case Answer::all:
      return all(asked, rows);
    case Answer::paths:
      return paths(asked, rows);
    case Answer::first:
      break;
  }
  return first(asked, rows);
}

}  // namespace tetprep
