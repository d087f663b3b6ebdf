// SPDX-License-Identifier: AGPL-3.0-or-later
#include "prep/surface_points.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <type_traits>

namespace tetprep {
namespace {

template <class T>
constexpr bool kIsProperty = std::is_same_v<T, double>;

/// A row that says nothing, always with the same bits.
template <class T>
T nothing() {
  T row{};
  if constexpr (kIsProperty<T>)
    row = std::numeric_limits<double>::quiet_NaN();
  else
    row.fill(std::numeric_limits<float>::quiet_NaN());
  return row;
}

/// Directions and colours that are not finite are of no use to anyone; a property may be infinite.
template <class T>
bool usable(const T& row) {
  if constexpr (kIsProperty<T>)
    return !std::isnan(row);
  else
    return std::all_of(row.begin(), row.end(), [](float x) { return std::isfinite(x); });
}

/// `work` on each channel that has rows, in the order in which a key holds them.
template <class Work>
void for_each_channel(const PolygonSoup& soup, const Work& work) {
  if (!soup.normals.rows.empty()) work(soup.normals);
  if (!soup.texcoords.rows.empty()) work(soup.texcoords);
  if (!soup.colors.rows.empty()) work(soup.colors);
  for (const PropertyChannel& property : soup.properties)
    if (!property.values.rows.empty()) work(property.values);
}

}  // namespace

SurfacePoints::SurfacePoints(const PolygonSoup& soup) : soup_(soup) {
  for_each_channel(soup, [&](const auto& channel) {
    key_bytes_ += sizeof channel.rows[0];
    if (!channel.of_corner.empty()) choices_.push_back(&channel.of_corner);
  });
  if (!any()) return;
  combinations_.emplace(key_bytes_);
  last_.resize(soup.points.size());
  known_.resize(soup.points.size(), false);
  last_rows_.resize(soup.points.size() * choices_.size());
}

Index SurfacePoints::at(std::size_t corner) {
  const auto point = static_cast<std::size_t>(soup_.corners[corner]);
  Index* const rows = last_rows_.data() + point * choices_.size();
  bool same = known_[point];
  for (std::size_t i = 0; i < choices_.size(); ++i) {
    same = same && rows[i] == (*choices_[i])[corner];
    rows[i] = (*choices_[i])[corner];
  }
  if (!same) last_[point] = find(corner, point);
  known_[point] = true;
  return last_[point];
}

template <class T>
void SurfacePoints::append(const Channel<T>& channel, std::size_t corner, std::size_t point) {
  const std::size_t row = channel.of_corner.empty() ? point : channel.of_corner[corner];
  const bool useful = row < channel.rows.size() && usable(channel.rows[row]);
  const T value = useful ? channel.rows[row] : nothing<T>();
  const auto* bytes = reinterpret_cast<const char*>(&value);
  key_.insert(key_.end(), bytes, bytes + sizeof value);
  says_something_ = says_something_ || useful;
}

Index SurfacePoints::find(std::size_t corner, std::size_t point) {
  key_.clear();
  says_something_ = false;
  for_each_channel(soup_, [&](const auto& channel) { append(channel, corner, point); });
  return says_something_ ? combinations_->add(key_.data()) : kNone;
}

void SurfacePoints::fill(Appearance& appearance) const {
  if (!any()) return;
  appearance.surface_points = combinations_->size();
  std::size_t offset = 0;
  const auto unpack = [&](auto& values) {
    values.resize(combinations_->size());
    for (std::size_t i = 0; i < values.size(); ++i)
      std::memcpy(&values[i], combinations_->key(i) + offset, sizeof values[i]);
    offset += sizeof values[0];
  };
  if (!soup_.normals.rows.empty()) unpack(appearance.normals);
  if (!soup_.texcoords.rows.empty()) unpack(appearance.texcoords);
  if (!soup_.colors.rows.empty()) unpack(appearance.colors);
  for (const PropertyChannel& property : soup_.properties) {
    if (property.values.rows.empty()) continue;
    appearance.properties.push_back({property.name, property.type, {}});
    unpack(appearance.properties.back().values);
  }
}

}  // namespace tetprep
