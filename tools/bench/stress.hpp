// SPDX-License-Identifier: AGPL-3.0-or-later
// The stress test: every kernel, layout and kind of ray against exact arithmetic.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "bench/rays.hpp"
#include "bench/tally.hpp"
#include "common/progress.hpp"

namespace tetbench {

struct StressOptions {
  std::uint64_t rays = 4'000'000;  ///< in all, over all files and sets
  std::uint64_t seed = 1;
  int threads = 0;                ///< 0: all
  std::vector<std::string> sets;  ///< names; empty: all
};

/// Rays of one set around one file.
struct StressRow {
  std::string file, set;
  Tally tally;
};

struct StressMesh {
  std::string file;
  std::size_t triangles = 0, faces = 0, tets = 0;
  bool closed = false;
};

struct StressResult {
  std::vector<StressMesh> meshes;
  std::vector<StressRow> rows;  ///< by file, then by set
  double seconds = 0;           ///< from start to end
  /// Of all rows, or of those of one set.
  Tally total(const std::string& set = {}) const;
};

/// The sets wanted; all for an empty list. Throws Failure (usage) for a name that there is not.
std::vector<RaySet> chosen_sets(const std::vector<std::string>& names);

/// Runs the sets on the files, one file after the other. Counts and reproducers are the same for any number
/// of threads. Throws Failure for files that cannot be tested (Scene).
StressResult stress(const std::vector<std::string>& files, const StressOptions& options,
                    tetprep::Progress& progress);

/// The result as text for people, one row a file and set, totals and reproducers; as CSV; as JSON.
std::string stress_table(const StressResult& result, const StressOptions& options);
std::string stress_csv(const StressResult& result);
std::string stress_json(const StressResult& result, const StressOptions& options);

}  // namespace tetbench
