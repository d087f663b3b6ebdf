// SPDX-License-Identifier: MIT
// Mesh to bytes: the reference encoding of spec/format.md.
#pragma once

#include <cstddef>
#include <vector>

#include "tetfmt/layout.hpp"
#include "tetfmt/mesh.hpp"

namespace tetfmt {

/// The whole file as bytes, ready to be written. The same mesh and layout give the same bytes everywhere.
/// Derives what the mesh does not hold: xors, the hull list, the grid exponent, hashes. O(file size).
/// `mesh` must satisfy the invariants of Mesh; they are not checked here (validate the result).
std::vector<std::byte> encode(const Mesh& mesh, Layout layout);

/// Recomputes every hash of a file in place, after a deliberate edit of its bytes (tests, repair tools).
/// Reads only as far as the structure makes sense; leaves malformed bytes alone.
void rehash(std::vector<std::byte>& bytes);

}  // namespace tetfmt
