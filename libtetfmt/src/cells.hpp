// SPDX-License-Identifier: MIT
// The two cell layouts behind one small interface. "rank" is a vertex's place among the four ids, ascending.
#pragma once

#include <array>
#include <cstddef>
#include <span>

#include "tetfmt/layout.hpp"
#include "tetfmt/view.hpp"

namespace tetfmt::detail {

/// How many of three ids are smaller: the rank of `id` in a tetrahedron of these four.
constexpr std::size_t rank(Index id, Index a, Index b, Index c) {
  return static_cast<std::size_t>(id > a) + static_cast<std::size_t>(id > b) +
         static_cast<std::size_t>(id > c);
}

struct Tet20Cells {
  static constexpr bool kNeedsEntryRank = false;
  std::span<const Tet20> cells;
  Index vertex_xor(Index tet) const { return cells[tet].vertex_xor; }
  Ref next(Index tet, Ref, std::size_t, std::size_t exit_rank) const {
    return cells[tet].neighbors[exit_rank];
  }
  std::array<Ref, 4> neighbors(Index tet, Ref, std::size_t) const { return cells[tet].neighbors; }
};

/// A ray that came from `previous` knows one neighbour, the one opposite the vertex it just met (whose rank
/// is `entry_rank`); the xors give the others (appendix A, with its example corrected).
struct Tet16Cells {
  static constexpr bool kNeedsEntryRank = true;
  std::span<const Tet16> cells;
  Index vertex_xor(Index tet) const { return cells[tet].vertex_xor; }
  Ref next(Index tet, Ref previous, std::size_t entry_rank, std::size_t exit_rank) const {
    const auto& nx = cells[tet].neighbor_xor;
    Ref ref = previous;
    if (entry_rank != 3) ref ^= nx[entry_rank];
    if (exit_rank != 3) ref ^= nx[exit_rank];
    return ref;
  }
  std::array<Ref, 4> neighbors(Index tet, Ref previous, std::size_t entry_rank) const {
    const auto& nx = cells[tet].neighbor_xor;
    const Ref last = entry_rank == 3 ? previous : previous ^ nx[entry_rank];
    return {nx[0] ^ last, nx[1] ^ last, nx[2] ^ last, last};
  }
};

/// Calls `function` with the cells of the view's layout.
template <class Function>
auto with_cells(const FileView& view, Function&& function) {
  if (view.layout() == Layout::tet20) return function(Tet20Cells{view.tets20()});
  return function(Tet16Cells{view.tets16()});
}

/// The face opposite the vertex of this rank: the other three ids, ascending.
constexpr std::array<Index, 3> face_opposite(const std::array<Index, 4>& vertices, std::size_t opposite) {
  std::array<Index, 3> face{};
  for (std::size_t k = 0, n = 0; k < 4; ++k)
    if (k != opposite) face[n++] = vertices[k];
  return face;
}

/// `face` (ascending) and the apex that completes it, which gets rank `apex_rank`.
constexpr std::array<Index, 4> insert_apex(const std::array<Index, 3>& face, Index apex,
                                           std::size_t apex_rank) {
  std::array<Index, 4> vertices{};
  for (std::size_t k = 0, n = 0; k < 4; ++k) vertices[k] = k == apex_rank ? apex : face[n++];
  return vertices;
}

}  // namespace tetfmt::detail
