// SPDX-License-Identifier: AGPL-3.0-or-later
#include "prep/box.hpp"
#include "prep/hilbert_sort.hpp"
#include "prep/take_tets.hpp"

namespace tetprep {

void sort_tets(TetMesh& mesh) {
  const Box box = bounds_of(mesh.points);
  take_tets(mesh, hilbert_sort(mesh.tets.size(), box.extent(), [&](std::size_t t) {
              std::array<std::int64_t, 3> middle{};
              for (std::size_t k = 0; k < 3; ++k) {
                for (const Index v : mesh.tets[t]) middle[k] += mesh.points[v][k] - box.low[k];
                middle[k] /= 4;
              }
              return middle;
            }));
}

}  // namespace tetprep
