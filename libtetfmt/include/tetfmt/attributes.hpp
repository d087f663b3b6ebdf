// SPDX-License-Identifier: MIT
// What a file says of its surface beyond its shape. A walk needs none of it; a shader may want all of it.
#pragma once

#include <array>
#include <limits>
#include <span>
#include <string_view>

#include "tetfmt/layout.hpp"
#include "tetfmt/traverse.hpp"
#include "tetfmt/view.hpp"

namespace tetfmt {

/// The optional sections about the surface, typed; empty spans for those that the file does not have.
/// Points into the file's bytes, which must outlive it. On a file that passed Level::topology every index is
/// in range; on others it may be anything. O(sections) to make.
struct SurfaceAttributes {
  explicit SurfaceAttributes(const FileView& view);

  std::span<const Material> materials;  ///< what Side::material counts
  std::span<const Object> objects;
  std::span<const Index> triangle_objects;          ///< of each input triangle
  std::span<const std::array<Index, 3>> corners;    ///< surface points of each input triangle; kNone: none
  std::span<const std::array<float, 3>> normals;    ///< of each surface point; NaN: this one has none
  std::span<const std::array<float, 2>> texcoords;  ///< NaN likewise
  std::span<const std::array<float, 4>> colors;     ///< NaN likewise
  std::span<const Property> properties;
  std::span<const double> property_values;  ///< properties x surface points, one property after the other

  /// A text, without its zero; empty for kNone and for whatever does not exist.
  std::string_view text(TextRef ref) const;

 private:
  std::string_view texts_;
};

/// Interpolates one attribute over an input triangle with a hit's weights: (1 - u - v) a + u b + v c. NaN
/// where a corner has no surface point. `corners` must be in range, or kNone.
template <std::size_t N>
std::array<float, N> interpolate(std::span<const std::array<float, N>> values,
                                 const std::array<Index, 3>& corners, const Hit& hit) {
  std::array<float, N> result{};
  if (corners[0] == kNone || corners[1] == kNone || corners[2] == kNone) {
    result.fill(std::numeric_limits<float>::quiet_NaN());
    return result;
  }
  const double weights[3] = {1 - hit.u - hit.v, hit.u, hit.v};
  for (std::size_t k = 0; k < N; ++k) {
    double sum = 0;
    for (std::size_t c = 0; c < 3; ++c) sum += weights[c] * static_cast<double>(values[corners[c]][k]);
    result[k] = static_cast<float>(sum);
  }
  return result;
}

}  // namespace tetfmt
