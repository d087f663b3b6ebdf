// SPDX-License-Identifier: AGPL-3.0-or-later
// What the child process does and says. The two sides are one program, so structures go over the pipe as they
// are.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>

#include "prep/prep.hpp"

namespace tetprep {

/// Smaller than PIPE_BUF, so each arrives whole.
struct TetgenMessage {
  enum class Kind : std::uint8_t {
    stage,   ///< `text` is the name of the stage that begins
    stuck,   ///< `facets` are hard: if nothing more is heard, they are why
    failed,  ///< `text` says why
    done,    ///< the result is in the shared memory
  } kind = Kind::stage;
  double seconds = 0;  ///< since the child started
  double peak_memory_mb = 0;
  char text[112] = {};
  std::int32_t facet_count = 0;
  std::array<std::int32_t, 20> facets{};
};

/// The reason that run_tetgen() gives when an allocation fails.
inline constexpr const char* kOutOfMemory = "out of memory";

/// How to run TetGen.
struct TetgenCall {
  std::string switches;
  bool may_cut = false;           ///< points may stay on triangles of the surface
  std::uint64_t most_memory = 0;  ///< bytes of address space that it may add to what it starts with; 0: any
};

/// First in the shared memory; the arrays of TetgenMesh follow.
struct TetgenSizes {
  std::uint64_t points = 0, tets = 0;
};

/// Runs TetGen stage by stage. Returns when the result is written or a failure told; may also crash, never
/// return, or use all memory, which is why it has a process of its own. Never throws.
void run_tetgen(std::span<const GridPoint> points, std::span<const std::array<Index, 3>> facets,
                const TetgenCall& call, int messages, int result) noexcept;

}  // namespace tetprep
