// SPDX-License-Identifier: MIT
// Compact cells to explicit tetrahedra, by walking from the source tets.
#pragma once

#include "tetfmt/error.hpp"
#include "tetfmt/mesh.hpp"
#include "tetfmt/view.hpp"

namespace tetfmt {

/// The mesh that a file holds. Safe on untrusted bytes: checks Level::topology on the way and returns the
/// first problem. O(tets) time; memory is 38 bytes a tet plus the mesh's other arrays.
/// Keeps every section that this version knows, and the unknown ones that are raw and safe to copy; encode()
/// puts them after the others, in the order that they had.
Result<Mesh> reconstruct(const FileView& view);

}  // namespace tetfmt
