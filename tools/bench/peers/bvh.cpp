// SPDX-License-Identifier: AGPL-3.0-or-later
#include "bench/peers/bvh.hpp"

#include <algorithm>
#include <span>

namespace tetbench {
namespace {

using tetfmt::Vec3f;
using Box = std::array<Vec3f, 2>;

constexpr std::size_t kBuckets = 12;
constexpr std::size_t kMostInLeaf = 4;
constexpr float kTraversalCost = 0.125F;  // where a test of a triangle costs 1
// Beyond this depth halves of equal counts bound it; the heuristic alone does not.
constexpr std::size_t kDeepestByCost = 90;

constexpr Box kEmpty = {Vec3f{INFINITY, INFINITY, INFINITY}, Vec3f{-INFINITY, -INFINITY, -INFINITY}};

void add(Box& box, const Box& other) {
  for (const bool high : {false, true}) {
    const auto pick = [&](float a, float b) { return high ? std::max(a, b) : std::min(a, b); };
    box[high] = {pick(box[high].x, other[high].x), pick(box[high].y, other[high].y),
                 pick(box[high].z, other[high].z)};
  }
}
float area(const Box& box) {
  const float x = box[1].x - box[0].x, y = box[1].y - box[0].y, z = box[1].z - box[0].z;
  return x < 0 ? 0 : 2 * (x * y + y * z + z * x);
}

}  // namespace

Bvh::Bvh(const PeerMesh& mesh) {
  std::vector<Item> items;
  for (std::uint32_t i = 0; i < mesh.triangles.size(); ++i) {
    Item item{kEmpty, {}, i};
    for (const Vec3f& corner : mesh.corners(i)) add(item.box, {corner, corner});
    const auto middle = [](float a, float b) { return 0.5F * a + 0.5F * b; };
    item.centroid = {middle(item.box[0].x, item.box[1].x), middle(item.box[0].y, item.box[1].y),
                     middle(item.box[0].z, item.box[1].z)};
    items.push_back(item);
  }
  primitives_.reserve(items.size());
  nodes_.reserve(items.size());
  if (!items.empty()) build(mesh, items, 0);
  nodes_.shrink_to_fit();
}

/// Where to part the items, after putting them in order: so many go first; 0 for a leaf.
std::size_t Bvh::split(std::span<Item> items, const Box& box, std::size_t& axis, std::size_t depth) const {
  if (items.size() == 1) return 0;
  Box centroids = kEmpty;
  for (const Item& item : items) add(centroids, {item.centroid, item.centroid});
  const std::array<float, 3> extent = {centroids[1].x - centroids[0].x, centroids[1].y - centroids[0].y,
                                       centroids[1].z - centroids[0].z};
  axis = static_cast<std::size_t>(std::max_element(extent.begin(), extent.end()) - extent.begin());
  const auto at = [axis](const Item& item) { return component(item.centroid, axis); };
  const auto halves = [&] {
    const auto middle = items.begin() + static_cast<std::ptrdiff_t>(items.size() / 2);
    std::nth_element(items.begin(), middle, items.end(),
                     [&](const Item& a, const Item& b) { return at(a) < at(b); });
    return items.size() / 2;
  };
  // All centroids in one place: the book makes a leaf of them, which a node must be able to count.
  if (!(extent[axis] > 0)) return items.size() > 0xFFFF ? halves() : 0;
  if (items.size() <= 2 || depth > kDeepestByCost) return halves();

  struct Bucket {
    std::size_t count = 0;
    Box box = kEmpty;
  };
  const auto bucket_of = [&](const Item& item) {
    const float along = (at(item) - component(centroids[0], axis)) / extent[axis];
    return std::min(static_cast<std::size_t>(static_cast<float>(kBuckets) * along), kBuckets - 1);
  };
  std::array<Bucket, kBuckets> buckets;
  for (const Item& item : items) {
    Bucket& bucket = buckets[bucket_of(item)];
    ++bucket.count;
    add(bucket.box, item.box);
  }
  std::size_t best = 0;
  float least = INFINITY;
  for (std::size_t last = 0; last + 1 < kBuckets; ++last) {
    std::array<Bucket, 2> sides;
    for (std::size_t b = 0; b < kBuckets; ++b) {
      sides[b > last].count += buckets[b].count;
      add(sides[b > last].box, buckets[b].box);
    }
    const float cost = kTraversalCost + (static_cast<float>(sides[0].count) * area(sides[0].box) +
                                         static_cast<float>(sides[1].count) * area(sides[1].box)) /
                                            area(box);
    if (cost < least) least = cost, best = last;
  }
  if (items.size() <= kMostInLeaf && static_cast<float>(items.size()) <= least) return 0;
  const auto middle =
      std::partition(items.begin(), items.end(), [&](const Item& item) { return bucket_of(item) <= best; });
  const auto count = static_cast<std::size_t>(middle - items.begin());
  return count == 0 || count == items.size() ? halves() : count;
}

void Bvh::build(const PeerMesh& mesh, std::span<Item> items, std::size_t depth) {
  Box box = kEmpty;
  for (const Item& item : items) add(box, item.box);
  const std::size_t here = nodes_.size();
  nodes_.push_back({box, 0, 0, 0});
  std::size_t axis = 0;
  const std::size_t first = split(items, box, axis, depth);
  if (first == 0) {
    nodes_[here].next = static_cast<std::uint32_t>(primitives_.size());
    nodes_[here].count = static_cast<std::uint16_t>(items.size());
    for (const Item& item : items)
      primitives_.push_back({mesh.corners(item.triangle), mesh.numbers[item.triangle]});
    return;
  }
  nodes_[here].axis = static_cast<std::uint8_t>(axis);
  build(mesh, items.first(first), depth + 1);
  nodes_[here].next = static_cast<std::uint32_t>(nodes_.size());
  build(mesh, items.subspan(first), depth + 1);
}

std::uint64_t Bvh::bytes() const {
  return nodes_.size() * sizeof(Node) + primitives_.size() * sizeof(Primitive);
}

}  // namespace tetbench
