// SPDX-License-Identifier: MIT
// Many rays that have nothing in common: other places, any directions, in any order. They are walked side by
// side, each along its own path, by vector instructions that are chosen at run time. What each answer is, and
// that it is exact, stands in tetfmt/traverse.hpp: the answers are those of one ray at a time, to the last
// bit. (Rays from one place share more: first_hits.)
#pragma once

#include <cstdint>
#include <span>

#include "tetfmt/traverse.hpp"

namespace tetfmt {

struct BatchRay {
  std::uint32_t from = 0;  ///< position in the batch's list of places
  Vec3f direction;
  Interval interval;
};

/// A segment between two of a batch's places.
struct BatchSegment {
  std::uint32_t from = 0, to = 0;
};

/// The first hit of each ray: in a valid file as first_hit has it, to the last bit, but for Hit::steps, which
/// stays 0. `hits` must have the size of `rays`. A position in `places` that does not exist gives
/// Outcome::corrupt, here and below.
void trace_batch(const FileView& view, std::span<const Location> places, std::span<const BatchRay> rays,
                 std::span<Hit> hits);
void trace_batch(const TrustedView& view, std::span<const Location> places, std::span<const BatchRay> rays,
                 std::span<Hit> hits);

/// Whether anything is in the way of each ray, as occlusion() has it.
void occlude_batch(const FileView& view, std::span<const Location> places, std::span<const BatchRay> rays,
                   std::span<Outcome> outcomes);
void occlude_batch(const TrustedView& view, std::span<const Location> places, std::span<const BatchRay> rays,
                   std::span<Outcome> outcomes);

/// Whether anything lies between the places of each pair, as occlusion() has it.
void occlude_batch(const FileView& view, std::span<const Location> places,
                   std::span<const BatchSegment> segments, std::span<Outcome> outcomes);
void occlude_batch(const TrustedView& view, std::span<const Location> places,
                   std::span<const BatchSegment> segments, std::span<Outcome> outcomes);

}  // namespace tetfmt
