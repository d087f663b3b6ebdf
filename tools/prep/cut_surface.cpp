// SPDX-License-Identifier: AGPL-3.0-or-later
#include "prep/cut_surface.hpp"

#include <algorithm>
#include <cmath>

namespace tetprep {
namespace {

Point cross(const Point& u, const Point& v) {
  return {u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]};
}

double dot(const Point& u, const Point& v) {
  return u[0] * v[0] + u[1] * v[1] + u[2] * v[2];
}

/// Twice the area, as a vector along the normal.
Point area(const Point& a, const Point& b, const Point& c) {
  return cross({b[0] - a[0], b[1] - a[1], b[2] - a[2]}, {c[0] - a[0], c[1] - a[1], c[2] - a[2]});
}

/// The end of the run of pieces of the same triangle that begins at `first`.
std::size_t end_of_run(std::span<const Piece> pieces, std::size_t first) {
  std::size_t end = first;
  while (end < pieces.size() && pieces[end].triangle == pieces[first].triangle) ++end;
  return end;
}

Piece piece_at(const std::array<Index, 4>& tet, std::size_t k, Index triangle) {
  Piece piece{triangle, {}};
  for (std::size_t i = 0, j = 0; i < 4; ++i)
    if (i != k) piece.corners[j++] = tet[i];
  std::sort(piece.corners.begin(), piece.corners.end());
  return piece;
}

/// Calls `visit` with the piece that each face on a triangle is.
template <class Visit>
void for_each_piece(std::span<const std::array<Index, 4>> tets,
                    std::span<const std::array<Index, 4>> face_triangle, const Visit& visit) {
  for (std::size_t t = 0; t < tets.size(); ++t)
    for (std::size_t k = 0; k < 4; ++k)
      if (face_triangle[t][k] != kNone) visit(piece_at(tets[t], k, face_triangle[t][k]));
}

}  // namespace

std::vector<Piece> collect_pieces(std::span<const std::array<Index, 4>> tets,
                                  std::span<const std::array<Index, 4>> face_triangle) {
  std::vector<Piece> pieces;
  for_each_piece(tets, face_triangle, [&](const Piece& piece) { pieces.push_back(piece); });
  std::sort(pieces.begin(), pieces.end());
  return pieces;
}

std::vector<Index> find_pieces(std::span<const std::array<Index, 4>> tets,
                               std::span<const std::array<Index, 4>> face_triangle,
                               std::span<const Piece> pieces) {
  std::vector<Index> found;
  for_each_piece(tets, face_triangle, [&](const Piece& piece) {
    found.push_back(
        static_cast<Index>(std::lower_bound(pieces.begin(), pieces.end(), piece) - pieces.begin()));
  });
  return found;
}

std::string check_pieces(const CleanSurface& surface, std::vector<Piece>& pieces,
                         std::span<const Point> points) {
  if (pieces.size() % 2 != 0) return "a triangle was lost on one side";
  for (std::size_t i = 0; i < pieces.size(); i += 2)
    if (pieces[i] != pieces[i + 1] || (i > 0 && pieces[i] == pieces[i - 1]))
      return "a triangle was lost on one side";
  pieces.erase(std::unique(pieces.begin(), pieces.end()), pieces.end());
  // TetGen puts a point on an edge or a triangle with an error of a few units in the last place of 2^24.
  constexpr double kOff = 1e-3;
  std::size_t first = 0;
  for (Index t = 0; t < surface.triangles.size(); ++t) {
    if (first == pieces.size() || pieces[first].triangle != t) return "a triangle was lost";
    const std::size_t end = end_of_run(pieces, first);
    auto corners = surface.triangles[t];
    const Point& a = points[corners[0]];
    const Point whole = area(a, points[corners[1]], points[corners[2]]);
    const double size = std::sqrt(dot(whole, whole));
    std::sort(corners.begin(), corners.end());
    double covered = 0;
    for (std::size_t i = first; i < end; ++i) {
      const auto& piece = pieces[i].corners;
      if (piece == corners && end == first + 1) {
        covered = size;
        break;
      }
      for (const Index v : piece) {
        const Point& p = points[v];
        const double height = dot({p[0] - a[0], p[1] - a[1], p[2] - a[2]}, whole) / size;
        if (!(std::abs(height) < kOff)) return "a triangle was changed";
      }
      const Point part = area(points[piece[0]], points[piece[1]], points[piece[2]]);
      covered += std::sqrt(dot(part, part));
    }
    // Pieces in the triangle's plane whose areas add up to the triangle's: all of it is covered if none lies
    // outside or on another, which faces of one tetrahedralisation cannot.
    if (!(std::abs(covered - size) <= 1e-6 * size + kOff)) return "a triangle was changed";
    first = end;
  }
  return first == pieces.size() ? "" : "a triangle was changed";
}

Index replace_by_pieces(CleanSurface& surface, std::span<const Piece> pieces, std::span<const Point> exact) {
  Index cut = 0;
  if (surface.input_corners.empty()) {
    surface.input_corners.assign(surface.input_triangle_count, {kNone, kNone, kNone});
    for (Index t = 0; t < surface.triangles.size(); ++t)
      surface.input_corners[surface.input_triangle[t]] = surface.triangles[t];
  }
  std::vector<std::array<Index, 3>> triangles;
  std::vector<Index> input_triangle;
  for (std::size_t first = 0, end = 0; first < pieces.size(); first = end) {
    end = end_of_run(pieces, first);
    const auto& whole = surface.triangles[pieces[first].triangle];
    const Point normal = area(exact[whole[0]], exact[whole[1]], exact[whole[2]]);
    cut += end - first > 1;
    for (std::size_t i = first; i < end; ++i) {
      auto corners = pieces[i].corners;
      if (end == first + 1) {
        corners = whole;
      } else if (dot(area(exact[corners[0]], exact[corners[1]], exact[corners[2]]), normal) < 0) {
        std::swap(corners[1], corners[2]);
      }
      triangles.push_back(corners);
      input_triangle.push_back(surface.input_triangle[pieces[first].triangle]);
    }
  }
  surface.triangles = std::move(triangles);
  surface.input_triangle = std::move(input_triangle);
  return cut;
}

}  // namespace tetprep
