// SPDX-License-Identifier: AGPL-3.0-or-later
// A replacement for one stage of TetGen.
#pragma once

#define TETLIBRARY  // errors are thrown, not printed before exit()
#include <tetgen.h>

#include <functional>
#include <vector>

namespace tetprep {

/// Whether points that had to be put on the surface may stay there.
enum class OnSurface {
  remove,  ///< where flips can do that; the others are left in subvertstack for suppresssteinerpoints()
  keep,    ///< they cut triangles, and much less can go wrong
};

/// Makes every edge and then every triangle of the surface one of the tetrahedralisation, or several where
/// points have to be put on them. Takes the place of tetgenmesh::recoverboundary(), with the same outcome
/// where that one works. `stuck` is told the facets (numbers from 0, at most 20) that are still missing
/// before each step that may not survive them.
void recover_boundary(tetgenmesh& mesh, OnSurface points,
                      const std::function<void(const std::vector<int>&)>& stuck);

}  // namespace tetprep
