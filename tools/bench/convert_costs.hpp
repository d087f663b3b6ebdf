// SPDX-License-Identifier: AGPL-3.0-or-later
// What converting costs, stage by stage, with each effort of optimising.
#pragma once

#include <string>
#include <vector>

#include "common/progress.hpp"

namespace tetbench {

struct StageSeconds {
  std::string name;  ///< those of TetGen, which are part of "tetrahedralize", begin with "tetgen: "
  std::vector<double> seconds;
};

/// One mesh, converted several times with one effort.
struct ConvertCost {
  std::string file, optimize;
  std::size_t triangles = 0, tets = 0;
  std::vector<double> seconds;                   ///< in all, by the clock
  std::vector<double> tetgen, reduce_crossings;  ///< seconds of these two
  double area_before = 0, area_after = 0;  ///< of unconstrained faces, in areas of the box: what rays cross
  double peak_memory_mb = 0;
  std::vector<StageSeconds> stages;
};

/// Converts each mesh `repeats` times with each effort (none, fast, best), in turn, by one thread beside
/// TetGen's process, into a folder for temporary files that is removed. Throws
/// Failure as a conversion does; for a mesh that cannot be read, before the first conversion.
std::vector<ConvertCost> convert_costs(const std::vector<std::string>& meshes, int repeats,
                                       tetprep::Progress& progress);

std::string convert_table(const std::vector<ConvertCost>& costs, int repeats);
std::string convert_csv(const std::vector<ConvertCost>& costs);
std::string convert_json(const std::vector<ConvertCost>& costs, int repeats);

}  // namespace tetbench
