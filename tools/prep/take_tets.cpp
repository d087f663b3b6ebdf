// SPDX-License-Identifier: AGPL-3.0-or-later
#include "prep/take_tets.hpp"

#include <tbb/parallel_for.h>

namespace tetprep {
namespace {

template <class T>
void take(std::vector<T>& values, const std::vector<Index>& chosen) {
  if (values.empty()) return;
  std::vector<T> taken(chosen.size());
  tbb::parallel_for(std::size_t{0}, chosen.size(), [&](std::size_t i) { taken[i] = values[chosen[i]]; });
  values.swap(taken);
}

}  // namespace

void take_tets(TetMesh& mesh, const std::vector<Index>& chosen) {
  std::vector<Index> new_number(mesh.tets.size(), kNone);
  tbb::parallel_for(std::size_t{0}, chosen.size(),
                    [&](std::size_t i) { new_number[chosen[i]] = static_cast<Index>(i); });
  take(mesh.tets, chosen);
  take(mesh.neighbors, chosen);
  take(mesh.face_triangle, chosen);
  take(mesh.region, chosen);
  tbb::parallel_for(std::size_t{0}, mesh.neighbors.size(), [&](std::size_t t) {
    for (Index& neighbor : mesh.neighbors[t])
      if (neighbor != kNone) neighbor = new_number[neighbor];
  });
}

}  // namespace tetprep
