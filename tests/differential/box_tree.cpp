// SPDX-License-Identifier: AGPL-3.0-or-later
#include "differential/box_tree.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace tetfmt_test {

using tetfmt::Bounds;
using tetfmt::Index;

namespace {

std::array<double, 3> numbers(const tetfmt::Vec3f& v) {
  return {v.x, v.y, v.z};
}

}  // namespace

BoxTree::BoxTree(std::span<const tetfmt::Vec3f> vertices, std::span<const tetfmt::Triangle> triangles) {
  std::vector<Bounds> boxes(triangles.size());
  for (Index i = 0; i < triangles.size(); ++i) {
    if (triangles[i].dropped()) continue;
    for (const Index v : triangles[i].vertices) boxes[i].add(vertices[v]);
    order_.push_back(i);
  }
  if (!order_.empty()) build(0, order_.size(), boxes);
}

void BoxTree::build(std::size_t first, std::size_t last, std::span<const Bounds> boxes) {
  const std::size_t self = nodes_.size();
  nodes_.emplace_back();
  Bounds box;
  for (std::size_t i = first; i < last; ++i) {
    box.add(boxes[order_[i]].lower);
    box.add(boxes[order_[i]].upper);
  }
  nodes_[self].box = box;
  if (last - first <= 4) {
    nodes_[self].first = first;
    nodes_[self].count = last - first;
    return;
  }
  const auto low = numbers(box.lower), high = numbers(box.upper);
  std::size_t axis = 0;
  for (std::size_t k = 1; k < 3; ++k) {
    if (high[k] - low[k] > high[axis] - low[axis]) axis = k;
  }
  const auto center = [&](Index i) { return numbers(boxes[i].lower)[axis] + numbers(boxes[i].upper)[axis]; };
  const std::size_t middle = first + (last - first) / 2;
  const auto at = [this](std::size_t i) { return order_.begin() + static_cast<std::ptrdiff_t>(i); };
  std::nth_element(at(first), at(middle), at(last), [&](Index a, Index b) { return center(a) < center(b); });
  build(first, middle, boxes);
  nodes_[self].right = nodes_.size();
  build(middle, last, boxes);
}

double BoxTree::entry(const Bounds& box, const tetfmt::Ray& ray, double limit) {
  // Two roundings a quotient, in whatever rounding mode: a relative error below 2^-51. Widening both ends by
  // 2^-48 keeps every box that the exact ray meets.
  constexpr double kMargin = 0x1p-48;
  const auto low = numbers(box.lower), high = numbers(box.upper);
  const auto origin = numbers(ray.origin), direction = numbers(ray.direction);
  double enter = 0, leave = limit;
  for (std::size_t k = 0; k < 3; ++k) {
    if (direction[k] == 0) {
      if (origin[k] < low[k] || origin[k] > high[k]) return kNever;
      continue;
    }
    double a = (low[k] - origin[k]) / direction[k];
    double b = (high[k] - origin[k]) / direction[k];
    if (a > b) std::swap(a, b);
    enter = std::max(enter, a - std::abs(a) * kMargin);
    leave = std::min(leave, b + std::abs(b) * kMargin);
  }
  return enter <= leave ? enter : kNever;
}

}  // namespace tetfmt_test
