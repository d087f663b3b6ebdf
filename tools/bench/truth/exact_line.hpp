// SPDX-License-Identifier: AGPL-3.0-or-later
// A line and the faces of a surface, by exact arithmetic on the numbers as they are: which faces it crosses,
// on which side, in which order. Nothing is ever undecided: ties are broken by infinitesimals
// (infinitesimal.hpp).
//
// Each question is the sign of a polynomial. Its constant term is first evaluated in double precision with an
// error bound; where that does not settle it, in integers; and if it is zero, the infinitesimal terms decide.
#pragma once

#include <array>
#include <optional>

#include "bench/truth/infinitesimal.hpp"
#include "bench/truth/surface.hpp"

namespace tetbench {

/// Where a line starts or ends.
struct Place {
  Vec3d position{};  ///< local coordinates, exactly
  /// On a side of a face: the direction off it, along the axis of the normal's largest component; else zero.
  GridPoint off{};
  bool on_side() const { return off != GridPoint{}; }
};

/// Wide enough for products of three numbers below 2^40: where lines pass lattice points, and ties are
/// common.
__extension__ using Wide = __int128;

/// A line in integers: positions in units of 2^unit, the direction in 2^direction_unit.
struct WholeLine {
  int unit = 0, direction_unit = 0;
  unsigned vertex_shift = 0;  ///< from grid steps to units
  std::array<Integer, 3> origin, direction, origin_off, direction_off;
  bool off = false;     ///< origin_off or direction_off is not zero
  bool narrow = false;  ///< everything stays below 2^39, and `off` is false
  std::array<std::int64_t, 3> narrow_origin{}, narrow_direction{};
};

class ExactLine {
 public:
  /// The points from + t * direction; `direction` is exact. `surface` must outlive the line.
  ExactLine(const Surface& surface, const Place& from, const Vec3d& direction);
  /// From t = 0 to t = 1, exactly, though the direction may be no double.
  ExactLine(const Surface& surface, const Place& from, const Place& to);

  const Vec3d& origin() const { return origin_; }
  /// Rounded to double.
  const Vec3d& direction() const { return direction_; }

  /// 0 if the line does not cross the perturbed face; 1 if it does along the normal, from the back; -1 if
  /// from the front. The direction must not be zero.
  int crosses(const Face& face) const;
  /// Whether the line and the closed face, as it is, have a point in common, or the line lies in its plane.
  bool touches(const Face& face) const;
  /// Whether the line passes strictly between the edges of the face as it is.
  bool crosses_inside(const Face& face) const;
  /// Whether moreover the origin, as it is, lies exactly in the face's plane.
  bool starts_inside(const Face& face) const { return crosses_inside(face) && exact_over(face) == 0; }

  /// Bounds of the t at which the line meets the plane of a face that it crosses. Where the line lies in that
  /// plane, the limit of the perturbed crossing.
  struct Range {
    double low = 0, high = 0;
  };
  Range parameter(const Face& face) const;
  /// The order along the line of two different faces that it crosses: -1 if `a` comes first, else 1.
  int compare(const Face& a, const Face& b) const;
  /// -1 if the line crosses the face before t, 1 if after; t must be finite.
  int compare(const Face& face, double t) const;

  /// Sign of det[a - o, b - o, c - o], perturbed: 1 if the origin lies behind the face.
  int height(const Face& face) const;
  /// Whether the perturbed tetrahedron contains the origin; its four vertices in any order.
  bool starts_in(const std::array<tetfmt::Index, 4>& tet) const;

  /// |t - exact| in units of the last place of a double of t's size; the line must not lie in the face's
  /// plane.
  double ulps_off(const Face& face, double t) const;
  /// Sine of the angle between line and plane, to double precision; 0 is exact.
  double sine(const Face& face) const;

 private:
  struct Fraction {
    Polynomial over, under;  ///< t in units of 2^(unit - direction_unit)
  };
  /// A sum in double precision, and a bound on its error.
  struct Estimate {
    double value = 0, error = 0;
  };

  const WholeLine& whole() const;
  int edge(tetfmt::Index a, tetfmt::Index b) const;
  int edge_as_it_is(tetfmt::Index a, tetfmt::Index b) const;
  std::array<Integer, 3> from_origin(tetfmt::Index vertex) const;
  std::array<Wide, 3> narrow_from_origin(tetfmt::Index vertex) const;
  std::array<Polynomial, 3> perturbed(tetfmt::Index vertex, const PowersOf& powers) const;
  std::array<Polynomial, 3> perturbed_direction() const;
  Polynomial under_of_edge(tetfmt::Index a, tetfmt::Index b, const PowersOf& powers) const;
  Fraction fraction(const Face& face, const PowersOf& powers) const;
  /// Normal . (a - o) and normal . d.
  Estimate estimated_over(const Face& face) const;
  Estimate estimated_under(const Face& face) const;
  Integer exact_over(const Face& face) const;
  Integer exact_under(const Face& face) const;
  /// height() from another origin, in units of 2^unit, which is at most that of the origin.
  int height_from(const Face& face, const std::array<Integer, 3>& origin, const std::array<Integer, 3>& off,
                  int unit) const;

  const Surface& surface_;
  Place from_;
  std::optional<Place> to_;
  Vec3d origin_{}, direction_{};
  mutable std::optional<WholeLine> whole_;
};

}  // namespace tetbench
