// SPDX-License-Identifier: AGPL-3.0-or-later
// A surface that intersects itself becomes one that does not: triangles are cut where others meet them.
#pragma once

#include <cstddef>
#include <vector>

#include "prep/intersections.hpp"
#include "prep/prep.hpp"

namespace tetprep {

struct ResolveReport {
  std::size_t intersecting_pairs = 0;  ///< in the surface as it came
  int rounds = 0;                      ///< of cutting and rounding to the grid
  std::size_t cut_triangles = 0;       ///< input triangles that are in more than one piece now
  std::size_t pieces = 0;              ///< that those are in
  std::size_t new_points = 0;
  std::size_t overlaps = 0;  ///< pieces left out because an earlier triangle has the same
  int grid_coarsening = 0;   ///< times that the grid was made twice as coarse where intersections did not end
  /// Largest distance of a piece from the triangle that it is part of, or of a corner of the input that had
  /// to be moved from its place. Model units.
  double max_deviation = 0;
};

/// Cuts all triangles along their intersections (exact, after which new points go to the nearest grid point)
/// until none intersects any more. `pairs`: of an IntersectionSearch over `surface`. Points of the surface
/// keep their places, and their numbers unless some are not needed any more; but where intersections do not
/// end after a round, they become one with others close by, and edges are led through them: within two grid
/// steps at first, twice as far from round to round. Pieces keep the orientation of the triangle that they
/// are part of and its input number, and cover it to within the grid. Where triangles overlap in a plane, the
/// piece belongs to the first of them. The result is deterministic for any number of threads, and
/// IntersectionSearch finds nothing in it. Failure (unsupported): the arrangement would have more than
/// `max_pieces` triangles (the message names triangles that take part in most of it); (runtime): no end in
/// sight on any grid.
CleanSurface resolve(CleanSurface surface, std::vector<TrianglePair> pairs, unsigned threads,
                     Progress& progress, ResolveReport& report, std::size_t max_pieces = 20'000'000);

}  // namespace tetprep
