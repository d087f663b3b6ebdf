// SPDX-License-Identifier: AGPL-3.0-or-later
// A bounding volume hierarchy as Pharr, Jakob and Humphreys (2016) build and walk it in section 4.3: the
// surface area heuristic over twelve buckets, nodes of 32 bytes in depth-first order, children visited front
// to back.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "bench/peer_mesh.hpp"
#include "bench/peers/watertight.hpp"

namespace tetbench {

class Bvh {
 public:
  explicit Bvh(const PeerMesh& mesh);

  static constexpr const char* kName = "SAH BVH";
  std::uint64_t bytes() const;

  /// The triangle that is met first; if `any`, whichever is found.
  template <bool any, class Counter>
  TreeHit trace(TreeRay ray, Counter& counter) const;

 private:
  struct Node {
    std::array<tetfmt::Vec3f, 2> box;
    std::uint32_t next = 0;   ///< leaf: its first triangle; else the second child, the first one follows
    std::uint16_t count = 0;  ///< of the leaf's triangles
    std::uint8_t axis = 0;
  };
  static_assert(sizeof(Node) == 32);
  /// A triangle with its corners, in the order of the leaves: one place in memory for each test.
  struct Primitive {
    Corners corners;
    tetfmt::Index number;
  };
  struct Item {
    std::array<tetfmt::Vec3f, 2> box;
    tetfmt::Vec3f centroid;
    std::uint32_t triangle = 0;
  };
  static constexpr std::size_t kDeepest = 128;
  std::size_t split(std::span<Item> items, const std::array<tetfmt::Vec3f, 2>& box, std::size_t& axis,
                    std::size_t depth) const;
  void build(const PeerMesh& mesh, std::span<Item> items, std::size_t depth);

  std::vector<Node> nodes_;
  std::vector<Primitive> primitives_;
};

template <bool any, class Counter>
TreeHit Bvh::trace(TreeRay ray, Counter& counter) const {
  TreeHit found;
  if (nodes_.empty()) return found;
  std::array<std::uint32_t, kDeepest> pending;
  std::size_t count = 0;
  std::uint32_t current = 0;
  for (;;) {
    const Node& node = nodes_[current];
    counter.node();
    float enter, leave;
    if (ray.clip(node.box, enter, leave)) {
      if (node.count == 0) {
        const bool second_first = ray.negative[node.axis];
        pending[count++] = second_first ? current + 1 : node.next;
        current = second_first ? node.next : current + 1;
        continue;
      }
      for (std::uint32_t i = 0; i < node.count; ++i) {
        const Primitive& primitive = primitives_[node.next + i];
        if (!ray.meets(primitive.corners)) continue;
        found = {primitive.number, ray.t_max};
        if (any) return found;
      }
    }
    if (count == 0) return found;
    current = pending[--count];
  }
}

}  // namespace tetbench
