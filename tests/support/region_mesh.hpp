// SPDX-License-Identifier: AGPL-3.0-or-later
// Meshes with a region table, and with regions left out, made from whole ones.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstring>
#include <numeric>
#include <span>
#include <vector>

#include "tetfmt/mesh.hpp"

namespace tetfmt_test {

template <class T>
tetfmt::OptionalSection optional_section(tetfmt::SectionKind kind, std::uint32_t stride,
                                         const std::vector<T>& values) {
  const auto bytes = std::as_bytes(std::span<const T>(values));
  return {kind, stride, {bytes.begin(), bytes.end()}};
}

/// The region of each tet, numbered as they are met, the one at the hull first.
inline std::vector<tetfmt::Index> regions_of(const tetfmt::Mesh& mesh) {
  using tetfmt::Index;
  std::vector<Index> region(mesh.tets.size(), tetfmt::kNone);
  Index count = 0;
  const auto flood = [&](Index start) {
    std::vector<Index> stack{start};
    region[start] = count;
    while (!stack.empty()) {
      const Index t = stack.back();
      stack.pop_back();
      for (const tetfmt::Ref ref : mesh.tets[t].neighbors) {
        if (!tetfmt::is_tet(ref) || region[ref] != tetfmt::kNone) continue;
        region[ref] = count;
        stack.push_back(ref);
      }
    }
    ++count;
  };
  for (Index t = 0; t < mesh.tets.size() && count == 0; ++t) {
    const auto& n = mesh.tets[t].neighbors;
    if (std::find(n.begin(), n.end(), tetfmt::kHull) != n.end()) flood(t);
  }
  for (Index t = 0; t < mesh.tets.size(); ++t)
    if (region[t] == tetfmt::kNone) flood(t);
  return region;
}

/// The mesh with only the tets of some regions, grouped by region, with a REGN section, and one source a
/// region. Keeping all of them gives a whole mesh.
inline tetfmt::Mesh with_regions(const tetfmt::Mesh& whole, const std::vector<tetfmt::Index>& kept) {
  using tetfmt::Index;
  using tetfmt::kNone;
  const std::vector<Index> region = regions_of(whole);
  std::vector<Index> order;
  std::vector<tetfmt::Region> table;
  tetfmt::Mesh mesh = whole;
  mesh.sources.clear();
  for (const Index id : kept) {
    tetfmt::Region entry;
    entry.first_tet = static_cast<Index>(order.size());
    entry.id = id;
    for (Index t = 0; t < whole.tets.size(); ++t)
      if (region[t] == id) order.push_back(t);
    entry.tet_count = static_cast<Index>(order.size()) - entry.first_tet;
    mesh.sources.push_back(entry.first_tet + entry.tet_count / 2);
    table.push_back(entry);
  }
  std::vector<Index> new_tet(whole.tets.size(), kNone);
  for (Index i = 0; i < order.size(); ++i) new_tet[order[i]] = i;

  std::vector<Index> new_vertex(whole.vertices.size(), kNone);
  for (const Index t : order)
    for (const Index id : whole.tets[t].vertices) new_vertex[id] = 0;
  mesh.vertices.clear();
  for (Index id = 0; id < new_vertex.size(); ++id) {
    if (new_vertex[id] == kNone) continue;
    new_vertex[id] = static_cast<Index>(mesh.vertices.size());
    mesh.vertices.push_back(whole.vertices[id]);
  }

  mesh.tets.clear();
  for (const Index t : order) {
    tetfmt::FullTet tet = whole.tets[t];
    for (Index& id : tet.vertices) id = new_vertex[id];  // renumbering keeps the order
    for (tetfmt::Ref& ref : tet.neighbors)
      if (tetfmt::is_tet(ref)) ref = new_tet[ref];
    mesh.tets.push_back(tet);
  }
  for (tetfmt::Side& side : mesh.sides) side.tet = new_tet[side.tet];
  for (tetfmt::Triangle& triangle : mesh.triangles)
    if (!triangle.dropped())
      for (Index& id : triangle.vertices) id = new_vertex[id];

  const int exponent = tetfmt::grid_exponent(mesh.vertices);
  for (tetfmt::Region& entry : table) {
    long long sum = 0;  // small meshes only
    tetfmt::Bounds bounds;
    for (Index t = entry.first_tet; t < entry.first_tet + entry.tet_count; ++t) {
      long long p[4][3];
      for (std::size_t k = 0; k < 4; ++k) {
        const tetfmt::Vec3f& v = mesh.vertices[mesh.tets[t].vertices[k]];
        bounds.add(v);
        const float* x = &v.x;
        for (std::size_t i = 0; i < 3; ++i)
          p[k][i] = static_cast<long long>(std::ldexp(double{x[i]}, -exponent));
      }
      long long u[3][3];
      for (std::size_t k = 0; k < 3; ++k)
        for (std::size_t i = 0; i < 3; ++i) u[k][i] = p[k + 1][i] - p[0][i];
      sum += std::abs(u[0][0] * (u[1][1] * u[2][2] - u[1][2] * u[2][1]) +
                      u[0][1] * (u[1][2] * u[2][0] - u[1][0] * u[2][2]) +
                      u[0][2] * (u[1][0] * u[2][1] - u[1][1] * u[2][0]));
    }
    entry.volume = std::ldexp(static_cast<double>(sum) / 6, 3 * exponent);
    entry.lower = bounds.lower;
    entry.upper = bounds.upper;
  }
  mesh.optional.insert(mesh.optional.begin(),
                       optional_section(tetfmt::kRegions, sizeof(tetfmt::Region), table));
  return mesh;
}

/// Two meshes of one region each, made by with_regions(), as one file; the second one moved by `shift`.
inline tetfmt::Mesh joined(tetfmt::Mesh mesh, const tetfmt::Mesh& other, float shift) {
  using tetfmt::Index;
  const auto vertices = static_cast<Index>(mesh.vertices.size()), tets = static_cast<Index>(mesh.tets.size());
  const auto sides = static_cast<Index>(mesh.sides.size()),
             triangles = static_cast<Index>(mesh.triangles.size());
  const auto moved = [&](const tetfmt::Vec3f& p) {
    return tetfmt::Vec3f{p.x + shift, p.y + shift, p.z + shift};
  };
  for (const tetfmt::Vec3f& vertex : other.vertices) mesh.vertices.push_back(moved(vertex));
  for (tetfmt::FullTet tet : other.tets) {
    for (Index& id : tet.vertices) id += vertices;
    for (tetfmt::Ref& ref : tet.neighbors)
      if (ref != tetfmt::kHull) ref += tetfmt::is_tet(ref) ? tets : sides;
    mesh.tets.push_back(tet);
  }
  for (tetfmt::Side side : other.sides) {
    if (side.tet != tetfmt::kNone) side.tet += tets;
    side.triangle += triangles;
    mesh.sides.push_back(side);
  }
  for (tetfmt::Triangle triangle : other.triangles) {
    for (Index& id : triangle.vertices) id += vertices;
    mesh.triangles.push_back(triangle);
  }
  for (const Index source : other.sources) mesh.sources.push_back(source + tets);
  std::vector<tetfmt::Region> table(2);
  std::memcpy(&table[0], mesh.optional.at(0).bytes.data(), sizeof(tetfmt::Region));
  std::memcpy(&table[1], other.optional.at(0).bytes.data(), sizeof(tetfmt::Region));
  table[1].first_tet += tets;
  table[1].id = table[0].id + 1;
  table[1].lower = moved(table[1].lower);
  table[1].upper = moved(table[1].upper);
  mesh.optional = {optional_section(tetfmt::kRegions, sizeof(tetfmt::Region), table)};
  return mesh;
}

/// The same with the box around its triangles (BNDS), by which rays may be told to miss.
inline tetfmt::Mesh with_surface_bounds(tetfmt::Mesh mesh) {
  tetfmt::Bounds bounds;
  for (const tetfmt::Triangle& triangle : mesh.triangles)
    for (const tetfmt::Index id : triangle.vertices)
      if (!triangle.dropped()) bounds.add(mesh.vertices[id]);
  mesh.optional.push_back(optional_section(tetfmt::kSurfaceBounds, sizeof(tetfmt::SurfaceBounds),
                                           std::vector<tetfmt::SurfaceBounds>{{bounds.lower, bounds.upper}}));
  return mesh;
}

}  // namespace tetfmt_test
