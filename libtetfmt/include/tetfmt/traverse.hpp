// SPDX-License-Identifier: MIT
// Rays through the tetrahedra, straight from the file's bytes. What is computed, and why it is exact, stands
// in spec/traversal.md.
//
// Aman, Demirci and Gudukbay (2022), appendix B: a ray that enters a tetrahedron across a known face learns
// the fourth vertex from the xor, projects it onto the plane orthogonal to the ray, and leaves by the face
// whose projected edges enclose the origin. Appendix D: rays start in a tetrahedron that is known, on either
// side of a face if need be, and may end in one.
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "tetfmt/types.hpp"
#include "tetfmt/validate.hpp"
#include "tetfmt/view.hpp"

namespace tetfmt {

/// Origin and direction in local coordinates (model minus the file's origin). The direction need not be of
/// unit length.
struct Ray {
  Vec3f origin, direction;
};

/// The part of a ray that counts, in units of its direction. Where an end lies exactly on a face, the tie
/// rule says on which side of it; so what lies in [a, b] and in [b, c] lies once in [a, c]. Empty if t_max <
/// t_min or either is NaN.
struct Interval {
  double t_min = 0;  ///< below 0 counts as 0
  double t_max = std::numeric_limits<double>::infinity();
};

/// How the signs that steer a walk are computed (tetfmt/kernels.hpp has more of them, for comparison).
enum class Kernel : std::uint8_t {
  exact,       ///< double where an error bound certifies the sign, exact arithmetic otherwise
  float_only,  ///< float signs as they come: can err, but still ends, where rays meet edges and vertices
};

enum class Outcome : std::uint8_t {
  miss,     ///< no constrained face in the interval
  hit,      ///< one was met
  corrupt,  ///< the start does not fit the file, or the bytes do not describe a mesh (or float signs went in
            ///< circles): the walk was cut short
  absent,   ///< the ray starts in space that the file leaves out (FileView::partial), or is there at t_min
};

/// A constrained face that a ray meets. Both of its sides are known, and both of its tetrahedra.
struct Hit {
  Outcome outcome = Outcome::miss;
  bool back = false;       ///< the triangle was met from behind, against its normal (b - a) x (c - a)
  Index triangle = kNone;  ///< of the input surface (FileView::input_triangles)
  double t = std::numeric_limits<double>::infinity();  ///< in units of the ray's direction; in the interval
  double u = 0, v = 0;      ///< barycentric weights of that triangle's second and third corner; NaN where
                            ///< it was cut up and the file does not hold all of its corners
  Index side = kNone;       ///< the side that was met; twin(side) is beyond
  Index tet = kNone;        ///< the tetrahedron that the ray came through
  Index neighbor = kNone;   ///< the tetrahedron beyond the face; kNone if the file leaves it out
  std::uint32_t steps = 0;  ///< tetrahedra visited
  double side_u = 0, side_v = 0;  ///< weights in the side's own triangle: u and v, unless triangles were cut
  std::array<Index, 3> face{};    ///< the vertices of the face that was met, ascending
};

/// A place where rays start or end, and what each of them needs to know of it: made once by `locate`,
/// `near_side` or `far_side`, then used for any number of rays. Points on the boundary between tetrahedra are
/// given to one of them.
struct Location {
  /// absent: in space that the file leaves out.
  enum class State : std::uint8_t { inside, outside, corrupt, absent } state = State::corrupt;
  std::array<double, 3> position{};  ///< local coordinates, exactly
  Cell cell;                         ///< inside: the tetrahedron
  /// Inside: the cell's vertices, ascending, are positively oriented.
  bool positive = false;
  /// On a side of a face: the rank of the cell's vertex opposite that face. The position lies in the face's
  /// plane and strictly between its edges, and is thought of as moved into the cell by an infinitesimal.
  std::uint8_t face = kNoFace;
  static constexpr std::uint8_t kNoFace = 4;
  /// Outside: the hull faces that the point sees, by which alone a ray from there can enter, in the library's
  /// own encoding. There may be more than fit: then the count is kManyEntrances, and every ray looks at all.
  std::uint16_t entrance_count = 0;
  std::array<std::uint16_t, 8> entrances{};
  static constexpr std::uint16_t kManyEntrances = 0xFFFF;
};

/// Finds the tetrahedron that contains `point` (local coordinates) by a straight walk from `from`, or from
/// the file's first source tet; constrained faces are crossed by their twins. Exact, also for points on
/// faces, edges, vertices and the hull, and outside. At most tet_count + 1 steps. In a partial file, space
/// that was left out may stop the walk; then the tetrahedra around are searched, nearest first: O(tets log
/// tets) time and memory at worst, which a point in left-out space always costs.
Location locate(const FileView& view, Vec3f point, const Cell* from = nullptr);
Location locate(const TrustedView& view, Vec3f point, const Cell* from = nullptr);

/// Where a hit's ray goes on: on the side of the face that it came from (reflected rays, shadow rays, ambient
/// occlusion), or on the side beyond (refracted rays, and what lies behind). The position is exactly in the
/// plane of the face and strictly inside of it: the hit's own point, rounded to weights of 26 bits. So no ray
/// that leaves the face meets it again, and none needs an offset; a ray from there whose direction points
/// into the face meets it at t = 0. State absent if the file leaves out what is there, corrupt if an
/// index of `hit` does not exist in this file. O(1).
Location near_side(const FileView& view, const Hit& hit);
Location far_side(const FileView& view, const Hit& hit);
inline Location near_side(const TrustedView& view, const Hit& hit) {
  return near_side(view.view(), hit);
}
inline Location far_side(const TrustedView& view, const Hit& hit) {
  return far_side(view.view(), hit);
}

/// The first constrained face that the ray from `from` along `direction` meets within the interval. A ray
/// that starts outside enters through the hull; one whose interval begins later passes through the faces
/// before. Every ray of a zero or non-finite direction, or from a non-finite point, misses. Bounded rays stop
/// soon after t_max. With a FileView every index that is followed is checked, so any bytes and any `from` are
/// safe; with a TrustedView none is, and `from` must be made for it. Ends within tet_count + 1 steps,
/// whatever the bytes hold.
Hit first_hit(const FileView& view, const Location& from, Vec3f direction, const Interval& interval = {},
              Kernel kernel = Kernel::exact);
Hit first_hit(const TrustedView& view, const Location& from, Vec3f direction, const Interval& interval = {},
              Kernel kernel = Kernel::exact);

/// First hits of many rays from one place: in a valid file each as first_hit has it, to the last bit, but for
/// Hit::steps, which stays 0. Rays are walked together, 1024 at a time: several times faster where neighbours
/// in `directions` are close, best in blocks of 16 (4 x 4 pixels), these in squares (4 x 4 blocks), and these
/// in squares again (2 x 2). Vector instructions are chosen at run time. `hits` must have the size of
/// `directions`. Returns the number of tetrahedra visited, each counted once for all rays that were in it
/// together.
std::uint64_t first_hits(const FileView& view, const Location& from, std::span<const Vec3f> directions,
                         std::span<Hit> hits);
std::uint64_t first_hits(const TrustedView& view, const Location& from, std::span<const Vec3f> directions,
                         std::span<Hit> hits);

/// Whether anything is in the way: Outcome::hit or miss (or corrupt, absent), without where.
Outcome occlusion(const FileView& view, const Location& from, Vec3f direction, const Interval& interval = {});
Outcome occlusion(const TrustedView& view, const Location& from, Vec3f direction,
                  const Interval& interval = {});

/// Whether anything lies between two places, along the exact line from one to the other (no direction is
/// rounded): a shadow ray. The walk ends in the target's tetrahedron. Two equal places see each other. On a
/// side of a face, `to` is seen from in front of that side only. What lies in space that the file leaves out
/// is hidden.
Outcome occlusion(const FileView& view, const Location& from, const Location& to);
Outcome occlusion(const TrustedView& view, const Location& from, const Location& to);

/// Whether anything lies between one place and each of many others, such as between a point light and what a
/// camera sees: each as occlusion(view, from, target) has it. Rays are walked together, 1024 at a time:
/// several times faster where neighbours in `targets` are seen from `from` in close directions, as for
/// first_hits. `outcomes` must have the size of `targets`. Returns the number of tetrahedra visited, each
/// counted once for all rays that were in it together (what no walk together can take is not counted: places
/// that are no numbers, say).
std::uint64_t occlusions(const FileView& view, const Location& from, std::span<const Location> targets,
                         std::span<Outcome> outcomes);
std::uint64_t occlusions(const TrustedView& view, const Location& from, std::span<const Location> targets,
                         std::span<Outcome> outcomes);

/// Appends every constrained face that the ray crosses within the interval, in order. Hit::steps counts from
/// the start of the ray. Between hits i and i + 1 the ray is in the region of hits[i].neighbor
/// (FileView::region_of). Returns miss if the ray was followed to the end of the interval or out of the hull;
/// absent if it ran into space that the file leaves out; corrupt.
Outcome all_hits(const FileView& view, const Location& from, Vec3f direction, std::vector<Hit>& hits,
                 const Interval& interval = {});
Outcome all_hits(const TrustedView& view, const Location& from, Vec3f direction, std::vector<Hit>& hits,
                 const Interval& interval = {});

}  // namespace tetfmt
