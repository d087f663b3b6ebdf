// SPDX-License-Identifier: AGPL-3.0-or-later
#include "bench/truth/surface.hpp"

#include <algorithm>
#include <cmath>

#include "common/failure.hpp"
#include "tetfmt/layout.hpp"

namespace tetbench {
namespace {

using tetfmt::Index;
using tetprep::ExitCode;
using tetprep::Failure;

GridPoint difference(const GridPoint& p, const GridPoint& q) {
  return {q[0] - p[0], q[1] - p[1], q[2] - p[2]};
}

/// Whether every edge belongs to an even number of faces.
bool is_closed(const std::vector<Face>& faces) {
  std::vector<std::array<Index, 2>> edges;
  edges.reserve(3 * faces.size());
  for (const Face& face : faces)
    for (std::size_t k = 0; k < 3; ++k) {
      const Index a = face[k], b = face[(k + 1) % 3];
      edges.push_back({std::min(a, b), std::max(a, b)});
    }
  std::sort(edges.begin(), edges.end());
  for (std::size_t i = 0; i < edges.size();) {
    std::size_t next = i;
    while (next < edges.size() && edges[next] == edges[i]) ++next;
    if ((next - i) % 2 != 0) return false;
    i = next;
  }
  return true;
}

}  // namespace

Surface::Surface(std::vector<tetfmt::Vec3f> points, std::vector<Face> triangles)
    : vertices(std::move(points)),
      grid_exponent(tetfmt::grid_exponent(vertices)),
      faces(std::move(triangles)),
      closed(is_closed(faces)) {
  grid.reserve(vertices.size());
  for (const tetfmt::Vec3f& v : vertices) {
    GridPoint point{};
    const std::array<float, 3> values = {v.x, v.y, v.z};
    for (std::size_t k = 0; k < 3; ++k) {
      const double steps = std::ldexp(static_cast<double>(values[k]), -grid_exponent);
      if (!(std::abs(steps) <= static_cast<double>(tetfmt::kMaxGridCoordinate)))
        throw Failure(ExitCode::invalid, "vertex " + std::to_string(grid.size()) +
                                             ": not on a grid of 24 bits; run `tet validate`");
      point[k] = static_cast<std::int64_t>(steps);
    }
    grid.push_back(point);
  }
}

GridPoint Surface::normal(const Face& face) const {
  const GridPoint u = difference(grid[face[0]], grid[face[1]]), v = difference(grid[face[0]], grid[face[2]]);
  return {u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]};
}

Surface Surface::of(const tetfmt::Mesh& mesh) {
  std::vector<Face> faces(mesh.sides.size() / 2, Face{tetfmt::kNone, tetfmt::kNone, tetfmt::kNone});
  std::vector<Index> apexes(faces.size(), tetfmt::kNone);
  std::vector<bool> apex_in_front(faces.size());
  for (const tetfmt::FullTet& tet : mesh.tets)
    for (std::size_t k = 0; k < 4; ++k) {
      if (!tetfmt::is_side(tet.neighbors[k])) continue;
      const Index side = tetfmt::side_index(tet.neighbors[k]);
      const auto& v = tet.vertices;
      faces.at(side / 2) = {v[k == 0 ? 1 : 0], v[k <= 1 ? 2 : 1], v[k <= 2 ? 3 : 2]};
      apexes.at(side / 2) = v[k];
      apex_in_front.at(side / 2) = side % 2 == 0;
    }
  Surface surface(mesh.vertices, std::move(faces));
  std::vector<std::size_t> parts(mesh.triangles.size());
  for (std::size_t i = 0; i < surface.faces.size(); ++i) {
    Face& face = surface.faces[i];
    if (apexes[i] == tetfmt::kNone)
      throw Failure(ExitCode::invalid,
                    "side " + std::to_string(2 * i) + ": no tetrahedron has it; run `tet validate`");
    // Products of 52 and 26 bits.
    __extension__ using Wide = __int128;
    const GridPoint n = surface.normal(face), to = difference(surface.grid[face[0]], surface.grid[apexes[i]]);
    const Wide height = Wide{n[0]} * to[0] + Wide{n[1]} * to[1] + Wide{n[2]} * to[2];
    if ((height > 0) != apex_in_front[i]) std::swap(face[1], face[2]);
    ++parts.at(mesh.sides[2 * i].triangle);
  }
  for (std::size_t i = 0; i < surface.faces.size(); ++i) {
    const Index triangle = mesh.sides[2 * i].triangle;
    if (parts[triangle] != 1) continue;
    Face whole = mesh.triangles[triangle].vertices;
    const Face& face = surface.faces[i];
    for (int turns = 0; turns < 2 && whole != face; ++turns)
      std::rotate(whole.begin(), whole.begin() + 1, whole.end());
    if (whole != face)
      throw Failure(ExitCode::invalid, "triangle " + std::to_string(triangle) +
                                           ": its face has other corners; run `tet validate`");
  }
  return surface;
}

}  // namespace tetbench
