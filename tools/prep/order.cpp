// SPDX-License-Identifier: AGPL-3.0-or-later
// The file's numbers for everything. Rays touch tets that lie near each other, so vertices follow a Hilbert
// curve as tets do; faces follow the tets.
#include <algorithm>
#include <atomic>
#include <cmath>

#include "prep/box.hpp"
#include "prep/hilbert_sort.hpp"
#include "prep/regions.hpp"
#include "prep/sources.hpp"

namespace tetprep {
namespace {

using Corners = std::array<Index, 3>;

/// The vertices that tets and `others` have, along a Hilbert curve: `old_number` of each, and `new_number` of
/// every point of the mesh, kNone for those left behind.
struct VertexOrder {
  std::vector<Index> old_number, new_number;

  VertexOrder(const TetMesh& mesh, std::span<const Corners> others) : new_number(mesh.points.size(), kNone) {
    for (const Corners& corners : others)
      for (const Index v : corners)
        if (v != kNone) new_number[v] = 0;
    tbb::parallel_for(std::size_t{0}, mesh.tets.size(), [&](std::size_t t) {
      for (const Index v : mesh.tets[t]) std::atomic_ref(new_number[v]).store(0, std::memory_order_relaxed);
    });
    const Box box = bounds_of(mesh.points);
    old_number = hilbert_sort(mesh.points.size(), box.extent(), [&](std::size_t i) {
      const GridPoint& p = mesh.points[i];
      return std::array<std::int64_t, 3>{p[0] - box.low[0], p[1] - box.low[1], p[2] - box.low[2]};
    });
    std::erase_if(old_number, [&](Index v) { return new_number[v] == kNone; });
    tbb::parallel_for(std::size_t{0}, old_number.size(),
                      [&](std::size_t i) { new_number[old_number[i]] = static_cast<Index>(i); });
  }

  /// kNone x 3 stays that.
  Corners of(const Corners& corners) const {
    Corners result{};
    for (std::size_t k = 0; k < 3; ++k) {
      result[k] = corners[k] == kNone ? kNone : new_number[corners[k]];
      if (result[k] == kNone) return {kNone, kNone, kNone};
    }
    return result;
  }
};

std::vector<tetfmt::Vec3f> local_vertices(const TetMesh& mesh, const std::vector<Index>& old_number) {
  std::vector<tetfmt::Vec3f> vertices(old_number.size());
  tbb::parallel_for(std::size_t{0}, old_number.size(), [&](std::size_t i) {
    const auto local = [&](std::size_t k) {
      return std::ldexp(static_cast<float>(mesh.points[old_number[i]][k]), mesh.grid_exponent);
    };
    vertices[i] = {local(0), local(1), local(2)};
  });
  return vertices;
}

/// Every triangle's place among those that are faces of the mesh, in the order in which the tets come: sides
/// are near each other in the file when the tets are. kNone: it has no face left.
std::vector<Index> number_faces(const TetMesh& mesh, std::size_t triangles, Index& count) {
  std::vector<Index> number(triangles, kNone);
  count = 0;
  for (const auto& row : mesh.face_triangle)
    for (const Index triangle : row)
      if (triangle != kNone && number[triangle] == kNone) number[triangle] = count++;
  return number;
}

template <class T>
tetfmt::OptionalSection section(tetfmt::SectionKind kind, const std::vector<T>& values) {
  const auto bytes = std::as_bytes(std::span(values));
  return {kind, sizeof(T), {bytes.begin(), bytes.end()}};
}

/// One, or none if there is no surface left.
std::vector<tetfmt::SurfaceBounds> surface_bounds(const tetfmt::Mesh& mesh) {
  tetfmt::Bounds bounds;
  for (const tetfmt::Triangle& triangle : mesh.triangles)
    if (!triangle.dropped())
      for (const Index id : triangle.vertices) bounds.add(mesh.vertices[id]);
  if (!(bounds.lower.x <= bounds.upper.x)) return {};
  return {{bounds.lower, bounds.upper}};
}

}  // namespace

tetfmt::Mesh order(const TetMesh& mesh, const CleanSurface& surface,
                   std::span<const Index> triangle_material) {
  Index faces = 0;
  const std::vector<Index> face_number = number_faces(mesh, surface.triangles.size(), faces);
  // Input triangles that are there in pieces keep their corners, for the weights of hits, even those corners
  // that lie in left-out space.
  const bool cut = !surface.input_corners.empty();
  std::vector<Corners> input(cut ? surface.input_corners.size() : 0, Corners{kNone, kNone, kNone});
  for (std::size_t t = 0; cut && t < surface.triangles.size(); ++t)
    if (face_number[t] != kNone)
      input[surface.input_triangle[t]] = surface.input_corners[surface.input_triangle[t]];
  const VertexOrder vertices(mesh, input);

  tetfmt::Mesh out;
  out.origin = mesh.origin;
  out.vertices = local_vertices(mesh, vertices.old_number);

  // Of uncut triangles the file keeps the input's numbers. Pieces have numbers of their own.
  const auto file_number = [&](std::size_t t) {
    return cut ? static_cast<Index>(t) : surface.input_triangle[t];
  };
  out.triangles.resize(cut ? surface.triangles.size() : surface.input_triangle_count);
  out.sides.resize(std::size_t{2} * faces);
  for (std::size_t t = 0; t < surface.triangles.size(); ++t) {
    if (face_number[t] == kNone) continue;
    out.triangles[file_number(t)].vertices = vertices.of(surface.triangles[t]);
    const Index material = triangle_material.empty() ? 0 : triangle_material[surface.input_triangle[t]];
    for (const std::size_t side : {0, 1})
      out.sides[std::size_t{2} * face_number[t] + side] = {kNone, file_number(t), material};
  }

  // Side 2k of a face belongs to the tet where the triangle's normal points. Each is written by one tet.
  out.tets.resize(mesh.tets.size());
  tbb::parallel_for(std::size_t{0}, mesh.tets.size(), [&](std::size_t t) {
    const auto& corners = mesh.tets[t];
    std::array<std::pair<Index, std::size_t>, 4> slots{};  // new number and old slot
    for (std::size_t k = 0; k < 4; ++k) slots[k] = {vertices.new_number[corners[k]], k};
    std::sort(slots.begin(), slots.end());
    for (std::size_t k = 0; k < 4; ++k) {
      const auto [vertex, slot] = slots[k];
      out.tets[t].vertices[k] = vertex;
      tetfmt::Ref& ref = out.tets[t].neighbors[k];
      const Index triangle = mesh.face_triangle[t][slot], beyond = mesh.neighbors[t][slot];
      if (triangle == kNone) {
        ref = beyond == kNone ? tetfmt::kHull : beyond;
        continue;
      }
      const auto& [a, b, c] = surface.triangles[triangle];
      const bool front =
          tetfmt::orientation(mesh.points[a], mesh.points[b], mesh.points[c], mesh.points[corners[slot]]) > 0;
      const Index side = 2 * face_number[triangle] + (front ? 0 : 1);
      out.sides[side].tet = static_cast<Index>(t);
      ref = tetfmt::side_ref(side);
    }
  });

  out.sources = choose_sources(mesh);
  if (!mesh.region.empty()) out.optional.push_back(region_section(mesh));
  if (const auto bounds = surface_bounds(out); !bounds.empty())
    out.optional.push_back(section(tetfmt::kSurfaceBounds, bounds));
  if (cut) {
    for (Corners& corners : input) corners = vertices.of(corners);
    out.optional.push_back(section(tetfmt::kOrigins, surface.input_triangle));
    out.optional.push_back(section(tetfmt::kInputTriangles, input));
  }
  return out;
}

}  // namespace tetprep
