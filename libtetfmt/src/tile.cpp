// SPDX-License-Identifier: MIT
// Compiled once for each kind of processor, by Highway's headers; which one runs is chosen here, so that
// nothing of Highway is needed to link.
#include "tile.hpp"

#include "processor.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "tile.cpp"
#include <hwy/foreach_target.h>
//
#include <hwy/highway.h>

#include <vector>

#include "tile_tasks.hpp"
#include "tile_walk.hpp"

HWY_BEFORE_NAMESPACE();
namespace tetfmt::detail {
namespace HWY_NAMESPACE {

/// One a thread, of some 0.4 MB, kept for the next tile.
Queue& queue_of_thread() {
  static thread_local Queue queue;
  if (!queue.idle()) queue.clear();  // a walk before was cut short by an exception
  return queue;
}

template <bool kChecked, class Task>
std::uint64_t walk_tile(const FileView& view, const Location& from, Task&& task) {
  Queue& queue = queue_of_thread();
  return with_cells(view, [&](const auto& cells) {
    using Cells = std::remove_cvref_t<decltype(cells)>;
    return TileWalk<kChecked, Cells, std::remove_cvref_t<Task>>(view, cells, from, task, queue).run();
  });
}

template <bool kChecked>
constexpr TileTracers kTracers = {
    [](const FileView& view, const Location& from, std::span<const Vec3f> directions, std::span<Hit> hits) {
      return walk_tile<kChecked>(view, from, FirstHitsTask(view, from, directions, hits));
    },
    [](const FileView& view, const Location& from, std::span<const Location> targets,
       std::span<Outcome> outcomes) {
      return walk_tile<kChecked>(view, from, OcclusionsTask(view, from, targets, outcomes));
    }};

constexpr TileTarget kTarget = {HWY_STR(HWY_NAMESPACE), kTracers<true>, kTracers<false>};

}  // namespace HWY_NAMESPACE
}  // namespace tetfmt::detail
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace tetfmt::detail {

std::span<const TileTarget> tile_targets() {
  static const std::vector<TileTarget> targets = [] {
    std::vector<TileTarget> found;
#if HWY_TARGETS & HWY_AVX3
    if (has_avx512()) found.push_back(N_AVX3::kTarget);
#endif
#if HWY_TARGETS & HWY_AVX2
    if (has_avx2()) found.push_back(N_AVX2::kTarget);
#endif
#if HWY_TARGETS & HWY_SSE4
    if (has_sse4()) found.push_back(N_SSE4::kTarget);
#endif
    found.push_back(HWY_NAMESPACE::kTarget);  // what the compiler assumes anyway: the last one compiled
    return found;
  }();
  return targets;
}

}  // namespace tetfmt::detail
#endif
