// SPDX-License-Identifier: AGPL-3.0-or-later
// What two triangles have in common, exactly, in terms of the points of the surface.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "prep/prep.hpp"

namespace tetprep {

__extension__ using Wide = __int128;

/// A point where a triangle's edge meets another triangle: p + (q - p) * numerator / denominator, strictly
/// between the ends, as an exact rational; or (q == kNone) the surface's point p itself.
struct ContactPoint {
  Index p = kNone, q = kNone;
  Wide numerator = 0, denominator = 1;
};

/// Triangles in different planes have a point or a segment in common, or nothing. `points`: its ends, each of
/// them at least once and nothing else; a corner may come twice, and so may a place where two edges cross
/// (once from either edge).
struct Contact {
  std::size_t count = 0;
  std::array<ContactPoint, 12> points;
};

/// The axis along which the triangle looks largest: the first one, if several are equal.
std::size_t widest_axis(const GridPoint& a, const GridPoint& b, const GridPoint& c);

/// Whether p, seen along `axis`, is inside the triangle and on none of its edges.
bool strictly_inside(const GridPoint& a, const GridPoint& b, const GridPoint& c, const GridPoint& p,
                     std::size_t axis);

bool in_one_plane(const std::vector<GridPoint>& points, const std::array<Index, 3>& a,
                  const std::array<Index, 3>& b);

/// Exact for points that differ by at most 2^25. Neither triangle may be degenerate, and they must not lie in
/// one plane. O(1).
Contact find_contact(const std::vector<GridPoint>& points, const std::array<Index, 3>& a,
                     const std::array<Index, 3>& b);

}  // namespace tetprep
