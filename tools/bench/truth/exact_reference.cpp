// SPDX-License-Identifier: AGPL-3.0-or-later
#include "bench/truth/exact_reference.hpp"

#include <algorithm>

namespace tetbench {

ExactReference::ExactReference(Surface surface)
    : surface_(std::move(surface)), tree_(surface_.vertices, surface_.faces) {}

bool ExactReference::find(const ExactLine& line, std::uint32_t face, double t_min, double t_max,
                          Crossing& found) const {
  const Face& corners = surface_.faces[face];
  const int sign = line.crosses(corners);
  if (sign == 0) return false;
  const auto [low, high] = line.parameter(corners);
  found = {face, sign > 0, low, high};
  if (high < t_min || low > t_max) return false;
  // After t = 0 by the side of the face that the origin is on: cheaper, and the most common question.
  if (low <= t_min && (t_min == 0 ? line.height(corners) * sign : line.compare(corners, t_min)) < 0)
    return false;
  return high < t_max || line.compare(corners, t_max) < 0;
}

bool ExactReference::before(const ExactLine& line, const Crossing& a, const Crossing& b) const {
  if (a.high < b.low) return true;
  if (b.high < a.low || a.face == b.face) return false;
  return line.compare(surface_.faces[a.face], surface_.faces[b.face]) < 0;
}

void ExactReference::sort(const ExactLine& line, std::vector<Crossing>& crossings) const {
  std::sort(crossings.begin(), crossings.end(),
            [&](const Crossing& a, const Crossing& b) { return before(line, a, b); });
}

std::vector<Crossing> ExactReference::crossings(const ExactLine& line, double t_min, double t_max) const {
  std::vector<Crossing> result;
  tree_.visit(line.origin(), line.direction(), t_min, t_max, [&](std::uint32_t face) {
    Crossing found;
    if (find(line, face, t_min, t_max, found)) result.push_back(found);
    return t_max;
  });
  sort(line, result);
  return result;
}

std::vector<Crossing> ExactReference::first_crossing(const ExactLine& line, double t_min,
                                                     double t_max) const {
  std::vector<Crossing> nearest;
  tree_.visit(line.origin(), line.direction(), t_min, t_max, [&](std::uint32_t face) {
    Crossing found;
    if (find(line, face, t_min, t_max, found)) {
      if (nearest.empty())
        nearest.push_back(found);
      else if (before(line, found, nearest[0]))
        nearest[0] = found;
    }
    return nearest.empty() ? t_max : std::min(nearest[0].high, t_max);
  });
  return nearest;
}

std::vector<Crossing> ExactReference::crossings_without_tree(const ExactLine& line, double t_min,
                                                             double t_max) const {
  std::vector<Crossing> result;
  for (std::uint32_t face = 0; face < surface_.faces.size(); ++face) {
    Crossing found;
    if (find(line, face, t_min, t_max, found)) result.push_back(found);
  }
  sort(line, result);
  return result;
}

}  // namespace tetbench
