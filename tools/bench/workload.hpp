// SPDX-License-Identifier: AGPL-3.0-or-later
// The rays that `tet bench` times: as renderers shoot them, around one mesh.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "bench/ray_list.hpp"
#include "bench/scene.hpp"

namespace tetbench {

struct WorkloadOptions {
  int size = 1000;            ///< width and height of a view; every workload has about size x size rays
  double field_of_view = 45;  ///< degrees, across width and height
  std::uint64_t seed = 1;
};

/// Rays from surfaces start, for peers, at a point rounded to float32, and count from this far on, in
/// diagonals of the surface's bounds: what their users set as an epsilon. Ours need none.
inline constexpr double kPeerEpsilon = 1e-5;

struct WorkloadKind {
  std::string name, description;
  std::function<RayList(const Scene&, const WorkloadOptions&)> make;
};

/// The camera series first, from far to touching.
std::vector<WorkloadKind> workload_kinds();

/// The same rays in random order.
RayList shuffled(const RayList& rays, std::uint64_t seed);

}  // namespace tetbench
