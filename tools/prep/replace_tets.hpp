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
/// Makes gaps all along the order of tets, one for every `spacing` of them.
void make_gaps(TetMesh& mesh, std::size_t spacing);
/// Closes all gaps.
void close_gaps(TetMesh& mesh);

/// Replaces tets of a mesh by cones, and keeps the rest in step. New tets come into gaps, and tets that go
/// leave some. One for each thread.
class TetReplacer {
 public:
  explicit TetReplacer(TetMesh& mesh) : mesh_(mesh) {}

  /// Gaps are taken from `block` from now on.
  void enter(const Block& block);

  /// False, and nothing is changed, if there are not enough gaps. All of cone.tets must be inside the block.
  bool apply(const Cone& cone);
  /// The tets that have come with the last cone.
  const std::vector<Index>& made() const { return made_; }

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
