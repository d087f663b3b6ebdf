// SPDX-License-Identifier: AGPL-3.0-or-later
// One run of TetGen in a process of its own: its crashes, hangs and leaks end there.
#pragma once

#include <sys/types.h>

#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "prep/prep.hpp"
#include "prep/tetgen_stages.hpp"

namespace tetprep {

/// What TetGen made: plain arrays in memory that the child shared before it ended.
class TetgenMesh {
 public:
  /// Maps the memory behind `descriptor` (as write_mesh() of tetgen_child.cpp laid it out) and closes it.
  explicit TetgenMesh(int descriptor);
  TetgenMesh(TetgenMesh&& other) noexcept;
  TetgenMesh& operator=(TetgenMesh&&) = delete;
  ~TetgenMesh();

  std::span<const Point> points;  ///< the input's, as TetGen left them, then Steiner points
  std::span<const std::array<Index, 4>> tets;
  std::span<const std::array<Index, 4>> neighbors;  ///< across the face opposite each vertex, kNone for none
  std::span<const std::array<Index, 4>> facets;  ///< the facet that TetGen says that face is, kNone for none

 private:
  void* memory_ = nullptr;
  std::size_t bytes_ = 0;
};

/// Starts TetGen on points and triangular facets, and watches it.
class TetgenChild {
 public:
  /// Forks. The child uses nothing but memory and TetGen; it must not be started while another thread of this
  /// process may hold a lock (glibc's allocator, which takes care of itself, aside).
  TetgenChild(std::span<const GridPoint> points, std::span<const std::array<Index, 3>> facets,
              const TetgenCall& call);
  /// Kills the child if it still runs.
  ~TetgenChild();
  TetgenChild(const TetgenChild&) = delete;
  TetgenChild& operator=(const TetgenChild&) = delete;

  struct Outcome {
    std::unique_ptr<TetgenMesh> mesh;  ///< null if there is none
    std::string reason;                ///< then: why, in a few words; empty if `give_up` said so
    std::string stage;                 ///< the last that began
    std::vector<Index> stuck;          ///< facets that it had trouble with, the latest
    std::vector<StageCost> stages;     ///< TetGen's own
  };

  /// Waits for the end, at most `seconds`. Asks `give_up` a few times a second, and kills the child on true.
  Outcome wait(double seconds, Progress& progress, const std::function<bool()>& give_up);

  pid_t pid() const { return pid_; }

 private:
  void kill_and_reap();

  std::size_t points_ = 0;
  std::uint64_t memory_limit_ = 0;
  pid_t pid_ = -1;
  int messages_ = -1;  ///< read end of the pipe
  int result_ = -1;    ///< the shared memory
};

}  // namespace tetprep
