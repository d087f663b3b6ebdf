// SPDX-License-Identifier: AGPL-3.0-or-later
// A replacement for one stage of TetGen.
#pragma once

#define TETLIBRARY  // errors are thrown, not printed before exit()
#include <tetgen.h>

namespace tetprep {

/// Adds points where tets are large and have a radius-edge ratio above options.minratio: they shorten the
/// ways of rays. Takes the place of tetgenmesh::delaunayrefinement() for a boundary that must not be split
/// (-Y); the mesh must have passed recoverdelaunay(). At most 300 points and one more per 100 triangles.
void refine_empty_space(tetgenmesh& mesh);

}  // namespace tetprep
