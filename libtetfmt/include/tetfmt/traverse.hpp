// SPDX-License-Identifier: MIT
// Rays through the tetrahedra, straight from the file's bytes.
//
// Aman, Demirci and Gudukbay (2022), appendix B: a ray that enters a tetrahedron across a known face learns
// the fourth vertex from the xor, projects it onto the plane orthogonal to the ray, and leaves by the face
// whose projected edges enclose the origin.
#pragma once

#include <cstdint>
#include <limits>

#include "tetfmt/types.hpp"
#include "tetfmt/validate.hpp"
#include "tetfmt/view.hpp"

namespace tetfmt {

/// Origin and direction in local coordinates (model minus the file's origin). The direction need not be of
/// unit length. A ray with a zero or non-finite direction, or a non-finite origin, hits nothing.
struct Ray {
  Vec3f origin, direction;
};

/// How the signs that steer a walk are computed.
enum class Kernel : std::uint8_t {
  exact,       ///< float where an error bound certifies the sign, then double, then exact arithmetic
  float_only,  ///< float signs as they come: can err, but still ends, where rays meet edges and vertices
};

enum class Outcome : std::uint8_t {
  miss,     ///< the ray leaves the hull without meeting a constrained face
  hit,      ///<
  corrupt,  ///< `start` does not hold the origin, or the bytes do not describe a mesh (or float signs went in
            ///< circles): the walk was cut short
  absent,   ///< the ray starts in space that the file leaves out (FileView::partial)
};

struct Hit {
  Outcome outcome = Outcome::miss;
  bool back = false;       ///< the triangle was met from behind, against its normal (b - a) x (c - a)
  Index triangle = kNone;  ///< of the input surface (FileView::input_triangles)
  double t = std::numeric_limits<double>::infinity();  ///< in units of the ray's direction; at least 0
  double u = 0, v = 0;      ///< barycentric weights of that triangle's second and third corner; NaN where
                            ///< it was cut up and the file does not hold all of its corners
  Index side = kNone;       ///< the side that was met; twin(side) is beyond
  Index tet = kNone;        ///< the tetrahedron that the ray came through
  Index neighbor = kNone;   ///< the tetrahedron beyond the face; kNone if the file leaves it out
  std::uint32_t steps = 0;  ///< tetrahedra visited
};

/// Where a point lies, and what every ray from there needs to know. Points on the boundary between tetrahedra
/// are given to one of them. Made by `locate`.
struct Location {
  /// absent: in space that the file leaves out.
  enum class State : std::uint8_t { inside, outside, corrupt, absent } state = State::corrupt;
  Cell cell;  ///< inside: the tetrahedron
  /// Inside: the cell's vertices, ascending, are positively oriented.
  bool positive = false;
  /// Outside: the hull faces that the point sees, by which alone a ray from there can enter, in the library's
  /// own encoding. There may be more than fit: then the count is kManyEntrances, and every ray looks at all.
  std::uint16_t entrance_count = 0;
  std::array<std::uint16_t, 8> entrances{};
  static constexpr std::uint16_t kManyEntrances = 0xFFFF;
};

/// Finds the tetrahedron that contains `point` (local coordinates) by a straight walk from `from`, or from
/// the file's first source tet; constrained faces are crossed by their twins. Exact. At most tet_count + 1
/// steps. In a partial file, space that was left out may stop the walk; then the tetrahedra around are
/// searched, nearest first: O(tets log tets) time and memory at worst, which a point in left-out space always
/// costs.
Location locate(const FileView& view, Vec3f point, const Cell* from = nullptr);
Location locate(const TrustedView& view, Vec3f point, const Cell* from = nullptr);

/// The first constrained face along the ray, at t >= 0. `start` must be the origin's location; a ray that
/// starts outside enters through the hull. With a FileView every index that is followed is checked, so any
/// bytes are safe; with a TrustedView none is. Ends within tet_count + 1 steps, whatever the bytes hold.
Hit first_hit(const FileView& view, const Ray& ray, const Location& start, Kernel kernel = Kernel::exact);
Hit first_hit(const TrustedView& view, const Ray& ray, const Location& start, Kernel kernel = Kernel::exact);

}  // namespace tetfmt
