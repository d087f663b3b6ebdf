// SPDX-License-Identifier: AGPL-3.0-or-later
// Carries out what a ConeFinder found.
#pragma once

#include <vector>

#include "prep/cone_finder.hpp"

namespace tetprep {

/// No tet, but a place for one: all of its corners are kNone.
inline bool is_gap(const TetMesh& mesh, Index t) {
  return mesh.tets[t][0] == kNone;
}
/// Closes all gaps.
void close_gaps(TetMesh& mesh);

/// Replaces tets of a mesh by cones, and keeps the rest in step. Tets that go leave gaps, which new ones
/// fill; where there is none, tets are added at the end.
class TetReplacer {
 public:
  explicit TetReplacer(TetMesh& mesh) : mesh_(mesh) {}

  /// The tets that have come, until the next call. All of cone.tets must still be there.
  const std::vector<Index>& apply(const Cone& cone);

 private:
  /// A face on the hull of what is being replaced, which lies beside a face of tet `outside` or at the end.
  struct Rim {
    std::array<Index, 3> corners;  ///< with what is inside, positive
    Index outside, triangle;
    std::size_t outside_corner;  ///< of that tet, opposite the face
  };
  /// One side of a new tet, between an edge of the hull and the apex.
  struct Side {
    Index low, high;  ///< the edge's ends
    Index tet;
    std::size_t corner;
    friend bool operator<(const Side& a, const Side& b) {
      return a.low != b.low ? a.low < b.low : a.high < b.high;
    }
  };

  Index fresh(Index origin);
  void collect_rim(const Cone& cone);
  void join_sides(Index apex);

  TetMesh& mesh_;
  std::vector<Index> gaps_;
  std::vector<Index> replaced_;
  std::vector<Rim> rim_, rim_at_apex_;
  std::vector<Side> sides_;
  std::vector<Index> made_;
};

}  // namespace tetprep
