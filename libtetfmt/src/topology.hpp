// SPDX-License-Identifier: MIT
#pragma once

#include <array>
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
  /// Of each tetrahedron, 1 or -1: the orientation that its vertices, ascending, must have for every
  /// neighbour to lie on the other side of the shared face, up to one common sign for all.
  std::vector<std::int8_t> orientation;
  /// Pairs of neighbours for which no such choice exists (the gluing is not orientable).
  std::vector<std::array<Index, 2>> twisted;
};

/// Level::topology: recovers every tetrahedron from the source tets and checks each reference from both ends.
/// Adds what is wrong to `report`; the result may be relied upon only if it stays valid.
/// O(tets + sides + hull log hull) time, 38 bytes a tet.
Topology check_topology(const FileView& view, Report& report);

}  // namespace tetfmt::detail
