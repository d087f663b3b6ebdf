// SPDX-License-Identifier: MIT
// Compact cells to explicit tetrahedra, by walking from the source tets.
#pragma once

#include "tetfmt/error.hpp"
#include "tetfmt/mesh.hpp"
#include "tetfmt/view.hpp"

namespace tetfmt {

/// The mesh that a file holds. Safe on untrusted bytes: checks Level::topology on the way and returns the
/// first problem. O(tets) time; memory is 38 bytes a tet plus the mesh's other arrays.
/// Holds what the required sections and META say: materials (MATL) and sections of later versions are not
/// kept.
Result<Mesh> reconstruct(const FileView& view);

}  // namespace tetfmt
