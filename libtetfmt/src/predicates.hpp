// SPDX-License-Identifier: MIT
// Which side of a line an edge passes, and which side of a face a point is on: exact, and never undecided.
//
// Ties are broken by simulation of simplicity (Edelsbrunner and Muecke 1990): vertex i is thought of as moved
// by (e^(2^3i), e^(2^(3i+1)), e^(2^(3i+2))) for an infinitesimal e > 0. A valid mesh stays valid under so
// small a motion, and in the moved mesh no line meets an edge or a vertex, so a walk always has exactly one
// way on.
#pragma once

#include <array>

#include "tetfmt/types.hpp"

namespace tetfmt::detail {

using Vec3d = std::array<double, 3>;

/// A directed line, exactly as given: either origin + t * direction, or from origin through a point.
struct Line {
  Vec3d origin{};
  Vec3d direction{};  ///< exact; or, with `through_point`, toward - origin as rounded to double
  Vec3d toward{};     ///< only used with `through_point`
  bool through_point = false;
};

/// A mesh vertex with the id that breaks its ties.
struct Corner {
  Vec3f point;
  Index id = 0;
};

/// True if the directed edge a -> b passes the line counter-clockwise, seen with the line's direction
/// pointing at the viewer's back: det[direction, a - origin, b - origin] > 0 after perturbation.
/// Antisymmetric in (a, b). Double precision where certified, else integers of any length. Coordinates must
/// be finite, ids different.
bool passes_left(const Line& line, const Corner& a, const Corner& b);

/// True if `point` lies behind the face, opposite to where (b - a) x (c - a) points, after perturbation of
/// the face's vertices: det[a - point, b - point, c - point] > 0.
bool behind(const Corner& a, const Corner& b, const Corner& c, const Vec3d& point);

}  // namespace tetfmt::detail
