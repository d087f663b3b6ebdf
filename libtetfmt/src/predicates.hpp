// SPDX-License-Identifier: MIT
// Which side of a line an edge passes, and which side of a face a point is on: exact, and never undecided.
// spec/traversal.md derives what is computed here.
//
// Ties are broken by simulation of simplicity (Edelsbrunner and Muecke 1990): vertex i is thought of as moved
// by (e^(2^3i), e^(2^(3i+1)), e^(2^(3i+2))) for an infinitesimal e > 0. A valid mesh stays valid under so
// small a motion, and in the moved mesh no line meets an edge or a vertex, so a walk always has exactly one
// way on.
#pragma once

#include <array>
#include <cstdint>

#include "tetfmt/types.hpp"
#include "vec3d.hpp"

namespace tetfmt::detail {

/// A point, exactly as given. One on a side of a face is thought of as moved by an infinitesimal along
/// `lift`: larger than those by which vertices move, so that it is off its face whatever they do.
struct Place {
  Vec3d point{};
  Vec3d lift{};  ///< zero, or 1 or -1 in one component
};

/// A directed line, exactly as given: either origin + t * direction, or from one place through another.
struct Line {
  Place origin;
  Vec3d direction{};  ///< exact; or, with `through_point`, toward - origin as rounded to double
  Place toward;       ///< only used with `through_point`
  bool through_point = false;
};

/// A mesh vertex with the id that breaks its ties.
struct Corner {
  Vec3f point;
  Index id = 0;
};

/// What it took to find a sign.
enum class Decided : std::uint8_t { in_double, by_integers, by_tie_rule };

struct Passing {
  bool left = false;
  Decided how = Decided::in_double;
};

/// True (left) if the directed edge a -> b passes the line counter-clockwise, seen with the line's direction
/// pointing at the viewer's back: det[direction, a - origin, b - origin] > 0 after perturbation.
/// Antisymmetric in (a, b). Double precision where certified, else integers of any length. Coordinates must
/// be finite, ids different.
Passing passes_left(const Line& line, const Corner& a, const Corner& b);

/// True if `place` lies behind the face, opposite to where (b - a) x (c - a) points, after perturbation of
/// the face's vertices: det[a - point, b - point, c - point] > 0.
bool behind(const Corner& a, const Corner& b, const Corner& c, const Place& place);

/// The same for the point origin + t * direction of a line, exactly that; not for lines through a point.
/// `t` must be finite.
bool behind(const Corner& a, const Corner& b, const Corner& c, const Line& line, double t);

/// Sign of det[a, b, c] if double precision certifies it; 0 if not. The entries may carry one rounding each;
/// the bound is that of Shewchuk (1997), orient3d stage A.
int certified_sign(const Vec3d& a, const Vec3d& b, const Vec3d& c);

/// ((b - a) x (c - a)) . (a - origin), rounded once.
double plane_height(const Vec3d& origin, const Vec3f& a, const Vec3f& b, const Vec3f& c);

}  // namespace tetfmt::detail
