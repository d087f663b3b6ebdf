// SPDX-License-Identifier: AGPL-3.0-or-later
// Many rays through one file: walked together, or one by one for comparison.
#pragma once

#include <cstdint>
#include <span>

#include "tetfmt/batch.hpp"
#include "tetfmt/traverse.hpp"

namespace tetprep {

/// How rays are walked. The answers are the same but for those of float signs, which can err.
enum class Walks : std::uint8_t {
  together,     ///< many at a time
  one_by_one,   ///< so that the hit of every camera ray tells its steps
  float_signs,  ///< one by one, by tetfmt::Kernel::float_only
};

/// First hits of rays from one place. Returns the tetrahedra visited, each once for all rays that were in it
/// together; only walks of single rays fill in Hit::steps.
std::uint64_t first_hits(Walks walks, const tetfmt::FileView& view, const tetfmt::Location& from,
                         std::span<const tetfmt::Vec3f> directions, std::span<tetfmt::Hit> hits);

/// First hits of rays from many places.
void first_hits(Walks walks, const tetfmt::FileView& view, std::span<const tetfmt::Location> places,
                std::span<const tetfmt::BatchRay> rays, std::span<tetfmt::Hit> hits);

/// Whether anything is in the way: hit or miss, as tetfmt::occlusion has it.
void occlusions(Walks walks, const tetfmt::FileView& view, std::span<const tetfmt::Location> places,
                std::span<const tetfmt::BatchRay> rays, std::span<tetfmt::Outcome> outcomes);

/// Whether anything is between each place and `target`, on the exact line. Float signs follow a rounded one.
void occlusions(Walks walks, const tetfmt::FileView& view, std::span<const tetfmt::Location> places,
                const tetfmt::Location& target, std::span<tetfmt::Outcome> outcomes);

}  // namespace tetprep
