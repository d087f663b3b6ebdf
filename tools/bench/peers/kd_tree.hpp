// SPDX-License-Identifier: AGPL-3.0-or-later
// A k-d tree as Pharr, Jakob and Humphreys (2016) build and walk it in section 4.4: the surface area
// heuristic swept over the edges of the triangles' boxes, nodes of 8 bytes, costs and limits as in the book.
#pragma once

#include <array>
#include <bit>
#include <cstdint>
#include <span>
#include <vector>

#include "bench/peer_mesh.hpp"
#include "bench/peers/watertight.hpp"

namespace tetbench {

class KdTree {
 public:
  explicit KdTree(const PeerMesh& mesh);

  static constexpr const char* kName = "SAH k-d tree";
  std::uint64_t bytes() const;

  /// As Bvh::trace.
  template <bool any, class Counter>
  TreeHit trace(TreeRay ray, Counter& counter) const;

 private:
  /// An inner node's first child follows it. The two low bits of `rest` are the axis, or 3 in a leaf; above
  /// them is the second child, or the number of triangles.
  struct Node {
    std::uint32_t value = 0;  ///< the bits of the plane's coordinate; leaf: of one triangle itself, else the
                              ///< first of its triangles in leaves_
    std::uint32_t rest = 0;
    float plane() const { return std::bit_cast<float>(value); }
    std::uint32_t axis() const { return rest & 3; }
    bool leaf() const { return axis() == 3; }
    std::uint32_t above() const { return rest >> 2; }
  };
  static_assert(sizeof(Node) == 8);
  using Box = std::array<tetfmt::Vec3f, 2>;
  static constexpr std::size_t kDeepest = 64;
  struct Builder;
  void sort_triangles();

  Box box_{};
  std::vector<Node> nodes_;
  std::vector<std::uint32_t> leaves_;
  std::vector<Corners> corners_;
  std::vector<tetfmt::Index> numbers_;
};

template <bool any, class Counter>
TreeHit KdTree::trace(TreeRay ray, Counter& counter) const {
  TreeHit found;
  float enter, leave;
  if (nodes_.empty() || !ray.clip(box_, enter, leave)) return found;
  struct Pending {
    std::uint32_t node;
    float enter, leave;
  };
  std::array<Pending, kDeepest> pending;
  std::size_t count = 0;
  std::uint32_t current = 0;
  const auto test = [&](std::uint32_t triangle) {
    if (!ray.meets(corners_[triangle])) return false;
    found = {numbers_[triangle], ray.t_max};
    return true;
  };
  while (!(ray.t_max < enter)) {
    const Node& node = nodes_[current];
    counter.node();
    if (!node.leaf()) {
      const std::size_t axis = node.axis();
      const float plane = node.plane(), origin = ray.origin[axis];
      const float t = (plane - origin) * ray.inverse[axis];
      const bool below_first = origin < plane || (origin == plane && ray.direction[axis] <= 0);
      const std::uint32_t first = below_first ? current + 1 : node.above();
      const std::uint32_t second = below_first ? node.above() : current + 1;
      if (t > leave || t <= 0) {
        current = first;
      } else if (t < enter) {
        current = second;
      } else {
        pending[count++] = {second, t, leave};
        current = first;
        leave = t;
      }
      continue;
    }
    const std::uint32_t triangles = node.above();
    if (triangles == 1) {
      if (test(node.value) && any) return found;
    } else {
      for (std::uint32_t i = 0; i < triangles; ++i)
        if (test(leaves_[node.value + i]) && any) return found;
    }
    if (count == 0) break;
    --count;
    current = pending[count].node;
    enter = pending[count].enter;
    leave = pending[count].leave;
  }
  return found;
}

}  // namespace tetbench
