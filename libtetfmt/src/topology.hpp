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
  /// neighbour to lie on the other side of the shared face, up to one common sign for each component.
  std::vector<std::int8_t> orientation;
  /// The tetrahedra in the order in which they were reached, component after component.
  std::vector<Index> order;
  /// Where in `order` each component begins: what one source reaches and none before it. Whole meshes have
  /// one; where tetrahedra were left out there may be several.
  std::vector<std::size_t> components;
  /// Pairs of neighbours for which no such choice exists (the gluing is not orientable).
  std::vector<std::array<Index, 2>> twisted;
};

/// Level::topology: recovers every tetrahedron from the source tets and checks each reference from both ends.
/// Adds what is wrong to `report`; the result may be relied upon only if it stays valid.
/// O(tets + sides + hull log hull) time, 42 bytes a tet.
Topology check_topology(const FileView& view, Report& report);

}  // namespace tetfmt::detail
