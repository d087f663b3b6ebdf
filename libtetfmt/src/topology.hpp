// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <vector>

#include "tetfmt/mesh.hpp"
#include "tetfmt/validate.hpp"
#include "tetfmt/view.hpp"

namespace tetfmt::detail {

/// What a walk over all tetrahedra finds out.
struct Topology {
  std::vector<FullTet> tets;
  /// Of each side: the rank, within its tetrahedron, of the vertex opposite the constrained face.
  std::vector<std::uint8_t> side_rank;
};

/// Level::topology: recovers every tetrahedron from the source tets and checks each reference from both ends.
/// Adds what is wrong to `report`; the result may be relied upon only if it stays valid.
/// O(tets + sides + hull log hull) time, 32 bytes a tet plus 4 for the queue.
Topology check_topology(const FileView& view, Report& report);

}  // namespace tetfmt::detail
