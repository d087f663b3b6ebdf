// SPDX-License-Identifier: AGPL-3.0-or-later
// A small valid mesh without the converter: a cube of n x n x n lattice cells, each cut into six tetrahedra
// (Kuhn's subdivision), around a constrained inner box. Everything is degenerate here (coplanar, cospherical,
// aligned with the axes), which is what a test wants.
#pragma once

#include <algorithm>
#include <array>
#include <map>
#include <stdexcept>
#include <utility>
#include <vector>

#include "tetfmt/mesh.hpp"

namespace tetfmt_test {

struct LatticeOptions {
  int low = 1;          ///< the inner box is [low, high]^3 in lattice steps; high < 0 stands for n - low
  int high = -1;        ///<
  unsigned walls = 63;  ///< bit 2 * axis + (1 if high): walls that are there; fewer than six: an open surface
  bool one_triangle_a_face = false;  ///< else two triangles a wall, each covered by (high - low)^2 faces
  float step = 1;                    ///< edge of a lattice cell; a power of two keeps the grid exact
  std::array<double, 3> origin{};    ///< as in tetfmt::Mesh
};

/// Vertex (x, y, z), each 0 to n, has id x + (n + 1) * (y + (n + 1) * z) and local coordinates step * (x, y,
/// z). Tets: cells in the same order, six each. Triangles point out of the inner box, two a wall, walls in
/// the order of their bits. Valid at Level::geometry for 1 <= n <= 18 (the hull list's limit) and 0 <= low <
/// high <= n, except that a wall on the hull (low == 0 or high == n) has nothing behind it and cannot be
/// constrained: throws std::invalid_argument, as for other values out of range.
inline tetfmt::Mesh lattice_mesh(int n, const LatticeOptions& options = {}) {
  using tetfmt::Index;
  using Point = std::array<int, 3>;
  const int low = options.low;
  const int high = options.high < 0 ? n - low : options.high;
  if (n < 1 || n > 18 || (options.walls != 0 && (low < 1 || low >= high || high >= n))) {
    throw std::invalid_argument("lattice_mesh: needs 1 <= n <= 18 and 0 < low < high < n");
  }

  tetfmt::Mesh mesh;
  mesh.origin = options.origin;
  const auto id = [n](const Point& p) {
    return static_cast<Index>(p[0] + (n + 1) * (p[1] + (n + 1) * p[2]));
  };
  std::vector<Point> points;
  for (int z = 0; z <= n; ++z) {
    for (int y = 0; y <= n; ++y) {
      for (int x = 0; x <= n; ++x) {
        points.push_back({x, y, z});
        mesh.vertices.push_back({options.step * static_cast<float>(x), options.step * static_cast<float>(y),
                                 options.step * static_cast<float>(z)});
      }
    }
  }

  // Each cell: the six monotone paths from its lowest corner to its highest. Ids ascend along a path, and
  // every square is cut along the diagonal from its lowest to its highest corner, so neighbouring cells
  // agree.
  for (const Point& corner : points) {
    if (std::max({corner[0], corner[1], corner[2]}) == n) continue;
    std::array<std::size_t, 3> axes{0, 1, 2};
    do {
      tetfmt::FullTet tet;
      Point p = corner;
      tet.vertices[0] = id(p);
      for (std::size_t i = 0; i < 3; ++i) {
        ++p[axes[i]];
        tet.vertices[i + 1] = id(p);
      }
      mesh.tets.push_back(tet);
    } while (std::next_permutation(axes.begin(), axes.end()));
  }

  using Face = std::array<Index, 3>;
  std::map<Face, std::vector<std::pair<Index, std::size_t>>> faces;  // (tet, slot) of the one or two tets
  for (Index t = 0; t < mesh.tets.size(); ++t) {
    const auto& v = mesh.tets[t].vertices;
    for (std::size_t k = 0; k < 4; ++k) {
      Face face{};
      for (std::size_t i = 0, j = 0; i < 4; ++i) {
        if (i != k) face[j++] = v[i];
      }
      faces[face].emplace_back(t, k);
    }
  }

  // Two triangles a wall; (b, c) are the wall's other axes, so that b x c points along the wall's own axis.
  std::array<Index, 6> first_triangle{};
  for (std::size_t wall = 0; wall < 6; ++wall) {
    if ((options.walls >> wall & 1u) == 0 || options.one_triangle_a_face) continue;
    const std::size_t axis = wall / 2;
    const auto corner = [&](int b, int c) {
      Point p{};
      p[axis] = wall % 2 != 0 ? high : low;
      p[(axis + 1) % 3] = b;
      p[(axis + 2) % 3] = c;
      return id(p);
    };
    first_triangle[wall] = static_cast<Index>(mesh.triangles.size());
    tetfmt::Triangle below{{corner(low, low), corner(high, low), corner(high, high)}};
    tetfmt::Triangle above{{corner(low, low), corner(high, high), corner(low, high)}};
    if (wall % 2 == 0) {
      std::swap(below.vertices[1], below.vertices[2]);
      std::swap(above.vertices[1], above.vertices[2]);
    }
    mesh.triangles.push_back(below);
    mesh.triangles.push_back(above);
  }

  const auto wall_of = [&](const Face& face) {
    for (std::size_t wall = 0; wall < 6; ++wall) {
      if ((options.walls >> wall & 1u) == 0) continue;
      const bool on_wall = std::all_of(face.begin(), face.end(), [&](Index v) {
        const Point& p = points[v];
        return p[wall / 2] == (wall % 2 != 0 ? high : low) && std::min({p[0], p[1], p[2]}) >= low &&
               std::max({p[0], p[1], p[2]}) <= high;
      });
      if (on_wall) return static_cast<int>(wall);
    }
    return -1;
  };

  for (const auto& [face, owners] : faces) {
    if (owners.size() == 1) {
      mesh.tets[owners[0].first].neighbors[owners[0].second] = tetfmt::kHull;
      continue;
    }
    const int wall = wall_of(face);
    if (wall < 0) {
      mesh.tets[owners[0].first].neighbors[owners[0].second] = owners[1].first;
      mesh.tets[owners[1].first].neighbors[owners[1].second] = owners[0].first;
      continue;
    }
    const auto axis = static_cast<std::size_t>(wall) / 2;
    const bool high_wall = wall % 2 != 0;
    Index triangle;
    if (options.one_triangle_a_face) {
      // The face's ids ascend along a monotone path: its normal points up the axis if the path steps along b
      // first.
      const bool b_first = points[face[1]][(axis + 1) % 3] > points[face[0]][(axis + 1) % 3] &&
                           points[face[1]][(axis + 2) % 3] == points[face[0]][(axis + 2) % 3];
      Face corners = face;
      if (b_first != high_wall) std::swap(corners[1], corners[2]);
      triangle = static_cast<Index>(mesh.triangles.size());
      mesh.triangles.push_back({corners});
    } else {
      int b = 0, c = 0;  // three times the centroid: below the wall's diagonal or above
      for (const Index v : face) {
        b += points[v][(axis + 1) % 3];
        c += points[v][(axis + 2) % 3];
      }
      triangle = first_triangle[static_cast<std::size_t>(wall)] + (b > c ? 0 : 1);
    }
    // In front lies the owner whose fourth vertex is outside of the wall.
    const int opposite = points[mesh.tets[owners[0].first].vertices[owners[0].second]][axis];
    const bool first_in_front = high_wall ? opposite > high : opposite < low;
    const auto front = first_in_front ? owners[0] : owners[1];
    const auto back = first_in_front ? owners[1] : owners[0];
    const auto side = static_cast<Index>(mesh.sides.size());
    mesh.tets[front.first].neighbors[front.second] = tetfmt::side_ref(side);
    mesh.tets[back.first].neighbors[back.second] = tetfmt::side_ref(side + 1);
    mesh.sides.push_back({front.first, triangle, 0});
    mesh.sides.push_back({back.first, triangle, 0});
  }
  return mesh;
}

}  // namespace tetfmt_test
