// SPDX-License-Identifier: AGPL-3.0-or-later
// One plane's share of the work of resolve(): triangles cut along everything that meets them.
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "prep/prep.hpp"

namespace tetprep {

/// Triangles to be cut together: one alone, or several that lie in one plane and meet there. Cut one by one,
/// overlapping ones would get different diagonals in the same place.
struct CutTask {
  std::span<const Index> members;              ///< ascending
  std::vector<std::array<Index, 2>> contacts;  ///< a member, and a triangle of another plane that meets it
  /// Two ends of a member's edge, the lower first, and a point nearby that the edge is to go through.
  std::vector<std::array<Index, 3>> edge_bends;
  /// A member, and a point nearby that it is to go through; strictly_inside() along its widest_axis().
  std::vector<std::array<Index, 2>> inner_bends;
};

/// A triangle of a CutResult.
struct CutPiece {
  Index owner = kNone;  ///< the first member that covers it; its orientation is the piece's
  /// Below the number of the surface's points: one of them. Otherwise, that number more than a position in
  /// CutResult::new_points.
  std::array<Index, 3> corners{};
};

struct CutResult {
  std::vector<GridPoint> new_points;  ///< rounded; several may fall together, also with points of the surface
  std::vector<CutPiece> pieces;       ///< by owner; in exact arithmetic none is flat, on the grid some may be
  std::size_t overlaps = 0;           ///< further members that cover pieces, summed over the pieces
  bool too_many = false;              ///< given up: there would be more than `most_pieces`
};

/// Exact up to the rounding of new points, each to the nearest grid point: two calls that have to do with the
/// same point round it to the same place. Deterministic, and safe to call from several threads at a time.
CutResult cut_triangles(const std::vector<GridPoint>& points,
                        const std::vector<std::array<Index, 3>>& triangles, const CutTask& task,
                        std::size_t most_pieces);

}  // namespace tetprep
