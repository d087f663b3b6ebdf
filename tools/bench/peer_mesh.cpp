// SPDX-License-Identifier: AGPL-3.0-or-later
#include "bench/peer_mesh.hpp"

#include <algorithm>

namespace tetbench {

PeerMesh::PeerMesh(const tetfmt::FileView& view) {
  using tetfmt::Index;
  const auto points = view.vertices();
  std::vector<Index> place(points.size(), tetfmt::kNone);
  const auto all = view.input_triangles();
  for (Index number = 0; number < all.size(); ++number) {
    auto corners = all[number].vertices;
    if (std::any_of(corners.begin(), corners.end(), [&](Index v) { return v >= points.size(); })) continue;
    for (Index& v : corners) {
      if (place[v] == tetfmt::kNone) {
        place[v] = static_cast<Index>(vertices.size());
        vertices.push_back(points[v]);
      }
      v = place[v];
    }
    triangles.push_back(corners);
    numbers.push_back(number);
  }
}

}  // namespace tetbench
