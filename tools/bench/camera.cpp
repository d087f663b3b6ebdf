// SPDX-License-Identifier: AGPL-3.0-or-later
#include "bench/camera.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace tetbench {

using tetfmt::Vec3f;

Frame::Frame(const Scene& scene) {
  for (const Face& face : scene.surface().faces)
    for (const tetfmt::Index v : face) bounds.add(scene.surface().vertices[v]);
  const Vec3f &low = bounds.lower, &high = bounds.upper;
  const Vec3f extent = {high.x - low.x, high.y - low.y, high.z - low.z};
  middle = {(low.x + high.x) / 2, (low.y + high.y) / 2, (low.z + high.z) / 2};
  unit = std::max({extent.x, extent.y, extent.z}) / 10;
  diagonal = std::hypot(double{extent.x}, double{extent.y}, double{extent.z});
}

std::optional<float> Frame::touching_distance(const Scene& scene) const {
  constexpr float kFar = 16.5F;
  const tetfmt::Hit front =
      tetfmt::first_hit(scene.view(0), tetfmt::locate(scene.view(0), eye(kFar)), {0, 0, -1});
  if (front.outcome != tetfmt::Outcome::hit) return std::nullopt;
  return kFar - static_cast<float>(front.t) / unit + 0.01F;
}

std::vector<Vec3f> view_directions(int size, double field_of_view, const Orientation& orientation) {
  const auto& [right, up, forward] = orientation;
  const auto n = static_cast<float>(size);
  const auto half = static_cast<float>(std::tan(field_of_view * std::numbers::pi / 360));
  const auto across = [&](int pixel) { return half * (2 * (static_cast<float>(pixel) + 0.5F) / n - 1); };
  std::vector<Vec3f> directions;
  // In squares of 4 x 4 pixels, and these in squares of 2 x 2, and so on (Z order).
  int bits = 0;
  while (4 << bits < size) ++bits;
  for (unsigned square = 0; square < 1U << 2 * bits; ++square) {
    int left = 0, top = 0;
    for (int bit = 0; bit < bits; ++bit) {
      left |= static_cast<int>(square >> 2 * bit & 1U) << (bit + 2);
      top |= static_cast<int>(square >> (2 * bit + 1) & 1U) << (bit + 2);
    }
    for (int pixel = 0; pixel < 16; ++pixel) {
      const int column = left + pixel % 4, row = top + pixel / 4;
      if (column >= size || row >= size) continue;
      const float x = across(column), y = -across(row);
      directions.push_back({x * right.x + y * up.x + forward.x, x * right.y + y * up.y + forward.y,
                            x * right.z + y * up.z + forward.z});
    }
  }
  return directions;
}

Vec3f surrounded_point(const Scene& scene, const Frame& frame) {
  constexpr int kLines = 9;  // in each direction across
  const tetfmt::FileView& view = scene.view(0).view();
  const std::array<float, 3> low = {frame.bounds.lower.x, frame.bounds.lower.y, frame.bounds.lower.z},
                             high = {frame.bounds.upper.x, frame.bounds.upper.y, frame.bounds.upper.z};
  const auto closed_off = [&](tetfmt::Index tet) {
    const tetfmt::Index region = view.region_of(tet);
    return region != tetfmt::kNone && view.regions()[region].id != 0;
  };
  Vec3f best = frame.middle;
  std::pair<bool, double> most = {false, 0};  // a closed room before an open one, a wide one before a narrow
  std::vector<tetfmt::Hit> hits;
  for (std::size_t axis = 0; axis < 3; ++axis)
    for (int line = 0; line < kLines * kLines; ++line) {
      std::array<float, 3> from{}, along{};
      const auto place = [&](std::size_t k, int step) {
        return low[k] + (high[k] - low[k]) * (static_cast<float>(step) + 0.5F) / kLines;
      };
      from[axis] = low[axis] - frame.unit;
      from[(axis + 1) % 3] = place((axis + 1) % 3, line % kLines);
      from[(axis + 2) % 3] = place((axis + 2) % 3, line / kLines);
      along[axis] = 1;
      const Vec3f origin = {from[0], from[1], from[2]}, direction = {along[0], along[1], along[2]};
      hits.clear();
      tetfmt::all_hits(scene.view(0), tetfmt::locate(scene.view(0), origin), direction, hits);
      for (std::size_t i = 0; i + 1 < hits.size(); ++i) {
        const std::pair room = {closed_off(hits[i].neighbor), hits[i + 1].t - hits[i].t};
        if (!(room > most)) continue;
        most = room;
        const auto t = static_cast<float>((hits[i].t + hits[i + 1].t) / 2);
        best = {origin.x + t * direction.x, origin.y + t * direction.y, origin.z + t * direction.z};
      }
    }
  return best;
}

}  // namespace tetbench
