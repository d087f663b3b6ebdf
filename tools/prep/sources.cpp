// SPDX-License-Identifier: AGPL-3.0-or-later
#include "prep/sources.hpp"

#include <CGAL/Simple_cartesian.h>
#include <CGAL/squared_distance_3.h>
#include <tbb/blocked_range.h>
#include <tbb/parallel_reduce.h>

#include <algorithm>
#include <limits>
#include <utility>

#include "prep/box.hpp"
#include "prep/connected.hpp"

namespace tetprep {
namespace {

/// Inside or on the boundary of the tet.
bool contains(const TetMesh& mesh, std::size_t t, const GridPoint& p) {
  const auto& tet = mesh.tets[t];
  const GridPoint &a = mesh.points[tet[0]], &b = mesh.points[tet[1]], &c = mesh.points[tet[2]],
                  &d = mesh.points[tet[3]];
  for (std::size_t k = 0; k < 3; ++k) {  // most tets are far away
    const auto [low, high] = std::minmax({a[k], b[k], c[k], d[k]});
    if (p[k] < low || p[k] > high) return false;
  }
  const int whole = tetfmt::orientation(a, b, c, d);
  const auto inside = [&](const GridPoint& e, const GridPoint& f, const GridPoint& g, const GridPoint& h) {
    return tetfmt::orientation(e, f, g, h) * whole >= 0;
  };
  return inside(p, b, c, d) && inside(a, p, c, d) && inside(a, b, p, d) && inside(a, b, c, p);
}

/// The smallest result of `value(t)` over all tets.
template <class T, class Value>
T least(const TetMesh& mesh, T none, Value value) {
  return tbb::parallel_reduce(
      tbb::blocked_range<std::size_t>(0, mesh.tets.size()), none,
      [&](const tbb::blocked_range<std::size_t>& range, T result) {
        for (std::size_t t = range.begin(); t < range.end(); ++t) result = std::min(result, value(t));
        return result;
      },
      [](const T& a, const T& b) { return std::min(a, b); });
}

/// The tet nearest to a point that none contains: its nearest point is on a face at which the mesh ends.
Index nearest_tet(const TetMesh& mesh, const GridPoint& p) {
  using Kernel = CGAL::Simple_cartesian<double>;
  const auto place = [](const GridPoint& q) { return Kernel::Point_3(q[0], q[1], q[2]); };
  using Candidate = std::pair<double, Index>;  // squared distance and tet: ties go to the first
  const Candidate none{std::numeric_limits<double>::infinity(), kNone};
  return least(mesh, none,
               [&](std::size_t t) {
                 Candidate best = none;
                 for (std::size_t k = 0; k < 4; ++k) {
                   if (mesh.neighbors[t][k] != kNone) continue;
                   const auto corner = [&](std::size_t i) {
                     return place(mesh.points[mesh.tets[t][(k + i) % 4]]);
                   };
                   const Kernel::Triangle_3 face(corner(1), corner(2), corner(3));
                   best = std::min(best, {CGAL::squared_distance(place(p), face), static_cast<Index>(t)});
                 }
                 return best;
               })
      .second;
}

bool is_partial(const TetMesh& mesh) {
  return least(mesh, true, [&](std::size_t t) {
           for (std::size_t k = 0; k < 4; ++k)
             if (mesh.neighbors[t][k] == kNone && mesh.face_triangle[t][k] != kNone) return false;
           return true;
         }) == false;
}

}  // namespace

std::vector<Index> choose_sources(const TetMesh& mesh) {
  const GridPoint centre = bounds_of(mesh.points).centre();
  Index main = least(
      mesh, kNone, [&](std::size_t t) { return contains(mesh, t, centre) ? static_cast<Index>(t) : kNone; });
  if (main == kNone) main = nearest_tet(mesh, centre);
  std::vector<Index> sources{main};
  if (!is_partial(mesh)) return sources;  // the whole box is in one piece

  DisjointSets sets(mesh.tets.size());
  tbb::parallel_for(std::size_t{0}, mesh.tets.size(), [&](std::size_t t) {
    for (const Index beyond : mesh.neighbors[t])
      if (beyond < t) sets.unite(static_cast<Index>(t), beyond);
  });
  const Index reached = sets.find(main);
  for (Index t = 0; t < mesh.tets.size(); ++t)
    if (sets.find(t) == t && t != reached) sources.push_back(t);
  return sources;
}

}  // namespace tetprep
