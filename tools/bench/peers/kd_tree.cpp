// SPDX-License-Identifier: AGPL-3.0-or-later
#include "bench/peers/kd_tree.hpp"

#include <algorithm>
#include <cmath>

namespace tetbench {
namespace {

using tetfmt::Vec3f;

constexpr float kTestCost = 80, kTraversalCost = 1, kEmptyBonus = 0.5F;
constexpr std::size_t kMostInLeaf = 1;

void set(Vec3f& v, std::size_t axis, float value) {
  (axis == 0 ? v.x : axis == 1 ? v.y : v.z) = value;
}

}  // namespace

/// Recursion with the lists of triangles that are in each node's box.
struct KdTree::Builder {
  KdTree& tree;
  std::vector<Box> boxes;  ///< of the triangles

  struct Edge {
    float at = 0;
    std::uint32_t triangle = 0;
    bool end = false;
    bool operator<(const Edge& other) const { return at == other.at ? end < other.end : at < other.at; }
  };
  std::vector<Edge> edges;

  struct Split {
    std::size_t axis = 0;
    std::size_t edge = 0;  ///< of `edges`, sorted along the axis
    float cost = INFINITY;
    bool found() const { return cost < INFINITY; }
  };

  void sort_edges(std::span<const std::uint32_t> triangles, std::size_t axis) {
    edges.clear();
    for (const std::uint32_t t : triangles) {
      edges.push_back({component(boxes[t][0], axis), t, false});
      edges.push_back({component(boxes[t][1], axis), t, true});
    }
    std::sort(edges.begin(), edges.end());
  }

  /// The cheapest plane across the axis; the cost of the rest is that of testing all triangles.
  Split best_split(std::span<const std::uint32_t> triangles, const Box& box, std::size_t axis) {
    sort_edges(triangles, axis);
    Split best{axis};
    const auto extent = [&](std::size_t k) { return component(box[1], k) - component(box[0], k); };
    const float d1 = extent((axis + 1) % 3), d2 = extent((axis + 2) % 3);
    const float total = 2 * (d1 * d2 + extent(axis) * (d1 + d2));
    const float low = component(box[0], axis), high = component(box[1], axis);
    std::size_t below = 0, above = triangles.size();
    for (std::size_t i = 0; i < edges.size(); ++i) {
      if (edges[i].end) --above;
      const float at = edges[i].at;
      if (at > low && at < high) {
        const float part_below = 2 * (d1 * d2 + (at - low) * (d1 + d2)) / total;
        const float part_above = 2 * (d1 * d2 + (high - at) * (d1 + d2)) / total;
        const float bonus = above == 0 || below == 0 ? kEmptyBonus : 0;
        const float cost = kTraversalCost + kTestCost * (1 - bonus) *
                                                (part_below * static_cast<float>(below) +
                                                 part_above * static_cast<float>(above));
        if (cost < best.cost) best.cost = cost, best.edge = i;
      }
      if (!edges[i].end) ++below;
    }
    return best;
  }

  void leaf(std::span<const std::uint32_t> triangles) {
    const auto count = static_cast<std::uint32_t>(triangles.size());
    Node node{0, count << 2 | 3};
    if (count == 1) {
      node.value = triangles[0];
    } else {
      node.value = static_cast<std::uint32_t>(tree.leaves_.size());
      tree.leaves_.insert(tree.leaves_.end(), triangles.begin(), triangles.end());
    }
    tree.nodes_.push_back(node);
  }

  void build(std::vector<std::uint32_t> triangles, const Box& box, int depth, int bad_splits) {
    if (triangles.size() <= kMostInLeaf || depth == 0) return leaf(triangles);
    std::size_t axis = 0;
    for (std::size_t k = 1; k < 3; ++k)
      if (component(box[1], k) - component(box[0], k) > component(box[1], axis) - component(box[0], axis))
        axis = k;
    Split split;
    for (std::size_t turn = 0; turn < 3 && !split.found(); ++turn)
      split = best_split(triangles, box, (axis + turn) % 3);
    const float unsplit = kTestCost * static_cast<float>(triangles.size());
    if (split.cost > unsplit) ++bad_splits;
    if (!split.found() || (split.cost > 4 * unsplit && triangles.size() < 16) || bad_splits == 3)
      return leaf(triangles);

    std::vector<std::uint32_t> below, above;
    for (std::size_t i = 0; i < split.edge; ++i)
      if (!edges[i].end) below.push_back(edges[i].triangle);
    for (std::size_t i = split.edge + 1; i < edges.size(); ++i)
      if (edges[i].end) above.push_back(edges[i].triangle);
    const float plane = edges[split.edge].at;
    triangles = {};  // lists of all ancestors at once are memory that nobody looks at
    const std::size_t here = tree.nodes_.size();
    tree.nodes_.push_back({std::bit_cast<std::uint32_t>(plane), 0});
    Box lower = box, upper = box;
    set(lower[1], split.axis, plane);
    set(upper[0], split.axis, plane);
    build(std::move(below), lower, depth - 1, bad_splits);
    tree.nodes_[here].rest = static_cast<std::uint32_t>(tree.nodes_.size() << 2 | split.axis);
    build(std::move(above), upper, depth - 1, bad_splits);
  }
};

KdTree::KdTree(const PeerMesh& mesh) : numbers_(mesh.numbers) {
  if (mesh.triangles.empty()) return;
  Builder builder{*this, {}, {}};
  tetfmt::Bounds all;
  std::vector<std::uint32_t> triangles;
  for (std::uint32_t i = 0; i < mesh.triangles.size(); ++i) {
    corners_.push_back(mesh.corners(i));
    tetfmt::Bounds bounds;
    for (const Vec3f& corner : corners_.back()) bounds.add(corner), all.add(corner);
    builder.boxes.push_back({bounds.lower, bounds.upper});
    triangles.push_back(i);
  }
  box_ = {all.lower, all.upper};
  const int depth =
      static_cast<int>(std::lround(8 + 1.3 * std::floor(std::log2(static_cast<double>(triangles.size())))));
  builder.build(std::move(triangles), box_, std::min(depth, static_cast<int>(kDeepest) - 1), 0);
  sort_triangles();
  nodes_.shrink_to_fit();
  leaves_.shrink_to_fit();
}

/// In the order in which leaves name them: what is near in space then is in memory.
void KdTree::sort_triangles() {
  std::vector<std::uint32_t> place(corners_.size(), tetfmt::kNone);
  std::vector<Corners> corners;
  std::vector<tetfmt::Index> numbers;
  const auto moved = [&](std::uint32_t& triangle) {
    if (place[triangle] == tetfmt::kNone) {
      place[triangle] = static_cast<std::uint32_t>(corners.size());
      corners.push_back(corners_[triangle]);
      numbers.push_back(numbers_[triangle]);
    }
    triangle = place[triangle];
  };
  for (Node& node : nodes_) {
    if (!node.leaf()) continue;
    if (node.above() == 1)
      moved(node.value);
    else
      for (std::uint32_t i = 0; i < node.above(); ++i) moved(leaves_[node.value + i]);
  }
  corners_ = std::move(corners);
  numbers_ = std::move(numbers);
}

std::uint64_t KdTree::bytes() const {
  return nodes_.size() * sizeof(Node) + leaves_.size() * sizeof(std::uint32_t) +
         corners_.size() * sizeof(Corners) + numbers_.size() * sizeof(tetfmt::Index);
}

}  // namespace tetbench
