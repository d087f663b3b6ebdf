// SPDX-License-Identifier: AGPL-3.0-or-later
// Where TetGen had to put points on triangles: the surface in the pieces that it made of them.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "prep/prep.hpp"

namespace tetprep {

/// A piece of a triangle, between points of a tetrahedralisation. Corners ascending.
struct Piece {
  Index triangle = 0;
  std::array<Index, 3> corners{};
  auto operator<=>(const Piece&) const = default;
};

/// All faces that lie on triangles, ascending; each as often as a tet has it. O(tets log tets).
std::vector<Piece> collect_pieces(std::span<const std::array<Index, 4>> tets,
                                  std::span<const std::array<Index, 4>> face_triangle);

/// Why `pieces` do not make up the triangles, or an empty string: each is there twice, and each triangle is
/// covered by its pieces. `points` are where TetGen wants them, the first ones those of the surface; on
/// triangles they are so to within rounding. Leaves every piece in `pieces` once.
std::string check_pieces(const CleanSurface& surface, std::vector<Piece>& pieces,
                         std::span<const Point> points);

/// The position in `pieces` (ascending, each once) of every face that lies on a triangle, going through tets
/// and then their faces.
std::vector<Index> find_pieces(std::span<const std::array<Index, 4>> tets,
                               std::span<const std::array<Index, 4>> face_triangle,
                               std::span<const Piece> pieces);

/// Replaces the triangles by their pieces, in this order, each oriented as its triangle is. `surface.points`
/// must hold the corners of all pieces already; `exact` are their places before rounding. Returns how many
/// triangles are in more than one.
Index replace_by_pieces(CleanSurface& surface, std::span<const Piece> pieces, std::span<const Point> exact);

}  // namespace tetprep
