// SPDX-License-Identifier: AGPL-3.0-or-later
// How many threads a piece of work may use.
#pragma once

#include <tbb/global_control.h>
#include <tbb/info.h>
#include <tbb/task_arena.h>

namespace tetprep {

inline constexpr int kMaxThreads = 1024;

/// `wanted`, or as many as the machine runs at once if that is 0.
inline int thread_count(int wanted) {
  return wanted > 0 ? wanted : tbb::info::default_concurrency();
}

/// Calls `work` in an arena of thread_count(wanted) threads: what it parallelises by oneTBB uses no more.
/// More threads than processors are created if asked for.
template <class Work>
void with_threads(int wanted, Work&& work) {
  const int threads = thread_count(wanted);
  const tbb::global_control limit(tbb::global_control::max_allowed_parallelism,
                                  static_cast<std::size_t>(threads));
  tbb::task_arena(threads).execute(work);
}

}  // namespace tetprep
