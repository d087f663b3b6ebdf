// SPDX-License-Identifier: AGPL-3.0-or-later
#include "prep/cone_finder.hpp"

#include <algorithm>
#include <cmath>

namespace tetprep {
namespace {

/// A cone must gain at least this share of the area around its point; rounding then cannot make two of them
/// undo each other for ever.
constexpr double kLeastGain = 1e-6;
/// A search does not go on behind a tet if taking it would cost this share of the area around the point, less
/// what the tets in front of it gain.
constexpr double kMostDebt = 0.3;
/// A move must gain more: there is no end to small ones.
constexpr double kLeastGainOfMove = 1e-2;

using Vector = std::array<double, 3>;

/// Whether it is a step on the grid, and not what is left of an equation that was close to having no
/// solution.
bool is_near(const Vector& step) {
  return std::all_of(step.begin(), step.end(), [](double x) { return std::abs(x) < kMaxCoordinate; });
}

Vector from(const GridPoint& p, const GridPoint& q) {
  return {double(q[0] - p[0]), double(q[1] - p[1]), double(q[2] - p[2])};
}

Vector cross(const Vector& a, const Vector& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

double dot(const Vector& a, const Vector& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

double length(const Vector& a) {
  return std::sqrt(dot(a, a));
}

/// The point with the least sum of areas of its triangles to edges, each given by one end and what leads to
/// the other. That sum is convex. Weiszfeld's iteration for distances to lines.
Vector least_area(const std::vector<std::pair<Vector, Vector>>& edges, Vector p) {
  constexpr int kSteps = 3;
  for (int step = 0; step < kSteps; ++step) {
    std::array<Vector, 3> rows{};
    Vector right{};
    for (const auto& [end, along] : edges) {
      const double edge = length(along);
      const Vector to{p[0] - end[0], p[1] - end[1], p[2] - end[2]};
      const double distance = length(cross(to, along)) / edge;
      const double weight = edge / std::max(distance, 1 + edge * 1e-3);
      const double shift = dot(end, along) / (edge * edge);
      for (std::size_t i = 0; i < 3; ++i) {
        for (std::size_t j = 0; j < 3; ++j)
          rows[i][j] += weight * ((i == j ? 1 : 0) - along[i] * along[j] / (edge * edge));
        right[i] += weight * (end[i] - along[i] * shift);
      }
    }
    const Vector minor = cross(rows[1], rows[2]);
    const double determinant = dot(rows[0], minor);
    if (!(determinant > 0)) break;
    // The matrix is symmetric: its rows are its columns.
    p = {dot(right, minor) / determinant, dot(rows[0], cross(right, rows[2])) / determinant,
         dot(rows[0], cross(rows[1], right)) / determinant};
  }
  return p;
}

}  // namespace

bool ConeFinder::find_cone(Cone& cone) {
  const double area = area_around();
  most_debt_ = kMostDebt * area;
  if (is_inside_ && find_place(area, cone)) return true;
  look_around(point(vertex_), kMostSeen);
  const double gain = closure_.solve();
  if (!(gain > kLeastGain * area)) return false;
  collect(point(vertex_), gain, cone);
  return true;
}

/// Moves an inner vertex towards the place that is best for the tets around it.
bool ConeFinder::find_place(double area, Cone& cone) {
  const GridPoint old = point(vertex_);
  seen_.clear();
  const Vector wanted = best_place(old);
  if (!is_near(wanted)) return false;
  constexpr int kTries = 6;
  double share = 1;
  for (int i = 0; i < kTries; ++i, share /= 2) {
    GridPoint place = old;
    for (std::size_t k = 0; k < 3; ++k) place[k] += static_cast<std::int32_t>(std::lround(share * wanted[k]));
    if (place == old) break;
    double after = 0;
    for (const auto& [a, b] : edges_) after += triangle_area(place, point(a), point(b));
    // That is least at the place wanted, and convex: nearer to where the vertex is, the gain is smaller.
    if (!(area - after > kLeastGainOfMove * area)) break;
    const bool sees_all = std::all_of(around_.begin(), around_.end(), [&](Index t) {
      const auto& corners = mesh_.tets[t];
      const auto& face = kFaceCorners[corner_of(t, vertex_)];
      return tetfmt::orientation(point(corners[face[0]]), point(corners[face[1]]), point(corners[face[2]]),
                                 place) > 0;
    });
    if (!sees_all) continue;
    look_around(place, kMostSeen);
    const double gain = area - after + closure_.solve();
    collect(place, gain, cone);
    return true;
  }
  return false;
}

bool ConeFinder::find_new(Index t, const GridPoint& start, Cone& cone) {
  // Each round finds the best set for a place, then the best place for the set.
  constexpr int kRounds = 4;
  vertex_ = kNone;
  is_inside_ = true;
  GridPoint place = start;
  cone.gain = 0;
  for (int round = 0; round < kRounds && move_to(t, place); ++round) {
    around_.assign(1, t);
    double cost = 0;
    const auto& corners = mesh_.tets[t];
    for (std::size_t i = 0; i < 4; ++i)
      for (std::size_t j = i + 1; j < 4; ++j)
        cost += triangle_area(place, point(corners[i]), point(corners[j]));
    most_debt_ = cost;
    look_around(place, kMostSeenByNew);
    if (const double gain = closure_.solve() - cost; gain > std::max(cone.gain, kLeastGain * cost))
      collect(place, gain, cone);
    const Vector wanted = best_place(place);
    if (!is_near(wanted)) break;
    for (std::size_t k = 0; k < 3; ++k) place[k] += static_cast<std::int32_t>(std::lround(wanted[k]));
  }
  return cone.gain > 0;
}

/// Goes from tet t to the one that holds `place` strictly inside, through free faces. False if that fails.
bool ConeFinder::move_to(Index& t, const GridPoint& place) const {
  constexpr int kMostSteps = 100;
  for (int step = 0; step < kMostSteps; ++step) {
    const auto& corners = mesh_.tets[t];
    const auto is_beyond = [&](std::size_t k) {
      const auto& face = kFaceCorners[k];
      return tetfmt::orientation(point(corners[face[0]]), point(corners[face[1]]), point(corners[face[2]]),
                                 place) <= 0;
    };
    std::size_t k = 0;
    while (k < 4 && !is_beyond(k)) ++k;
    if (k == 4) return true;
    if (!is_free(t, k)) return false;
    t = mesh_.neighbors[t][k];
  }
  return false;
}

/// Whether the best set that was found last holds tet t.
bool ConeFinder::is_in_cone(Index t) {
  const int* known = known_.find(t);
  if (known == nullptr || *known == kRefused) return false;
  return *known == kAround || (!seen_.empty() && closure_.taken(static_cast<std::size_t>(*known)));
}

/// Where the point would be best for the set that was found last (or, while seen_ is empty, for the tets
/// around the vertex), as seen from where it is.
Vector ConeFinder::best_place(const GridPoint& near) {
  edges_.clear();
  lines_.clear();
  const auto add_hull_of = [&](Index t) {
    const auto& corners = mesh_.tets[t];
    const bool at_vertex = std::find(corners.begin(), corners.end(), vertex_) != corners.end();
    for (std::size_t k = 0; k < 4; ++k) {
      if (at_vertex && corners[k] != vertex_) continue;
      if (is_free(t, k) && is_in_cone(mesh_.neighbors[t][k])) continue;
      for (const std::size_t i : {0, 1, 2}) {
        const Index a = corners[kFaceCorners[k][i]], b = corners[kFaceCorners[k][(i + 1) % 3]];
        if (a > b) continue;  // the face beyond that edge has it, too
        edges_.push_back({a, b});
        lines_.push_back({from(near, point(a)), from(point(a), point(b))});
      }
    }
  };
  for (const Index t : around_) add_hull_of(t);
  for (std::size_t i = 0; i < seen_.size(); ++i)
    if (closure_.taken(i)) add_hull_of(seen_[i].tet);
  return least_area(lines_, {});
}

/// Area of the free faces at the vertex.
double ConeFinder::area_around() const {
  double twice = 0;
  for (const Index t : around_) {
    const auto& corners = mesh_.tets[t];
    for (std::size_t k = 0; k < 4; ++k) {
      if (corners[k] == vertex_ || !is_free(t, k)) continue;
      const auto& face = kFaceCorners[k];
      twice += triangle_area(point(corners[face[0]]), point(corners[face[1]]), point(corners[face[2]]));
    }
  }
  return twice / 2;
}

/// Fills seen_ and closure_ with the tets that p sees across those around the vertex, which p may be in
/// place of, the nearest first.
void ConeFinder::look_around(const GridPoint& p, std::size_t most_seen) {
  known_.clear();
  for (const Index t : around_) known_.put(t, kAround);
  seen_.clear();
  closure_.clear();
  for (const Index t : around_)
    for (std::size_t k = 0; k < 4; ++k)
      if ((vertex_ == kNone || mesh_.tets[t][k] == vertex_) && is_free(t, k))
        look_at(mesh_.neighbors[t][k], p);
  for (std::size_t i = 0; i < seen_.size() && seen_.size() < most_seen; ++i) {
    const auto [t, turned, debt] = seen_[i];
    if (debt > most_debt_) continue;
    for (std::size_t k = 0; k < 4; ++k)
      if (!turned[k] && is_free(t, k)) look_at(mesh_.neighbors[t][k], p);
  }
}

/// Adds tet t, if p can see it in full and what is in front of it has been added.
void ConeFinder::look_at(Index t, const GridPoint& p) {
  if (known_.find(t) != nullptr) return;
  const auto refuse = [&] { known_.put(t, kRefused); };
  const auto& corners = mesh_.tets[t];
  if (std::find(corners.begin(), corners.end(), vertex_) != corners.end()) return refuse();
  std::array<Vector, 4> to{};
  for (std::size_t k = 0; k < 4; ++k) to[k] = from(p, point(corners[k]));
  // Of the edges: twice the triangle's area to p, as a vector.
  static constexpr std::array<std::array<std::size_t, 2>, 6> kEdges{
      {{0, 1}, {0, 2}, {0, 3}, {1, 2}, {1, 3}, {2, 3}}};
  std::array<Vector, 6> normal{};
  for (std::size_t e = 0; e < 6; ++e) normal[e] = cross(to[kEdges[e][0]], to[kEdges[e][1]]);
  // Six times the volume of p's tet on each face: above 0 where the face is turned to p. Differences are of
  // 24 bits, so the normals are exact, and what follows is less than 2^25 off.
  constexpr double kSure = 0x1p25;
  const std::array<double, 4> volume{-dot(normal[5], to[1]), dot(normal[5], to[0]), -dot(normal[0], to[3]),
                                     dot(normal[0], to[2])};
  Seen seen{t, {}, 0};
  std::array<int, Closure::kMostRequired> required{};
  std::size_t required_count = 0;
  for (std::size_t k = 0; k < 4; ++k) {
    if (std::abs(volume[k]) > kSure) {
      seen.turned[k] = volume[k] > 0;
    } else {
      const auto& face = kFaceCorners[k];
      const int sign =
          tetfmt::orientation(point(corners[face[0]]), point(corners[face[1]]), point(corners[face[2]]), p);
      if (sign == 0) return refuse();
      seen.turned[k] = sign < 0;
    }
    if (!seen.turned[k]) continue;
    if (!is_free(t, k)) return refuse();
    const int* in_front = known_.find(mesh_.neighbors[t][k]);
    if (in_front == nullptr) return;  // it may still come, and this one then comes up again
    if (*in_front == kRefused) return refuse();
    if (*in_front == kAround) continue;
    if (required_count == Closure::kMostRequired) return refuse();
    required[required_count++] = *in_front;
  }
  double worth = 0;
  for (std::size_t k = 0; k < 4; ++k) {
    if (!seen.turned[k]) continue;
    const auto& face = kFaceCorners[k];
    worth += triangle_area(point(corners[face[0]]), point(corners[face[1]]), point(corners[face[2]]));
  }
  for (std::size_t e = 0; e < 6; ++e) {
    // The faces at an edge are those opposite the corners of the opposite edge.
    const auto& [i, j] = kEdges[5 - e];
    if (seen.turned[i] != seen.turned[j]) continue;
    const double area = length(normal[e]) / 2;
    worth += seen.turned[i] ? area : -area;
  }
  for (std::size_t i = 0; i < required_count; ++i)
    seen.debt += seen_[static_cast<std::size_t>(required[i])].debt;
  seen.debt = std::max(0.0, seen.debt - worth);
  known_.put(t, static_cast<int>(seen_.size()));
  seen_.push_back(seen);
  closure_.add(worth, required, required_count);
}

void ConeFinder::collect(const GridPoint& place, double gain, Cone& cone) const {
  cone.tets = around_;
  for (std::size_t i = 0; i < seen_.size(); ++i)
    if (closure_.taken(i)) cone.tets.push_back(seen_[i].tet);
  cone.apex = vertex_;
  cone.place = place;
  cone.gain = gain;
}

}  // namespace tetprep
