// SPDX-License-Identifier: MIT
// Walks of many unrelated rays, side by side: a lane each (spec/traversal.md, section 10a).
//
// The lanes lie in memory, coordinate by coordinate. `advance` takes all of them some tetrahedra further;
// those that come to something else (a face, the hull, their end) wait there for what follows, which is one
// ray's business. Signs are certified in float32; the few that are not are asked of the exact predicates,
// lane by lane.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "predicates.hpp"
#include "tetfmt/traverse.hpp"

namespace tetfmt::detail {

inline constexpr std::size_t kLanes = 64;

template <class T>
using PerLane = std::array<T, kLanes>;

/// A set of lanes: bit i is lane i.
using LaneMask = std::uint64_t;

/// Walks, each about to enter the tetrahedron `ref` through the face of corners 0, 1, 2, crossed
/// counter-clockwise. Nothing but numbers of four bytes, so that a walk can be moved without naming them all.
struct alignas(64) Walks {
  std::array<PerLane<float>, 3> x, y;  ///< the corners as projected (signs.hpp)
  std::array<PerLane<float>, 3> z;     ///< and their depth along the ray's main axis
  std::array<PerLane<Index>, 3> ids;
  PerLane<Ref> ref;
  PerLane<Index> apex;  ///< the tetrahedron's fourth vertex; any that exists where `ref` is no tetrahedron
  PerLane<Index> tet;   ///< where the walk comes from: what the tetrahedron knows its entry face by

  // Of the ray. Axes in the order i, j, k of ShearProjection.
  std::array<PerLane<float>, 3> origin;
  PerLane<float> slope_i, slope_j;
  PerLane<float> sign_k;  ///< 1 or -1: whether the ray goes up or down its main axis
  PerLane<float> error;   ///< a cross product is certain beyond error (|x| + |y| of both points) + square
  PerLane<float> square;
  PerLane<float> limit;         ///< the depth beyond which the ray has certainly ended
  PerLane<std::uint32_t> axes;  ///< k; or k + 3, with i and j swapped
  PerLane<Index> target;        ///< the tetrahedron in which the ray ends; kNone: in none
  PerLane<std::uint32_t> ray;   ///< its number in the batch
};

/// The walks under way.
struct Lanes : Walks {
  PerLane<Ref> previous;  ///< by what the walk entered `tet`

  // From one half of a step to the other.
  PerLane<Index> edges;             ///< ids[0] ^ ids[1] ^ ids[2]
  PerLane<Index> cell;              ///< where among the cells' words that of `ref` begins, if there is one
  PerLane<Index> at;                ///< where among the cells' words `ref` is found
  PerLane<Index> at_entry;          ///< of 16-byte cells also this word
  PerLane<Index> keep, keep_entry;  ///< and what counts of the two: all bits or none

  /// Moves the bytes of (anything, x, y, z) to (anything, i, j, k). In the order in which corners are loaded:
  /// shuffle_slot().
  alignas(64) std::array<std::array<std::uint8_t, 16>, kLanes> shuffle;
  LaneMask walking = 0;  ///< lanes whose walks go on
};

/// Walks that are to begin.
struct Starts : Walks {
  // Given, with ids, ref, apex, tet, target, ray:
  std::array<PerLane<float>, 3> position, direction;  ///< rounded
  PerLane<float> t_max;
  enum Kind : std::uint32_t {
    known,    ///< the ray goes through the face
    on_face,  ///< it starts on the face, and may not leave it
    within,   ///< it starts in the tetrahedron `ref`, whose vertices are ids and apex, ascending
  };
  PerLane<std::uint32_t> kind;
  PerLane<std::uint32_t> positive;  ///< within: all bits if the vertices are positively oriented, or none

  /// Found, with all the rest:
  enum Status : std::uint32_t {
    exit0,  ///< within: the ray leaves opposite ids[0]; and so on
    exit1,
    exit2,
    exit3,
    ready,
    unsure,   ///< float32 cannot tell whether the ray leaves its face, or where its tetrahedron
    unusual,  ///< no direction, far too large or small, or not a number
  };
  PerLane<std::uint32_t> status;
};

/// The rays exactly, for signs that float32 does not certify.
class Lines {
 public:
  virtual Line line(std::uint32_t ray) const = 0;

 protected:
  ~Lines() = default;
};

/// What became of lanes that were walking, and wait now.
struct Waiting {
  LaneMask arrived = 0;  ///< at a constrained face, at the hull, or before their target: see Lanes::ref
  LaneMask ended = 0;    ///< certainly beyond their limit
  LaneMask corrupt = 0;  ///< an index does not exist
};

/// Takes all walking lanes further. The view must have fewer than kMaxBatchTets tetrahedra.
using Advance = Waiting (*)(const FileView& view, const Lines& lines, Lanes& lanes);
inline constexpr Index kMaxBatchTets = (Index{1} << 31) / 5;

/// Fills in what is not given. All ids must exist, also those of starts that are not used.
using Prepare = void (*)(const FileView& view, Starts& starts);

/// Compiled for one kind of processor. Without vectors there is nothing to call: rays are walked one by one.
struct BatchTarget {
  const char* name;
  std::size_t width;  ///< lanes in a vector
  Prepare prepare;
  Advance advance;
};

/// Those that this processor can run, best first; never empty.
std::span<const BatchTarget> batch_targets();

/// Where in Lanes::shuffle a lane's is, with vectors of this many lanes: a vector's lanes 4 l + q are in the
/// order of q, then l, as the transpose of four corners at a time has it.
constexpr std::size_t shuffle_slot(std::size_t lane, std::size_t width) {
  const std::size_t in_vector = lane % width;
  return lane - in_vector + in_vector % 4 * (width / 4) + in_vector / 4;
}

}  // namespace tetfmt::detail
