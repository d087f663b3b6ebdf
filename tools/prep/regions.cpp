// SPDX-License-Identifier: AGPL-3.0-or-later
#include "prep/regions.hpp"

#include <CGAL/Exact_rational.h>
#include <tbb/blocked_range.h>
#include <tbb/parallel_reduce.h>

#include <algorithm>
#include <cmath>
#include <cstring>

#include "prep/connected.hpp"
#include "prep/take_tets.hpp"

namespace tetprep {
namespace {

using Exact = CGAL::Exact_rational;
using ExactPoint = std::array<Exact, 3>;

__extension__ using Wide = unsigned __int128;

/// Six times the signed volume that the point makes with a triangle, exactly: positive where
/// tetfmt::orientation(corners, point) is negative.
template <class Number, class P>
Number determinant(const std::array<const GridPoint*, 3>& corners, const P& point) {
  std::array<std::array<Number, 3>, 3> d;
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t k = 0; k < 3; ++k) d[i][k] = Number((*corners[i])[k]) - Number(point[k]);
  return d[0][0] * (d[1][1] * d[2][2] - d[1][2] * d[2][1]) +
         d[0][1] * (d[1][2] * d[2][0] - d[1][0] * d[2][2]) +
         d[0][2] * (d[1][0] * d[2][1] - d[1][1] * d[2][0]);
}

/// Inside or on the boundary of tet `t`: not beyond any face, seen from the vertex opposite.
bool touches(const TetMesh& mesh, std::size_t t, const ExactPoint& point) {
  for (std::size_t k = 0; k < 4; ++k) {
    std::array<const GridPoint*, 3> face{};
    for (std::size_t i = 0, n = 0; i < 4; ++i)
      if (i != k) face[n++] = &mesh.points[mesh.tets[t][i]];
    const bool vertex_above =
        tetfmt::orientation(*face[0], *face[1], *face[2], mesh.points[mesh.tets[t][k]]) > 0;
    const Exact below = determinant<Exact>(face, point);
    if (vertex_above ? below > 0 : below < 0) return false;
  }
  return true;
}

/// The double nearest to sum / 6.
double sixth(Wide sum) {
  if (sum == 0) return 0;
  int shift = 0;
  for (; sum >> 125 == 0; ++shift) sum <<= 1;
  // At least 123 bits, of which a double keeps 53: the last one is free to tell an exact tie from a near one.
  Wide quotient = sum / 6;
  if (sum % 6 != 0) quotient |= 1;
  return std::ldexp(static_cast<double>(quotient), -shift);
}

/// Six times the volume of a tet, in cubes of the grid's step.
Wide sextuple_volume(const TetMesh& mesh, std::size_t t) {
  __extension__ using Signed = __int128;
  const auto& [a, b, c, d] = mesh.tets[t];
  const Signed det =
      determinant<Signed>(std::array{&mesh.points[a], &mesh.points[b], &mesh.points[c]}, mesh.points[d]);
  return static_cast<Wide>(det < 0 ? -det : det);
}

}  // namespace

Index find_regions(TetMesh& mesh) {
  const std::size_t count = mesh.tets.size();
  DisjointSets sets(count);
  tbb::parallel_for(std::size_t{0}, count, [&](std::size_t t) {
    for (std::size_t k = 0; k < 4; ++k) {
      const Index beyond = mesh.neighbors[t][k];
      if (beyond < t && mesh.face_triangle[t][k] == kNone) sets.unite(static_cast<Index>(t), beyond);
    }
  });
  mesh.region.resize(count);
  tbb::parallel_for(std::size_t{0}, count,
                    [&](std::size_t t) { mesh.region[t] = sets.find(static_cast<Index>(t)); });

  // From smallest tets to numbers. Every tet at the hull is in the region around everything: the surface
  // keeps away from the box.
  std::size_t outside = 0;
  while (outside < count && std::find(mesh.neighbors[outside].begin(), mesh.neighbors[outside].end(),
                                      kNone) == mesh.neighbors[outside].end())
    ++outside;
  std::vector<Index> number(count, kNone);
  number[mesh.region[outside]] = 0;
  Index regions = 1;
  for (std::size_t t = 0; t < count; ++t)
    if (mesh.region[t] == t && number[t] == kNone) number[t] = regions++;
  tbb::parallel_for(std::size_t{0}, count, [&](std::size_t t) { mesh.region[t] = number[mesh.region[t]]; });
  return regions;
}

Index region_at(const TetMesh& mesh, const Point& point) {
  ExactPoint exact;
  GridPoint low{}, high{};  // the cell of the grid that the point is in: a filter
  const Exact step = [&] {
    Exact power = 1;
    for (int i = 0; i < std::abs(mesh.grid_exponent); ++i) power *= 2;
    return mesh.grid_exponent < 0 ? Exact(1 / power) : power;
  }();
  for (std::size_t k = 0; k < 3; ++k) {
    if (!std::isfinite(point[k])) return kNone;
    exact[k] = (Exact(point[k]) - Exact(mesh.origin[k])) / step;
    if (exact[k] > kMaxCoordinate || exact[k] < -kMaxCoordinate) return kNone;
    const double near = CGAL::to_double(exact[k]);  // below 2^24 in size, so off by much less than a step
    low[k] = static_cast<std::int32_t>(std::floor(near)) - 1;
    high[k] = static_cast<std::int32_t>(std::ceil(near)) + 1;
  }
  const auto may_touch = [&](std::size_t t) {
    for (std::size_t k = 0; k < 3; ++k) {
      bool all_below = true, all_above = true;
      for (const Index v : mesh.tets[t]) {
        all_below &= mesh.points[v][k] < low[k];
        all_above &= mesh.points[v][k] > high[k];
      }
      if (all_below || all_above) return false;
    }
    return true;
  };
  return tbb::parallel_reduce(
      tbb::blocked_range<std::size_t>(0, mesh.tets.size()), kNone,
      [&](const tbb::blocked_range<std::size_t>& range, Index lowest) {
        for (std::size_t t = range.begin(); t < range.end(); ++t)
          if (mesh.region[t] < lowest && may_touch(t) && touches(mesh, t, exact)) lowest = mesh.region[t];
        return lowest;
      },
      [](Index a, Index b) { return std::min(a, b); });
}

void keep_regions(TetMesh& mesh, const std::vector<bool>& kept) {
  if (std::all_of(kept.begin(), kept.end(), [](bool k) { return k; })) return;
  std::vector<Index> chosen;
  for (std::size_t t = 0; t < mesh.tets.size(); ++t)
    if (kept[mesh.region[t]]) chosen.push_back(static_cast<Index>(t));
  take_tets(mesh, chosen);
}

void group_by_region(TetMesh& mesh) {
  if (std::is_sorted(mesh.region.begin(), mesh.region.end())) return;
  // Counting sort: where each region's run starts, then every tet to the next place of its run.
  std::vector<Index> next(*std::max_element(mesh.region.begin(), mesh.region.end()) + std::size_t{2}, 0);
  for (const Index region : mesh.region) ++next[region + 1];
  for (std::size_t i = 1; i < next.size(); ++i) next[i] += next[i - 1];
  std::vector<Index> grouped(mesh.tets.size());
  for (std::size_t t = 0; t < mesh.tets.size(); ++t) grouped[next[mesh.region[t]]++] = static_cast<Index>(t);
  take_tets(mesh, grouped);
}

tetfmt::OptionalSection region_section(const TetMesh& mesh) {
  std::vector<tetfmt::Region> regions;
  for (std::size_t first = 0, end = 0; first < mesh.tets.size(); first = end) {
    const Index id = mesh.region[first];
    while (end < mesh.tets.size() && mesh.region[end] == id) ++end;
    struct Extent {
      Wide volume = 0;
      GridPoint low{kMaxCoordinate, kMaxCoordinate, kMaxCoordinate};
      GridPoint high{-kMaxCoordinate, -kMaxCoordinate, -kMaxCoordinate};
      void add(const Extent& other) {
        volume += other.volume;
        for (std::size_t k = 0; k < 3; ++k) {
          low[k] = std::min(low[k], other.low[k]);
          high[k] = std::max(high[k], other.high[k]);
        }
      }
    };
    // Integers, so that it does not matter in which order threads add.
    const Extent whole = tbb::parallel_reduce(
        tbb::blocked_range<std::size_t>(first, end, 4096), Extent{},
        [&](const tbb::blocked_range<std::size_t>& range, Extent extent) {
          for (std::size_t t = range.begin(); t < range.end(); ++t) {
            extent.volume += sextuple_volume(mesh, t);
            for (const Index v : mesh.tets[t]) extent.add({0, mesh.points[v], mesh.points[v]});
          }
          return extent;
        },
        [](Extent a, const Extent& b) {
          a.add(b);
          return a;
        });
    const auto local = [&](const GridPoint& p) {
      const auto of = [&](std::size_t k) { return std::ldexp(static_cast<float>(p[k]), mesh.grid_exponent); };
      return tetfmt::Vec3f{of(0), of(1), of(2)};
    };
    tetfmt::Region& region = regions.emplace_back();
    region.first_tet = static_cast<Index>(first);
    region.tet_count = static_cast<Index>(end - first);
    region.id = id;
    region.volume = std::ldexp(sixth(whole.volume), 3 * mesh.grid_exponent);
    region.lower = local(whole.low);
    region.upper = local(whole.high);
  }
  tetfmt::OptionalSection section{tetfmt::kRegions, sizeof(tetfmt::Region), {}};
  const auto bytes = std::as_bytes(std::span(regions));
  section.bytes.assign(bytes.begin(), bytes.end());
  return section;
}

}  // namespace tetprep
