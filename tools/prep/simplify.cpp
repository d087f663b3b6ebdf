// SPDX-License-Identifier: AGPL-3.0-or-later
#include "prep/simplify.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <numeric>
#include <tuple>

#include "common/parse.hpp"
#include "prep/connected.hpp"
#include "prep/decimate.hpp"
#include "prep/deviation.hpp"

namespace tetprep {
namespace {

using Corners = std::array<Index, 3>;

/// Of each of `count` things the number of the first one that is equal. `compare(a, b)`: negative, 0 or
/// positive.
template <class Compare>
std::vector<Index> first_equal(std::size_t count, Compare compare) {
  std::vector<Index> sorted(count), first(count);
  std::iota(sorted.begin(), sorted.end(), Index{0});
  std::sort(sorted.begin(), sorted.end(), [&](Index a, Index b) {
    const int order = compare(a, b);
    return order != 0 ? order < 0 : a < b;
  });
  for (std::size_t i = 0; i < count; ++i)
    first[sorted[i]] = i > 0 && compare(sorted[i - 1], sorted[i]) == 0 ? first[sorted[i - 1]] : sorted[i];
  return first;
}

/// Points at one place are one: STL files, for one, repeat them in every triangle.
std::vector<Index> places(const std::vector<Point>& points) {
  return first_equal(points.size(), [&](Index a, Index b) {
    return points[a] < points[b] ? -1 : points[b] < points[a] ? 1 : 0;
  });
}

/// Surface points with the same values (bit by bit: NaN stands for "none").
std::vector<Index> values(const Appearance& look) {
  const auto bitwise = [](const auto& array, Index a, Index b) {
    return array.empty() ? 0 : std::memcmp(&array[a], &array[b], sizeof array[a]);
  };
  return first_equal(look.surface_points, [&](Index a, Index b) {
    int order = bitwise(look.normals, a, b);
    if (order == 0) order = bitwise(look.texcoords, a, b);
    if (order == 0) order = bitwise(look.colors, a, b);
    for (auto p = look.properties.begin(); order == 0 && p != look.properties.end(); ++p)
      order = bitwise(p->values, a, b);
    return order;
  });
}

/// An edge of a triangle, from its corner `slot` to the next.
struct Edge {
  Index low, high;  ///< places
  Index triangle;
  std::uint8_t slot;
  bool upward;  ///< from low to high
};

std::vector<Edge> sorted_edges(const std::vector<Corners>& triangles) {
  std::vector<Edge> edges;
  edges.reserve(3 * triangles.size());
  for (Index t = 0; t < triangles.size(); ++t) {
    for (std::uint8_t k = 0; k < 3; ++k) {
      const Index a = triangles[t][k], b = triangles[t][(k + 1) % 3];
      edges.push_back({std::min(a, b), std::max(a, b), t, k, a < b});
    }
  }
  std::sort(edges.begin(), edges.end(), [](const Edge& a, const Edge& b) {
    return std::tie(a.low, a.high, a.triangle, a.slot) < std::tie(b.low, b.high, b.triangle, b.slot);
  });
  return edges;
}

/// Calls use(first, end) for the edges that lie at each place.
template <class Use>
void for_each_place(const std::vector<Edge>& edges, Use use) {
  for (std::size_t first = 0, end = 0; first < edges.size(); first = end) {
    while (end < edges.size() && edges[end].low == edges[first].low && edges[end].high == edges[first].high)
      ++end;
    use(first, end);
  }
}

/// The part of a soup that OpenMesh can be given, which damages everything else without a word.
struct Part {
  ManifoldSurface surface;
  std::vector<Index> triangle;  ///< the soup's number of each
  std::vector<Index> point;     ///< a point of the soup that is where each vertex is
};

Part manifold_part(const TriangleSoup& soup) {
  const Appearance& look = soup.appearance;
  const std::vector<Index> place = places(soup.points);
  std::vector<Corners> triangles = soup.triangles;
  for (Corners& triangle : triangles)
    for (Index& corner : triangle) corner = place[corner];
  const std::vector<Edge> edges = sorted_edges(triangles);

  std::vector<bool> withheld(triangles.size());
  for_each_place(edges, [&](std::size_t first, std::size_t end) {
    const bool good =
        edges[first].low != edges[first].high &&
        (end - first == 1 || (end - first == 2 && edges[first].upward != edges[first + 1].upward));
    for (std::size_t i = first; !good && i < end; ++i) withheld[edges[i].triangle] = true;
  });

  // A vertex of the part is one fan of triangles: corners connected by the edges between them. Where several
  // fans meet at a place, or triangles that were withheld, it has to stay.
  DisjointSets fans(3 * triangles.size());
  const auto corner = [](const Edge& edge, std::size_t after) {
    return static_cast<Index>(3 * edge.triangle + (edge.slot + after) % 3);
  };
  const auto attribute_of = [](const std::vector<Index>& of, Index t) { return of.empty() ? 0 : of[t]; };
  std::vector<bool> locked_place(soup.points.size());
  for_each_place(edges, [&](std::size_t first, std::size_t end) {
    if (end - first != 2 || withheld[edges[first].triangle] || withheld[edges[first + 1].triangle]) {
      locked_place[edges[first].low] = locked_place[edges[first].high] = true;
      return;
    }
    const Edge &a = edges[first], &b = edges[first + 1];  // in opposite directions
    fans.unite(corner(a, 0), corner(b, 1));
    fans.unite(corner(a, 1), corner(b, 0));
    for (const auto* of : {&look.triangle_material, &look.triangle_object})
      if (attribute_of(*of, a.triangle) != attribute_of(*of, b.triangle))
        locked_place[a.low] = locked_place[a.high] = true;
  });

  Part part;
  const std::vector<Index> value = values(look);
  std::vector<Index> vertex(3 * triangles.size(), kNone);  // of each fan
  std::vector<bool> occupied(soup.points.size());
  for (Index t = 0; t < triangles.size(); ++t) {
    if (withheld[t]) continue;
    Corners corners{}, marks{};
    for (std::size_t k = 0; k < 3; ++k) {
      Index& v = vertex[fans.find(static_cast<Index>(3 * t + k))];
      if (v == kNone) {
        v = static_cast<Index>(part.point.size());
        part.point.push_back(triangles[t][k]);
        if (occupied[triangles[t][k]]) locked_place[triangles[t][k]] = true;
        occupied[triangles[t][k]] = true;
      }
      corners[k] = v;
      const Index surface_point = look.corners.empty() ? kNone : look.corners[t][k];
      marks[k] = surface_point == kNone ? kNone : value[surface_point];
    }
    part.triangle.push_back(t);
    part.surface.triangles.push_back(corners);
    part.surface.marks.push_back(marks);
  }
  for (const Index point : part.point) {
    part.surface.locked.push_back(locked_place[point]);
    part.surface.vertices.push_back(soup.points[point]);
  }
  return part;
}

/// Small numbers around 0, so that squares and quadrics keep their digits. Returns the scale.
double normalize(std::vector<Point>& points) {
  if (points.empty()) return 1;
  Point low = points.front(), high = low;
  for (const Point& p : points) {
    for (std::size_t k = 0; k < 3; ++k) {
      low[k] = std::min(low[k], p[k]);
      high[k] = std::max(high[k], p[k]);
    }
  }
  double extent = 0;
  for (std::size_t k = 0; k < 3; ++k) extent = std::max(extent, high[k] - low[k]);
  if (!(extent > 0) || !std::isfinite(extent)) return 1;
  const double scale = std::ldexp(1.0, -std::ilogb(extent));
  for (Point& p : points)
    for (std::size_t k = 0; k < 3; ++k) p[k] = (p[k] - low[k]) * scale;
  return scale;
}

std::array<Point, 3> corners_of(const TriangleSoup& soup, std::size_t t) {
  const auto& [a, b, c] = soup.triangles[t];
  return {soup.points[a], soup.points[b], soup.points[c]};
}

Triangles corners_of(const TriangleSoup& soup, const std::vector<bool>& wanted) {
  Triangles result;
  for (std::size_t t = 0; t < soup.triangles.size(); ++t)
    if (wanted[t]) result.push_back(corners_of(soup, t));
  return result;
}

double mean_edge(const TriangleSoup& soup) {
  double sum = 0;
  for (const Corners& triangle : soup.triangles) {
    for (std::size_t i = 0; i < 3; ++i) {
      const Point &a = soup.points[triangle[i]], &b = soup.points[triangle[(i + 1) % 3]];
      sum += std::hypot(b[0] - a[0], b[1] - a[1], b[2] - a[2]);
    }
  }
  return sum / (3 * static_cast<double>(soup.triangles.size()));
}

/// What the decimater did, in terms of the soup.
struct Outcome {
  TriangleSoup soup;           ///< all triangles, those too that have gone
  std::vector<bool> kept;      ///< of the soup's triangles, those that have not
  std::vector<Index> changed;  ///< triangles of the part that are not as they were
  std::vector<Index> remade;   ///< those of them that are still there
};

Outcome apply(const TriangleSoup& soup, const Part& part, const ManifoldSurface& made) {
  Outcome outcome{soup, std::vector<bool>(soup.triangles.size(), true), {}, {}};
  for (Index i = 0; i < part.triangle.size(); ++i) {
    const Corners &old_corners = part.surface.triangles[i], &new_corners = made.triangles[i];
    if (new_corners == old_corners) continue;
    const Index t = part.triangle[i];
    outcome.changed.push_back(i);
    outcome.kept[t] = new_corners[0] != kNone;
    if (!outcome.kept[t]) continue;
    outcome.remade.push_back(i);
    for (std::size_t k = 0; k < 3; ++k) {
      if (new_corners[k] == old_corners[k]) continue;
      outcome.soup.triangles[t][k] = part.point[new_corners[k]];
      if (!soup.appearance.corners.empty()) outcome.soup.appearance.corners[t][k] = made.marks[i][k];
    }
  }
  return outcome;
}

/// Leaves out what `used` does not have; returns the new numbers.
template <class T>
void keep_used(std::vector<T>& array, const std::vector<bool>& used) {
  if (array.empty()) return;
  std::size_t count = 0;
  for (std::size_t i = 0; i < array.size(); ++i)
    if (used[i]) array[count++] = array[i];
  array.resize(count);
}

/// Renumbers the rows of `corners` without gaps; returns which numbers they had.
std::vector<bool> close_gaps(std::vector<Corners>& corners, std::size_t count) {
  std::vector<bool> used(count);
  for (const Corners& row : corners)
    for (const Index c : row)
      if (c != kNone) used[c] = true;
  std::vector<Index> number(count);
  Index next = 0;
  for (std::size_t i = 0; i < count; ++i)
    if (used[i]) number[i] = next++;
  for (Corners& row : corners)
    for (Index& c : row)
      if (c != kNone) c = number[c];
  return used;
}

void drop_unused(TriangleSoup& soup, const std::vector<bool>& kept_triangle) {
  Appearance& look = soup.appearance;
  keep_used(soup.triangles, kept_triangle);
  keep_used(look.triangle_material, kept_triangle);
  keep_used(look.triangle_object, kept_triangle);
  keep_used(look.corners, kept_triangle);
  keep_used(soup.points, close_gaps(soup.triangles, soup.points.size()));
  if (look.corners.empty()) return;
  const std::vector<bool> used = close_gaps(look.corners, look.surface_points);
  look.surface_points = static_cast<std::size_t>(std::count(used.begin(), used.end(), true));
  keep_used(look.normals, used);
  keep_used(look.texcoords, used);
  keep_used(look.colors, used);
  for (PointProperty& property : look.properties) keep_used(property.values, used);
}

}  // namespace

TriangleSoup simplify(TriangleSoup soup, double error, Progress& progress, SimplifyReport& report) {
  if (!(error > 0) || !std::isfinite(error))
    throw Failure(ExitCode::usage, "--simplify: the error must be above 0, not " + number(error));
  const Part part = manifold_part(soup);
  report = {};
  report.triangles_before = report.triangles_after = soup.triangles.size();
  report.skipped_triangles = soup.triangles.size() - part.triangle.size();

  ManifoldSurface normal = part.surface;
  const double scale = normalize(normal.vertices);
  const double spacing = 2 * mean_edge(soup);
  const Triangles before = corners_of(soup, std::vector<bool>(soup.triangles.size(), true));
  // The decimater looks at a few points of what it changes, and only at what is around. It is the measure
  // that counts: where that finds too much, the decimater has to be stricter the next time.
  normal.tolerance.assign(normal.vertices.size(), error * scale);
  constexpr int kAttempts = 16, kPatience = 6;
  for (int attempt = 0; attempt < kAttempts; ++attempt) {
    ManifoldSurface made = normal;
    const std::vector<Index> destination = decimate(made, spacing * scale, progress);
    const Outcome outcome = apply(soup, part, made);
    if (outcome.changed.empty()) break;

    Triangles changed, remade;  // of these, the given shape, and (if they are still there) the new one
    for (const Index i : outcome.changed) changed.push_back(before[part.triangle[i]]);
    for (const Index i : outcome.remade) remade.push_back(corners_of(outcome.soup, part.triangle[i]));
    const std::vector<double> there = deviations(changed, corners_of(outcome.soup, outcome.kept), spacing);
    const std::vector<double> back = deviations(remade, before, spacing);
    double measured = 0;
    for (const auto* list : {&there, &back})
      for (const double d : *list) measured = std::max(measured, d);
    if (measured <= error) {
      report.max_deviation = measured;
      soup = outcome.soup;
      drop_unused(soup, outcome.kept);
      report.triangles_after = soup.triangles.size();
      break;
    }

    std::vector<bool> suspect(normal.vertices.size());  // vertices of the result whose surroundings are wrong
    for (std::size_t i = 0; i < there.size(); ++i)
      for (const Index v : part.surface.triangles[outcome.changed[i]])
        if (there[i] > error) suspect[destination[v]] = true;
    for (std::size_t i = 0; i < back.size(); ++i)
      for (const Index v : made.triangles[outcome.remade[i]])
        if (back[i] > error) suspect[v] = true;
    for (std::size_t v = 0; v < destination.size(); ++v)
      if (suspect[destination[v]] || attempt >= kPatience) normal.tolerance[v] *= 0.6;
  }
  return soup;
}

}  // namespace tetprep
