// SPDX-License-Identifier: AGPL-3.0-or-later
// Rounds of cutting everything along its exact intersections and rounding the new points to the grid, which
// may bring about intersections anew (a point leaves its triangle's plane by up to a step), but fewer ones.
// What two triangles share is cut at the same exact points in both, so it is the same after rounding: nothing
// comes apart. A piece that becomes flat is dropped; its middle corner then lies on an edge of its neighbour,
// which the next round cuts there. Where triangles are nearly parallel, or crowded, rounding alone makes ever
// more and thinner pieces. There, and only there, points and edges that pass each other closely are made to
// meet, as in Hobby's snap rounding
// ("Practical segment intersection with finite precision output", 1999); from round to round further ones.
// That is a coarser grid where one is needed, which leaves the rest of the surface alone.
#include "prep/resolve.hpp"

#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <thread>

#include "common/parse.hpp"
#include "prep/cut_plan.hpp"
#include "prep/cut_triangles.hpp"
#include "prep/near_contacts.hpp"
#include "prep/piece_deviation.hpp"
#include "prep/point_index.hpp"

namespace tetprep {
namespace {

using Corners = std::array<Index, 3>;

/// How far apart points may be to become one. A new point is up to 0.9 steps from where it should be, so what
/// is as near as this cannot be told apart anyway; in every round after the second it is twice as far. Grid
/// steps.
constexpr std::int32_t kReach = 2;
/// Leading a triangle through a point may bring it near to another.
constexpr int kBends = 2;
/// One to three are enough for real meshes. The reach is a thousandth of the extent by now.
constexpr int kMostRounds = 11;

bool is_flat(const GridPoint& a, const GridPoint& b, const GridPoint& c) {
  for (std::size_t axis = 0; axis < 3; ++axis)
    if (tetfmt::doubled_area(a, b, c, axis) != 0) return false;
  return true;
}

Corners ascending(Corners corners) {
  std::sort(corners.begin(), corners.end());
  return corners;
}

class Resolver {
 public:
  Resolver(CleanSurface surface, Progress& progress, ResolveReport& report, std::size_t max_pieces)
      : surface_(std::move(surface)),
        progress_(progress),
        report_(report),
        max_pieces_(max_pieces),
        step_(std::ldexp(1.0, surface_.grid_exponent)),
        first_points_(surface_.points) {
    if (surface_.input_corners.empty()) {
      surface_.input_corners.assign(surface_.input_triangle_count, {kNone, kNone, kNone});
      for (std::size_t t = 0; t < surface_.triangles.size(); ++t)
        surface_.input_corners[surface_.input_triangle[t]] = surface_.triangles[t];
    }
    first_corners_ = surface_.input_corners;
  }

  CleanSurface run(std::vector<TrianglePair> pairs) {
    if (pairs.size() >= IntersectionSearch::kMostPairs) pairs = search({});
    while (!pairs.empty()) {
      while (!pairs.empty()) {
        if (report_.rounds == kMostRounds) fail_endless(pairs);
        if (report_.rounds > 0) {
          report_.grid_coarsening = report_.rounds - 1;
          pairs = search(merge_corners(pairs));
          for (int i = 0; i < kBends && !pairs.empty(); ++i) pairs = bend(pairs);
        }
        if (!pairs.empty()) pairs = cut(pairs);
      }
      // What the rounds looked at was only what they had changed.
      pairs = search({});
    }
    finish();
    return std::move(surface_);
  }

 private:
  std::vector<TrianglePair> search(const std::vector<bool>& active) {
    const std::atomic<bool> cancelled{false};
    std::atomic<std::size_t> found{0};
    // Every pair leaves at least one piece more behind.
    auto pairs =
        find_intersections(surface_.points, surface_.triangles, active, max_pieces_, cancelled, found);
    if (pairs.size() >= max_pieces_) fail_too_many(pairs);
    return pairs;
  }

  /// One round. Returns the pairs that intersect after it.
  std::vector<TrianglePair> cut(const std::vector<TrianglePair>& pairs) {
    const CutPlan plan = plan_cuts(surface_.points, surface_.triangles, pairs);
    std::vector<CutResult> results = cut_all(plan, pairs);
    ++report_.rounds;
    return search(replace(plan, std::move(results), triangles_of(pairs)));
  }

  /// Leads triangles that intersect through each other's corners that are near. Returns the pairs that
  /// intersect after it.
  std::vector<TrianglePair> bend(const std::vector<TrianglePair>& pairs) {
    const std::vector<bool> active = triangles_of(pairs);
    std::vector<Index> which;
    for (Index t = 0; t < active.size(); ++t)
      if (active[t]) which.push_back(t);
    const CutPlan plan = plan_bends(surface_.triangles,
                                    find_near_contacts(surface_.points, surface_.triangles, which, reach()));
    return search(replace(plan, cut_all(plan, pairs), active));
  }

  std::vector<bool> triangles_of(const std::vector<TrianglePair>& pairs) const {
    std::vector<bool> marked(surface_.triangles.size(), false);
    for (const auto& [a, b] : pairs) marked[a] = marked[b] = true;
    return marked;
  }

  std::vector<CutResult> cut_all(const CutPlan& plan, const std::vector<TrianglePair>& pairs) {
    std::vector<CutResult> results(plan.tasks.size());
    std::atomic<std::size_t> pieces{surface_.triangles.size()}, done{0};
    std::atomic<bool> too_many{false};
    const auto caller = std::this_thread::get_id();
    tbb::parallel_for(std::size_t{0}, plan.tasks.size(), [&](std::size_t i) {
      if (too_many.load(std::memory_order_relaxed)) return;
      results[i] = cut_triangles(surface_.points, surface_.triangles, plan.tasks[i], max_pieces_);
      const std::size_t more = results[i].pieces.size();
      if (results[i].too_many || pieces.fetch_add(more, std::memory_order_relaxed) + more > max_pieces_)
        too_many.store(true, std::memory_order_relaxed);
      const std::size_t count = done.fetch_add(1, std::memory_order_relaxed) + 1;
      if (count % 64 == 0 && std::this_thread::get_id() == caller) tell(count, plan.tasks.size());
    });
    if (too_many) fail_too_many(pairs);
    return results;
  }

  /// Every round takes a fixed share of what was left.
  void tell(std::size_t done, std::size_t all) {
    constexpr double kRest = 0.2;
    const double left = std::pow(kRest, report_.rounds);
    told_ =
        std::max(told_, 1 - left + left * (1 - kRest) * static_cast<double>(done) / static_cast<double>(all));
    progress_.fraction(told_);
  }

  /// Puts the pieces in the places of what they are pieces of. Returns which triangles are new, or were
  /// marked in `active`.
  std::vector<bool> replace(const CutPlan& plan, std::vector<CutResult> results,
                            const std::vector<bool>& active) {
    const auto first_new = static_cast<Index>(surface_.points.size());
    const std::vector<std::vector<Index>> numbers = add_points(plan, results);
    constexpr std::size_t kUncut = std::numeric_limits<std::size_t>::max();
    std::vector<std::size_t> task_of(surface_.triangles.size(), kUncut);
    for (std::size_t i = 0; i < plan.tasks.size(); ++i) {
      report_.overlaps += results[i].overlaps;
      for (const Index member : plan.tasks[i].members) task_of[member] = i;
    }
    std::vector<std::size_t> next(results.size(), 0);  // piece of each task: they ascend as their owners do
    std::vector<Corners> triangles;
    std::vector<Index> input_triangle;
    std::vector<bool> fresh;
    const auto add = [&](const Corners& corners, Index owner, bool is_fresh) {
      triangles.push_back(corners);
      input_triangle.push_back(surface_.input_triangle[owner]);
      fresh.push_back(is_fresh);
    };
    for (Index t = 0; t < surface_.triangles.size(); ++t) {
      if (task_of[t] == kUncut) {
        add(surface_.triangles[t], t, active[t]);
        continue;
      }
      const auto& pieces = results[task_of[t]].pieces;
      for (std::size_t& i = next[task_of[t]]; i < pieces.size() && pieces[i].owner == t; ++i) {
        Corners corners = pieces[i].corners;
        for (Index& corner : corners)
          if (corner >= first_new) corner = numbers[task_of[t]][corner - first_new];
        if (!is_flat(surface_.points[corners[0]], surface_.points[corners[1]], surface_.points[corners[2]]))
          add(corners, t, true);
      }
    }
    surface_.triangles = std::move(triangles);
    surface_.input_triangle = std::move(input_triangle);
    drop_repeated(fresh);
    return fresh;
  }

  /// How far points look for others to become one with, in this round. Grid steps.
  std::int32_t reach() const { return kReach << report_.grid_coarsening; }

  /// Numbers of each result's new points in the surface, where equal ones are one.
  std::vector<std::vector<Index>> add_points(const CutPlan& plan, const std::vector<CutResult>& results) {
    auto& points = surface_.points;
    PointIndex index(points);
    NearIndex near(points, reach());
    std::vector<bool> seen(points.size(), false);
    for (const Index member : plan.members) {
      for (const Index corner : surface_.triangles[member]) {
        if (!seen[corner]) near.add(corner);
        seen[corner] = true;
      }
    }
    std::unordered_map<GridPoint, Index, PlaceHash> taken;
    std::vector<std::vector<Index>> numbers(results.size());
    for (std::size_t i = 0; i < results.size(); ++i) {
      for (std::size_t k = 0; k < results[i].new_points.size(); ++k) {
        const GridPoint& place = results[i].new_points[k];
        const auto [at, fresh] = taken.try_emplace(place, kNone);
        Index& number = at->second;
        if (fresh) {
          number = index.find(place);
          if (number == kNone) number = near.find(place);
          if (number == kNone) {
            number = index.add(place);
            near.add(number);
          }
        }
        numbers[i].push_back(number);
      }
    }
    return numbers;
  }

  /// Of triangles with the same corners only the first stays. Only those that are marked in `fresh`, which is
  /// brought in line, may be part of it.
  void drop_repeated(std::vector<bool>& fresh) {
    const auto& triangles = surface_.triangles;
    std::vector<bool> touched(surface_.points.size(), false);
    for (std::size_t t = 0; t < triangles.size(); ++t)
      if (fresh[t])
        for (const Index corner : triangles[t]) touched[corner] = true;
    std::vector<std::pair<Corners, Index>> candidates;
    for (Index t = 0; t < triangles.size(); ++t)
      if (std::all_of(triangles[t].begin(), triangles[t].end(), [&](Index c) { return touched[c]; }))
        candidates.emplace_back(ascending(triangles[t]), t);
    std::sort(candidates.begin(), candidates.end());
    std::vector<bool> repeated(triangles.size(), false);
    for (std::size_t i = 1; i < candidates.size(); ++i)
      if (candidates[i].first == candidates[i - 1].first) repeated[candidates[i].second] = true;
    std::size_t kept = 0;
    for (std::size_t t = 0; t < triangles.size(); ++t) {
      if (repeated[t]) {
        ++report_.overlaps;
        continue;
      }
      surface_.triangles[kept] = surface_.triangles[t];
      surface_.input_triangle[kept] = surface_.input_triangle[t];
      fresh[kept++] = fresh[t];
    }
    surface_.triangles.resize(kept);
    surface_.input_triangle.resize(kept);
    fresh.resize(kept);
  }

  /// Makes one point of those corners of intersecting triangles that are within reach of each other: the one
  /// with the lowest number, which is the surface's own if there is one. Returns which triangles that
  /// changed.
  std::vector<bool> merge_corners(const std::vector<TrianglePair>& pairs) {
    std::vector<bool> fresh = triangles_of(pairs), near_pair(surface_.points.size(), false);
    for (std::size_t t = 0; t < fresh.size(); ++t)
      if (fresh[t])
        for (const Index corner : surface_.triangles[t]) near_pair[corner] = true;
    NearIndex kept(surface_.points, reach());
    std::vector<Index> number(surface_.points.size());
    std::iota(number.begin(), number.end(), Index{0});
    for (Index i = 0; i < number.size(); ++i) {
      if (!near_pair[i]) continue;
      const Index there = kept.find(surface_.points[i]);
      if (there == kNone) {
        kept.add(i);
        continue;
      }
      number[i] = there;
    }
    const auto renumber = [&](Corners& corners) {
      for (Index& corner : corners) corner = number[corner];
      return is_flat(surface_.points[corners[0]], surface_.points[corners[1]], surface_.points[corners[2]]);
    };
    for (Corners& corners : surface_.input_corners)
      if (corners[0] != kNone && renumber(corners)) corners = {kNone, kNone, kNone};
    std::size_t left = 0;
    for (std::size_t t = 0; t < surface_.triangles.size(); ++t) {
      const Corners before = surface_.triangles[t];
      if (renumber(surface_.triangles[t])) continue;
      fresh[left] = fresh[t] || surface_.triangles[t] != before;
      surface_.triangles[left] = surface_.triangles[t];
      surface_.input_triangle[left++] = surface_.input_triangle[t];
    }
    surface_.triangles.resize(left);
    surface_.input_triangle.resize(left);
    fresh.resize(left);
    drop_repeated(fresh);
    return fresh;
  }

  /// Points that are used, in the order that they have, and corners of the input in terms of them.
  void finish() {
    auto& corners_of = surface_.input_corners;
    std::vector<bool> used(surface_.points.size(), false);
    for (const Corners& triangle : surface_.triangles)
      for (const Index corner : triangle) used[corner] = true;
    const double moved = furthest_corner();
    const auto unused = [&](Index corner) { return corner != kNone && !used[corner]; };
    for (std::size_t t = 0, end = 0; t < surface_.triangles.size(); t = end) {
      const Index input = surface_.input_triangle[t];
      while (end < surface_.triangles.size() && surface_.input_triangle[end] == input) ++end;
      if (end - t > 1) {
        ++report_.cut_triangles;
        report_.pieces += end - t;
      }
      // Thinner than the grid at a corner, and nothing else there: the nearest corner of a piece takes its
      // place; and where that leaves no triangle, the first piece stands for the whole.
      Corners& corners = corners_of[input];
      for (Index& corner : corners)
        if (unused(corner)) corner = nearest_corner(corner, t, end);
      if (corners[0] == kNone || corners[0] == corners[1] || corners[1] == corners[2] ||
          corners[2] == corners[0])
        corners = surface_.triangles[t];
    }
    for (Corners& corners : corners_of)
      if (std::any_of(corners.begin(), corners.end(), unused)) corners = {kNone, kNone, kNone};

    std::vector<Index> number(surface_.points.size(), kNone);
    Index count = 0;
    for (std::size_t i = 0; i < number.size(); ++i) {
      if (!used[i]) continue;
      number[i] = count;
      surface_.points[count++] = surface_.points[i];
    }
    surface_.points.resize(count);
    for (auto* list : {&surface_.triangles, &corners_of})
      for (Corners& corners : *list)
        for (Index& corner : corners)
          if (corner != kNone) corner = number[corner];
    report_.max_deviation =
        step_ * std::max(moved, furthest_from_origin(surface_, first_points_, first_corners_));
  }

  /// Of the corners of triangles `begin` to `end`, the nearest to a point; the first of several.
  Index nearest_corner(Index point, std::size_t begin, std::size_t end) const {
    const auto squared_distance = [&](Index corner) {
      std::int64_t squared = 0;
      for (std::size_t k = 0; k < 3; ++k) {
        const std::int64_t d = surface_.points[corner][k] - surface_.points[point][k];
        squared += d * d;
      }
      return squared;
    };
    Index nearest = surface_.triangles[begin][0];
    for (std::size_t t = begin; t < end; ++t)
      for (const Index corner : surface_.triangles[t])
        if (squared_distance(corner) < squared_distance(nearest)) nearest = corner;
    return nearest;
  }

  /// The largest distance of a corner of the input from its place. Grid steps.
  double furthest_corner() const {
    std::int64_t squared = 0;
    for (std::size_t t = 0; t < first_corners_.size(); ++t)
      for (std::size_t k = 0; k < 3; ++k)
        if (const Index now = surface_.input_corners[t][k]; now != kNone)
          squared =
              std::max(squared, squared_distance(surface_.points[now], first_points_[first_corners_[t][k]]));
    return std::sqrt(static_cast<double>(squared));
  }

  /// The triangles that most pairs are about.
  std::string name_busiest(const std::vector<TrianglePair>& pairs) const {
    constexpr std::size_t kNamed = 3;
    std::vector<std::pair<std::size_t, Index>> count(surface_.input_triangle_count);
    for (Index i = 0; i < count.size(); ++i) count[i] = {0, i};
    for (const auto& [a, b] : pairs)
      for (const Index t : {a, b}) ++count[surface_.input_triangle[t]].first;
    const std::size_t named = std::min(kNamed, count.size());
    std::partial_sort(count.begin(), count.begin() + static_cast<std::ptrdiff_t>(named), count.end(),
                      [](const auto& a, const auto& b) {
                        return a.first != b.first ? a.first > b.first : a.second < b.second;
                      });
    std::string text;
    for (std::size_t i = 0; i < named && count[i].first > 0; ++i)
      text += (i > 0 ? ", " : "") + std::string("triangle ") + std::to_string(count[i].second) + " " +
              where(count[i].second) + " meets " + std::to_string(count[i].first);
    return text;
  }

  std::string where(Index input) const {
    const Index corner = surface_.input_corners[input][0];
    if (corner == kNone) return {};
    std::string text = "at (";
    for (std::size_t k = 0; k < 3; ++k)
      text += (k > 0 ? " " : "") + number(surface_.origin[k] + surface_.points[corner][k] * step_);
    return text + ")";
  }

  [[noreturn]] void fail_too_many(const std::vector<TrianglePair>& pairs) const {
    throw Failure(ExitCode::unsupported,
                  "the surface intersects itself so much that it would be cut into more than " +
                      std::to_string(max_pieces_) + " triangles; " + name_busiest(pairs) +
                      " others; remove or separate such triangles");
  }

  [[noreturn]] void fail_endless(const std::vector<TrianglePair>& pairs) const {
    throw Failure(ExitCode::runtime, "the surface still intersects itself after " +
                                         std::to_string(report_.rounds) +
                                         " rounds of cutting, in the last of which points up to " +
                                         number(reach() * step_) + " apart (model units) were made one; " +
                                         name_busiest(pairs) + " others; remove or separate such triangles");
  }

  CleanSurface surface_;
  Progress& progress_;
  ResolveReport& report_;
  const std::size_t max_pieces_;
  const double step_;
  double told_ = 0;
  const std::vector<GridPoint> first_points_;  ///< the surface as it came
  std::vector<Corners> first_corners_;         ///< of each input triangle, in it
};

}  // namespace

CleanSurface resolve(CleanSurface surface, std::vector<TrianglePair> pairs, unsigned threads,
                     Progress& progress, ResolveReport& report, std::size_t max_pieces) {
  report = {};
  report.intersecting_pairs = pairs.size();
  if (pairs.empty()) return surface;
  const std::size_t points = surface.points.size();
  CleanSurface result;
  tbb::task_arena(static_cast<int>(std::max(1u, threads))).execute([&] {
    result = Resolver(std::move(surface), progress, report, max_pieces).run(std::move(pairs));
  });
  report.new_points = result.points.size() - std::min(points, result.points.size());
  return result;
}

}  // namespace tetprep
