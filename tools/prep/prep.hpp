// SPDX-License-Identifier: AGPL-3.0-or-later
// The converter's types, in the order in which data flows (each arrow is one function in one file):
//
//   TriangleSoup -> CleanSurface -> CleanSurface -> TetMesh -> tetfmt::Mesh -> bytes -> file
//     read_soup      snap            resolve        tetrahedralize  order    encode   convert (pipeline.cpp)
//
// Every type's maker establishes its invariants; later stages do not re-check them. All functions throw
// tetprep::Failure with one line in terms of the input (triangle numbers, coordinates, file:line).
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "common/failure.hpp"
#include "common/progress.hpp"
#include "prep/appearance.hpp"
#include "prep/stage_log.hpp"
#include "tetfmt/mesh.hpp"
#include "tetfmt/orientation.hpp"

namespace tetprep {

/// model = origin + coordinates * 2^grid_exponent, exactly. No coordinate exceeds kMaxCoordinate in size, so
/// two points differ by at most 2^24 and tetfmt::orientation is exact.
using GridPoint = tetfmt::GridPoint;
inline constexpr std::int32_t kMaxCoordinate = 1 << 23;

using Point = std::array<double, 3>;

/// What a mesh file says, polygons triangulated. Invariant: at least one triangle, every index in range,
/// every coordinate that a triangle uses finite. `triangles` are in file order: their positions are the
/// "input triangle" numbers of everything that follows.
struct TriangleSoup {
  std::vector<Point> points;
  std::vector<std::array<Index, 3>> triangles;
  Appearance appearance{};
  std::vector<std::string> warnings{};  ///< what was read over: "file:line: what, and what was done"
};

/// The surface on a uniform power-of-two grid: no two points equal, every point used, no degenerate and no
/// repeated triangle (in any orientation). Triangles may still intersect; after resolve() none does.
struct CleanSurface {
  Point origin{};
  int grid_exponent = 0;
  std::vector<GridPoint> points;                ///< in order of first use
  std::vector<std::array<Index, 3>> triangles;  ///< corner order of the input
  std::vector<Index> input_triangle;            ///< of each triangle, ascending; pieces of one share theirs
  /// Empty, or (if some triangles were cut) the corners of every input triangle, kNone x 3 for those that
  /// were dropped by snap().
  std::vector<std::array<Index, 3>> input_corners;
  Index input_triangle_count = 0;
  Index merged_points = 0, degenerate_triangles = 0, duplicate_triangles = 0;
  double max_deviation = 0;  ///< largest distance that snapping moved a point, model units; 0: none moved
};

/// A constrained tetrahedralisation of a box around the surface, on the same grid. Positively or negatively
/// oriented tets alike, none flat; no order of anything is promised.
struct TetMesh {
  Point origin{};
  int grid_exponent = 0;
  std::vector<GridPoint> points;  ///< the surface's points first, then the box's eight, then Steiner points
  std::vector<std::array<Index, 4>> tets;
  std::vector<std::array<Index, 4>> neighbors;  ///< across the face opposite each vertex; kNone at the hull
  /// CleanSurface triangle on that face, or kNone. With a triangle but without a neighbor: one-sided, the
  /// space beyond was left out.
  std::vector<std::array<Index, 4>> face_triangle;
  /// Of each tet, or empty: not known yet (regions.hpp). 0 is the space around everything.
  std::vector<Index> region;
};

/// Two triangles of a CleanSurface, the smaller number first.
using TrianglePair = std::pair<Index, Index>;

/// Thrown by tetrahedralize() for a surface that intersects itself: what resolve() wants to know.
struct Intersecting {
  std::vector<TrianglePair> pairs;  ///< all of them, ascending, or IntersectionSearch::kMostPairs
};

/// Thrown by tetrahedralize() where TetGen has tetrahedra, but some of its points have no place on the finest
/// grid that there is: the surface is crowded at the scale of its grid. On a coarser grid it is not.
struct NoRoomOnGrid : Failure {
  using Failure::Failure;
};

/// One run of the tetrahedraliser that did not lead to a result.
struct FailedAttempt {
  std::string switches, reason;
};

struct TetrahedralizeOptions {
  double radius_edge = 5;          ///< bound on circumradius / shortest edge; 0 for none
  double time_limit = 0;           ///< seconds an attempt may take; 0 chooses by the number of triangles
  std::uint64_t memory_limit = 0;  ///< bytes that TetGen may use beside its input; 0: no limit
  unsigned threads = 1;            ///< for the search for intersections, which runs beside TetGen
};

/// What happened on the way to a TetMesh.
struct TetrahedralizeReport {
  std::string switches;  ///< TetGen's, of the attempt that succeeded
  std::vector<FailedAttempt> failed_attempts;
  std::size_t intersection_count = 0;  ///< pairs of triangles, if tetrahedralize() threw Intersecting
  std::vector<std::array<Index, 2>> intersections;  ///< the first 10,000 of them, numbers of the input
  /// Triangles of the surface (its numbers) that the last failed attempt got stuck at, as far as known: those
  /// to mark in a debug mesh.
  std::vector<Index> suspects;
  int grid_refinement = 0;   ///< the surface's grid has 2^this steps now to one that it had
  Index cut_triangles = 0;   ///< of the surface, that TetGen had to put points on
  double cut_deviation = 0;  ///< largest distance of those points from their triangles, model units
  Index steiner_points = 0;
  Index moved_steiner_points =
      0;                      ///< those that could not stay at the grid point nearest to TetGen's position
  double tetgen_seconds = 0;  ///< of the attempt that succeeded, from first stage to last
};

/// Reads .obj (with .mtl), .off, .ply (ascii and binary), .stl (both), .drc, .gltf and .glb by their
/// extension; polygons are cut into triangles. Failure: io (cannot be read), invalid (contents), unsupported
/// (unknown extension, or sound contents that cannot be used).
TriangleSoup read_soup(const std::string& path);

/// One scene of several: triangles, materials, objects and warnings one after the other, in order.
/// Point attributes that only some of them have are NaN elsewhere. `soups` must not be empty.
TriangleSoup merge_soups(std::vector<TriangleSoup> soups);

/// Puts the surface on a power-of-two grid of about 2^21 steps over its extent. If all coordinates lie on
/// such a grid already (of at most 2^22 steps), none changes by a bit. `coarser_bits`: of about
/// 2^(21 - coarser_bits) steps instead, whatever the coordinates are. Failure (invalid): nothing with an area
/// is left; (unsupported): coordinates too large or too small for float32. O(n log n).
CleanSurface snap(const TriangleSoup& soup, int coarser_bits = 0);

/// Encloses the surface in a box and fills it with tetrahedra, among whose faces is every triangle as it is.
/// `surface` changes only where there is no other way, and the result is about what it is then: its grid may
/// be 2, 4 or 8 times finer (the same points on it), and where TetGen has to put points on triangles these
/// are cut there (the report says how many; the new points are rounded to the grid, and `report` has their
/// largest distance). Throws Intersecting if triangles intersect (`report` lists them by input number).
/// Failure: runtime (TetGen died, or ran out of time or memory, with every choice of switches; NoRoomOnGrid
/// if one of them failed for want of room only). The result is checked: exact orientation of every tet, every
/// triangle there, the hull is the box.
TetMesh tetrahedralize(CleanSurface& surface, const TetrahedralizeOptions& options, Progress& progress,
                       StageLog& log, TetrahedralizeReport& report);

/// Puts the tets in order along a Hilbert curve: what is near each other in space then is in memory, for
/// every stage that follows and for the rays. Deterministic for any number of threads. O(tets log tets).
void sort_tets(TetMesh& mesh);

/// Puts everything into the file's terms: vertices along a Hilbert curve (those of some tet), tets as they
/// come, faces as the tets need them. The first source tet is the one that contains the box's centre: walks
/// to anywhere start there, and from the middle they are shortest on average. Where that space was left out
/// it is the tet nearest to it; and if what is left is in several pieces, each of the others has a source too
/// (its first tet). `triangle_material`: of each input triangle, or empty: all 0. Sections, in this order:
/// REGN if the regions are known (the tets must be grouped by them); BNDS; ORIG and SURF if triangles were
/// cut. Deterministic for any number of threads. O(tets + vertices log vertices).
tetfmt::Mesh order(const TetMesh& mesh, const CleanSurface& surface,
                   std::span<const Index> triangle_material = {});

}  // namespace tetprep
