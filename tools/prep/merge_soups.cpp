// SPDX-License-Identifier: AGPL-3.0-or-later
// Several inputs, one scene.
#include <algorithm>
#include <limits>
#include <utility>

#include "prep/prep.hpp"

namespace tetprep {
namespace {

/// Values of `soup`'s surface points after those of the `before` points of earlier soups.
template <class T>
void append_values(std::vector<T>& to, std::vector<T>& from, std::size_t before, std::size_t count,
                   const T& nothing) {
  if (to.empty() && from.empty()) return;
  to.resize(before, nothing);
  to.insert(to.end(), from.begin(), from.end());
  to.resize(before + count, nothing);
}

/// Properties of one name and type are one property.
void append_properties(std::vector<PointProperty>& to, std::vector<PointProperty>& from, std::size_t before,
                       std::size_t count) {
  constexpr double kNothing = std::numeric_limits<double>::quiet_NaN();
  for (PointProperty& property : from) {
    const auto same = std::find_if(to.begin(), to.end(), [&](const PointProperty& other) {
      return other.name == property.name && other.type == property.type;
    });
    PointProperty& target =
        same != to.end() ? *same : to.emplace_back(PointProperty{property.name, property.type, {}});
    append_values(target.values, property.values, before, count, kNothing);
  }
  for (PointProperty& property : to) property.values.resize(before + count, kNothing);
}

/// "Of each triangle a number, or empty: all 0", appended to the same.
void append_numbers(std::vector<Index>& to, const std::vector<Index>& from, std::size_t before,
                    std::size_t count, Index first) {
  if (to.empty() && from.empty() && first == 0) return;
  to.resize(before, 0);
  for (const Index number : from) to.push_back(first + number);
  to.resize(before + count, first);
}

void append(Appearance& to, Appearance& from, std::size_t before, std::size_t count) {
  append_numbers(to.triangle_object, from.triangle_object, before, count,
                 static_cast<Index>(to.objects.size()));
  to.objects.insert(to.objects.end(), from.objects.begin(), from.objects.end());
  append_numbers(to.triangle_material, from.triangle_material, before, count,
                 static_cast<Index>(to.materials.size()));
  to.materials.insert(to.materials.end(), from.materials.begin(), from.materials.end());

  if (!to.corners.empty() || !from.corners.empty()) {
    constexpr std::array<Index, 3> kNothing{kNone, kNone, kNone};
    to.corners.resize(before, kNothing);
    const auto first = static_cast<Index>(to.surface_points);
    for (std::array<Index, 3> corners : from.corners) {
      for (Index& point : corners) point += point == kNone ? 0 : first;
      to.corners.push_back(corners);
    }
    to.corners.resize(before + count, kNothing);
  }
  constexpr float kNothing = std::numeric_limits<float>::quiet_NaN();
  append_values(to.normals, from.normals, to.surface_points, from.surface_points,
                {kNothing, kNothing, kNothing});
  append_values(to.texcoords, from.texcoords, to.surface_points, from.surface_points, {kNothing, kNothing});
  append_values(to.colors, from.colors, to.surface_points, from.surface_points,
                {kNothing, kNothing, kNothing, kNothing});
  append_properties(to.properties, from.properties, to.surface_points, from.surface_points);
  to.surface_points += from.surface_points;
}

}  // namespace

TriangleSoup merge_soups(std::vector<TriangleSoup> soups) {
  constexpr std::size_t kMost = 0x7FFFFFFE;
  TriangleSoup all = std::move(soups.front());
  if (soups.size() == 1) return all;
  bool materials = !all.appearance.materials.empty();
  for (const TriangleSoup& soup : soups) materials = materials || !soup.appearance.materials.empty();
  // Where some soups have materials, the others need one that says nothing.
  const auto complete = [&](Appearance& appearance) {
    if (materials && appearance.materials.empty()) appearance.materials.emplace_back();
  };
  complete(all.appearance);
  for (std::size_t i = 1; i < soups.size(); ++i) {
    TriangleSoup soup = std::exchange(soups[i], {});
    if (soup.points.size() > kMost - all.points.size() ||
        soup.triangles.size() > kMost - all.triangles.size() ||
        soup.appearance.surface_points > kMost - all.appearance.surface_points)
      throw Failure(ExitCode::unsupported, "the inputs have more than 2^31 points or triangles together");
    complete(soup.appearance);
    append(all.appearance, soup.appearance, all.triangles.size(), soup.triangles.size());
    const auto first = static_cast<Index>(all.points.size());
    all.points.insert(all.points.end(), soup.points.begin(), soup.points.end());
    for (const auto& [a, b, c] : soup.triangles) all.triangles.push_back({a + first, b + first, c + first});
    all.warnings.insert(all.warnings.end(), soup.warnings.begin(), soup.warnings.end());
  }
  return all;
}

}  // namespace tetprep
