// SPDX-License-Identifier: AGPL-3.0-or-later
// The order in which things are stored. Rays touch tets that lie near each other, so tets and vertices follow
// Hilbert curves; everything else follows the tets.
#include <tbb/parallel_for.h>
#include <tbb/parallel_sort.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "prep/box.hpp"
#include "prep/hilbert.hpp"
#include "prep/prep.hpp"

namespace tetprep {
namespace {

/// Positions 0 to count - 1, sorted by `key`; equal keys by position, so that the result is always the same.
template <class Key>
std::vector<Index> sorted_by(std::size_t count, Key key) {
  std::vector<std::pair<std::uint64_t, Index>> keyed(count);
  tbb::parallel_for(std::size_t{0}, count, [&](std::size_t i) {
    keyed[i] = {key(i), static_cast<Index>(i)};
  });
  tbb::parallel_sort(keyed.begin(), keyed.end());
  std::vector<Index> sorted(count);
  for (std::size_t i = 0; i < count; ++i) sorted[i] = keyed[i].second;
  return sorted;
}

std::vector<Index> inverse(const std::vector<Index>& permutation) {
  std::vector<Index> result(permutation.size());
  for (Index i = 0; i < permutation.size(); ++i) result[permutation[i]] = i;
  return result;
}

/// Scales the box's points to the curve's range.
class Curve {
 public:
  explicit Curve(const Box& box) : low_(box.low) {
    for (std::size_t k = 0; k < 3; ++k)
      while (std::int64_t{box.high[k] - box.low[k]} >> shift_ >= std::int64_t{1} << kHilbertBits) ++shift_;
  }
  std::uint64_t position(const GridPoint& p) const {
    std::array<std::uint32_t, 3> x{};
    for (std::size_t k = 0; k < 3; ++k) x[k] = static_cast<std::uint32_t>(p[k] - low_[k]) >> shift_;
    return hilbert_position(x);
  }

 private:
  GridPoint low_;
  int shift_ = 0;
};

/// Inside or on the boundary of the tet.
bool contains(const std::vector<GridPoint>& points, std::array<Index, 4> tet, const GridPoint& p) {
  const auto sign = [&] {
    return tetfmt::orientation(points[tet[0]], points[tet[1]], points[tet[2]], points[tet[3]]);
  };
  for (std::size_t k = 0; k < 3; ++k) {  // most tets are far away
    const auto [low, high] =
        std::minmax({points[tet[0]][k], points[tet[1]][k], points[tet[2]][k], points[tet[3]][k]});
    if (p[k] < low || p[k] > high) return false;
  }
  const int whole = sign();
  const auto side = [&](const GridPoint& a, const GridPoint& b, const GridPoint& c, const GridPoint& d) {
    return tetfmt::orientation(a, b, c, d) * whole >= 0;
  };
  const GridPoint &a = points[tet[0]], &b = points[tet[1]], &c = points[tet[2]], &d = points[tet[3]];
  return side(p, b, c, d) && side(a, p, c, d) && side(a, b, p, d) && side(a, b, c, p);
}

}  // namespace

void sort_tets(TetMesh& mesh) {
  const Box box = box_around(mesh.points);
  const Curve curve(box);
  const std::vector<Index> tet_order = sorted_by(mesh.tets.size(), [&](std::size_t t) {
    GridPoint middle{};
    for (std::size_t k = 0; k < 3; ++k) {
      std::int64_t sum = 0;
      for (const Index v : mesh.tets[t]) sum += mesh.points[v][k] - box.low[k];
      middle[k] = box.low[k] + static_cast<std::int32_t>(sum / 4);
    }
    return curve.position(middle);
  });
  const auto permuted = [&](const std::vector<std::array<Index, 4>>& from) {
    std::vector<std::array<Index, 4>> to(from.size());
    tbb::parallel_for(std::size_t{0}, to.size(), [&](std::size_t i) { to[i] = from[tet_order[i]]; });
    return to;
  };
  mesh.tets = permuted(mesh.tets);
  mesh.face_triangle = permuted(mesh.face_triangle);
  mesh.neighbors = permuted(mesh.neighbors);
  const std::vector<Index> new_tet = inverse(tet_order);
  tbb::parallel_for(std::size_t{0}, mesh.neighbors.size(), [&](std::size_t t) {
    for (Index& neighbor : mesh.neighbors[t])
      if (neighbor != kNone) neighbor = new_tet[neighbor];
  });
}

tetfmt::Mesh order(const TetMesh& mesh, const CleanSurface& surface) {
  const Box box = box_around(surface.points);
  const Curve curve(box);
  const std::vector<Index> vertex_order =
      sorted_by(mesh.points.size(), [&](std::size_t i) { return curve.position(mesh.points[i]); });
  const std::vector<Index> new_vertex = inverse(vertex_order);

  tetfmt::Mesh out;
  out.origin = mesh.origin;
  out.vertices.resize(mesh.points.size());
  for (std::size_t i = 0; i < vertex_order.size(); ++i) {
    const auto local = [&](std::size_t k) {
      return std::ldexp(static_cast<float>(mesh.points[vertex_order[i]][k]), mesh.grid_exponent);
    };
    out.vertices[i] = {local(0), local(1), local(2)};
  }
  out.triangles.resize(surface.input_triangle_count);
  for (std::size_t t = 0; t < surface.triangles.size(); ++t)
    for (std::size_t k = 0; k < 3; ++k)
      out.triangles[surface.input_triangle[t]].vertices[k] = new_vertex[surface.triangles[t][k]];

  // Side 2k of a face belongs to the tet where the triangle's normal points. Faces are numbered as the tets
  // come, so their sides are near each other in the file when the tets are.
  std::vector<Index> face_number(surface.triangles.size(), kNone);
  Index faces = 0;
  out.sides.resize(2 * surface.triangles.size());
  out.tets.resize(mesh.tets.size());
  for (std::size_t t = 0; t < mesh.tets.size(); ++t) {
    const auto& corners = mesh.tets[t];
    std::array<std::size_t, 4> slots{0, 1, 2, 3};
    std::sort(slots.begin(), slots.end(),
              [&](std::size_t a, std::size_t b) { return new_vertex[corners[a]] < new_vertex[corners[b]]; });
    tetfmt::FullTet& tet = out.tets[t];
    for (std::size_t k = 0; k < 4; ++k) {
      const std::size_t slot = slots[k];
      tet.vertices[k] = new_vertex[corners[slot]];
      const Index triangle = mesh.face_triangle[t][slot];
      if (triangle == kNone) {
        const Index beyond = mesh.neighbors[t][slot];
        tet.neighbors[k] = beyond == kNone ? tetfmt::kHull : beyond;
        continue;
      }
      if (face_number[triangle] == kNone) face_number[triangle] = faces++;
      const auto& [a, b, c] = surface.triangles[triangle];
      const bool front =
          tetfmt::orientation(mesh.points[a], mesh.points[b], mesh.points[c], mesh.points[corners[slot]]) > 0;
      const Index side = 2 * face_number[triangle] + (front ? 0 : 1);
      out.sides[side] = {static_cast<Index>(t), surface.input_triangle[triangle], 0};
      tet.neighbors[k] = tetfmt::side_ref(side);
    }
  }

  const GridPoint centre = box.centre();
  for (Index t = 0; t < mesh.tets.size(); ++t) {
    if (!contains(mesh.points, mesh.tets[t], centre)) continue;
    out.sources = {t};
    break;
  }
  return out;
}

}  // namespace tetprep
