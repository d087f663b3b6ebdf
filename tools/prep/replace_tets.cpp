// SPDX-License-Identifier: AGPL-3.0-or-later
#include "prep/replace_tets.hpp"

#include <algorithm>
#include <cassert>

#include "prep/take_tets.hpp"

namespace tetprep {

void close_gaps(TetMesh& mesh) {
  std::vector<Index> left;
  left.reserve(mesh.tets.size());
  for (std::size_t t = 0; t < mesh.tets.size(); ++t)
    if (!is_gap(mesh, static_cast<Index>(t))) left.push_back(static_cast<Index>(t));
  take_tets(mesh, left);
}

const std::vector<Index>& TetReplacer::apply(const Cone& cone) {
  collect_rim(cone);
  if (cone.apex == mesh_.points.size()) mesh_.points.emplace_back();
  mesh_.points[cone.apex] = cone.place;
  made_.clear();
  sides_.clear();
  for (std::size_t i = 0; i < rim_.size(); ++i) {
    const Rim& rim = rim_[i];
    const Index t = i < cone.tets.size() ? cone.tets[i] : fresh(cone.tets[0]);
    made_.push_back(t);
    mesh_.tets[t] = {rim.corners[0], rim.corners[1], rim.corners[2], cone.apex};
    mesh_.neighbors[t] = {kNone, kNone, kNone, rim.outside};
    mesh_.face_triangle[t] = {kNone, kNone, kNone, rim.triangle};
    if (rim.outside != kNone) mesh_.neighbors[rim.outside][rim.outside_corner] = t;
    for (std::size_t k = 0; k < 3; ++k) {
      const auto [low, high] = std::minmax(rim.corners[(k + 1) % 3], rim.corners[(k + 2) % 3]);
      sides_.push_back({low, high, t, k});
    }
  }
  for (std::size_t i = rim_.size(); i < cone.tets.size(); ++i) {
    mesh_.tets[cone.tets[i]].fill(kNone);
    gaps_.push_back(cone.tets[i]);
  }
  join_sides(cone.apex);
  return made_;
}

/// Sorts the faces of the hull of cone.tets into those with the apex and the others.
void TetReplacer::collect_rim(const Cone& cone) {
  replaced_ = cone.tets;
  std::sort(replaced_.begin(), replaced_.end());
  rim_.clear();
  rim_at_apex_.clear();
  for (const Index t : cone.tets) {
    const auto& corners = mesh_.tets[t];
    for (std::size_t k = 0; k < 4; ++k) {
      const Index outside = mesh_.neighbors[t][k], triangle = mesh_.face_triangle[t][k];
      if (outside != kNone && triangle == kNone &&
          std::binary_search(replaced_.begin(), replaced_.end(), outside))
        continue;
      Rim rim{{}, outside, triangle, 0};
      for (std::size_t i = 0; i < 3; ++i) rim.corners[i] = corners[kFaceCorners[k][i]];
      if (outside != kNone) {
        const auto is_corner = [&](Index v) {
          return std::find(rim.corners.begin(), rim.corners.end(), v) != rim.corners.end();
        };
        while (is_corner(mesh_.tets[outside][rim.outside_corner])) ++rim.outside_corner;
      }
      const bool at_apex =
          corners[k] != cone.apex && std::find(corners.begin(), corners.end(), cone.apex) != corners.end();
      (at_apex ? rim_at_apex_ : rim_).push_back(rim);
    }
  }
}

/// Links the new tets with each other, and with what lies beyond the rim at the apex.
void TetReplacer::join_sides(Index apex) {
  std::sort(sides_.begin(), sides_.end());
  for (std::size_t i = 0; i + 1 < sides_.size(); ++i) {
    const Side &a = sides_[i], &b = sides_[i + 1];
    if (a < b) continue;
    mesh_.neighbors[a.tet][a.corner] = b.tet;
    mesh_.neighbors[b.tet][b.corner] = a.tet;
    ++i;
  }
  for (const Rim& rim : rim_at_apex_) {
    Side wanted{kNone, 0, 0, 0};
    for (const Index v : rim.corners) {
      if (v == apex) continue;
      wanted.low = std::min(wanted.low, v);
      wanted.high = std::max(wanted.high, v);
    }
    const auto found = std::lower_bound(sides_.begin(), sides_.end(), wanted);
    assert(found != sides_.end());  // the new tets fill what the rim encloses
    const Side& side = *found;
    mesh_.neighbors[side.tet][side.corner] = rim.outside;
    mesh_.face_triangle[side.tet][side.corner] = rim.triangle;
    if (rim.outside != kNone) mesh_.neighbors[rim.outside][rim.outside_corner] = side.tet;
  }
}

/// A place for a new tet among the likes of tet `origin`.
Index TetReplacer::fresh(Index origin) {
  Index t = static_cast<Index>(mesh_.tets.size());
  if (!gaps_.empty()) {
    t = gaps_.back();
    gaps_.pop_back();
  } else {
    if (mesh_.tets.capacity() == mesh_.tets.size()) {  // doubling would take much memory for few tets
      const std::size_t room = mesh_.tets.size() + mesh_.tets.size() / 16 + 64;
      mesh_.tets.reserve(room);
      mesh_.neighbors.reserve(room);
      mesh_.face_triangle.reserve(room);
      mesh_.region.reserve(mesh_.region.empty() ? 0 : room);
    }
    mesh_.tets.emplace_back();
    mesh_.neighbors.emplace_back();
    mesh_.face_triangle.emplace_back();
    if (!mesh_.region.empty()) mesh_.region.emplace_back();
  }
  if (!mesh_.region.empty()) mesh_.region[t] = mesh_.region[origin];
  return t;
}

}  // namespace tetprep
