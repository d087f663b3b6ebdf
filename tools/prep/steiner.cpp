// SPDX-License-Identifier: AGPL-3.0-or-later
#include "prep/steiner.hpp"

#include <algorithm>
#include <cmath>

namespace tetprep {
namespace {

GridPoint nearest(const Point& p) {
  GridPoint rounded{};
  for (std::size_t k = 0; k < 3; ++k) {
    const double limit = kMaxCoordinate;
    rounded[k] = static_cast<std::int32_t>(std::clamp(std::nearbyint(p[k]), -limit, limit));
  }
  return rounded;
}

/// Steps to the grid points within `radius`, nearest first; ties in lexicographic order.
std::vector<GridPoint> steps_within(int radius) {
  std::vector<GridPoint> steps;
  for (int x = -radius; x <= radius; ++x)
    for (int y = -radius; y <= radius; ++y)
      for (int z = -radius; z <= radius; ++z) steps.push_back({x, y, z});
  std::stable_sort(steps.begin(), steps.end(), [](const GridPoint& a, const GridPoint& b) {
    const auto squared = [](const GridPoint& s) { return s[0] * s[0] + s[1] * s[1] + s[2] * s[2]; };
    return squared(a) < squared(b);
  });
  return steps;
}

class Mover {
 public:
  Mover(std::vector<GridPoint>& points, std::size_t first_free, std::span<const Point> wanted,
        std::span<const std::array<Index, 4>> tets, int sign, std::size_t bound, int reach)
      : points_(points),
        first_free_(first_free),
        wanted_(wanted),
        tets_(tets),
        sign_(sign),
        bound_(bound),
        around_bound_(steps_within(reach)),
        stars_(wanted.size()) {
    for (Index t = 0; t < tets.size(); ++t)
      for (const Index v : tets[t])
        if (v >= first_free) stars_[v - first_free].push_back(t);
  }

  /// Moves `free` (a position in `wanted`) to the first place that leaves no broken tet around it; if there
  /// is none, to one that leaves the fewest. Candidates: the grid points around the wanted place, then around
  /// places on the way from there to the middle of the star, whose tets are the less flat the nearer it gets.
  void move(std::size_t free) {
    GridPoint best = points_[first_free_ + free];
    std::size_t fewest = broken_around(free, best);
    const auto try_around = [&](const Point& place, const std::vector<GridPoint>& steps) {
      const GridPoint base = nearest(place);
      for (const GridPoint& step : steps) {
        if (fewest == 0) return;
        const GridPoint candidate{base[0] + step[0], base[1] + step[1], base[2] + step[2]};
        const std::size_t broken = broken_around(free, candidate);
        if (broken < fewest) {
          fewest = broken;
          best = candidate;
        }
      }
    };
    static const std::vector<GridPoint> near = steps_within(1), far = steps_within(4);
    if (free < bound_) {
      try_around(wanted_[free], around_bound_);
      points_[first_free_ + free] = best;
      return;
    }
    try_around(wanted_[free], far);
    const Point middle = middle_of_star(free);
    for (int i = 1; i <= 8; ++i) {
      Point place{};
      for (std::size_t k = 0; k < 3; ++k)
        place[k] = wanted_[free][k] + (middle[k] - wanted_[free][k]) * i / 8;
      try_around(place, near);
    }
    points_[first_free_ + free] = best;
  }

  const std::vector<Index>& star(std::size_t free) const { return stars_[free]; }
  bool is_broken(Index t) const {
    const auto& [a, b, c, d] = tets_[t];
    return tetfmt::orientation(points_[a], points_[b], points_[c], points_[d]) != sign_;
  }

 private:
  std::size_t broken_around(std::size_t free, const GridPoint& place) {
    points_[first_free_ + free] = place;
    return static_cast<std::size_t>(
        std::count_if(stars_[free].begin(), stars_[free].end(), [&](Index t) { return is_broken(t); }));
  }

  Point middle_of_star(std::size_t free) const {
    Point sum{};
    double count = 0;
    for (const Index t : stars_[free]) {
      for (const Index v : tets_[t]) {
        if (v == first_free_ + free) continue;
        for (std::size_t k = 0; k < 3; ++k) sum[k] += points_[v][k];
        ++count;
      }
    }
    for (double& s : sum) s /= count;
    return sum;
  }

  std::vector<GridPoint>& points_;
  std::size_t first_free_;
  std::span<const Point> wanted_;
  std::span<const std::array<Index, 4>> tets_;
  int sign_;
  std::size_t bound_;
  std::vector<GridPoint> around_bound_;
  std::vector<std::vector<Index>> stars_;
};

}  // namespace

std::optional<Index> place_steiner_points(std::vector<GridPoint>& points, std::size_t first_free,
                                          std::span<const Point> wanted,
                                          std::span<const std::array<Index, 4>> tets, int sign,
                                          std::size_t bound, int reach) {
  points.resize(first_free);
  for (const Point& place : wanted) points.push_back(nearest(place));

  const auto is_broken = [&](const std::array<Index, 4>& tet) {
    return tetfmt::orientation(points[tet[0]], points[tet[1]], points[tet[2]], points[tet[3]]) != sign;
  };
  std::vector<Index> broken;
  for (Index t = 0; t < tets.size(); ++t)
    if (is_broken(tets[t])) broken.push_back(t);
  if (broken.empty()) return Index{0};

  Mover mover(points, first_free, wanted, tets, sign, bound, reach);
  // A point's move can only be blocked by neighbours that stand badly themselves, so a few rounds do.
  constexpr int kRounds = 8;
  for (int round = 0; round < kRounds && !broken.empty(); ++round) {
    std::vector<std::size_t> movable;
    for (const Index t : broken)
      for (const Index v : tets[t])
        if (v >= first_free) movable.push_back(v - first_free);
    std::sort(movable.begin(), movable.end());
    movable.erase(std::unique(movable.begin(), movable.end()), movable.end());
    std::vector<Index> touched = broken;
    for (const std::size_t free : movable) {
      mover.move(free);
      touched.insert(touched.end(), mover.star(free).begin(), mover.star(free).end());
    }
    std::sort(touched.begin(), touched.end());
    touched.erase(std::unique(touched.begin(), touched.end()), touched.end());
    broken.clear();
    std::copy_if(touched.begin(), touched.end(), std::back_inserter(broken),
                 [&](Index t) { return mover.is_broken(t); });
  }
  if (!broken.empty()) return std::nullopt;
  Index moved = 0;
  for (std::size_t i = 0; i < wanted.size(); ++i) moved += points[first_free + i] != nearest(wanted[i]);
  return moved;
}

}  // namespace tetprep
