// SPDX-License-Identifier: AGPL-3.0-or-later
// Where cameras stand and what they see first.
#pragma once

#include <vector>

#include "bench/scene.hpp"
#include "tetfmt/traverse.hpp"

namespace tetbench {

/// The surface's bounds, as Aman, Demirci and Gudukbay (2022) measure in Table 1: distances are those at
/// which the largest extent is 10, from the middle of the bounds; the camera looks along -z.
struct Frame {
  explicit Frame(const Scene& scene);
  tetfmt::Bounds bounds;
  tetfmt::Vec3f middle;
  float unit;  ///< a tenth of the largest extent
  double diagonal;
  tetfmt::Vec3f eye(float distance) const { return {middle.x, middle.y, middle.z + distance * unit}; }
  /// Just in front of what the camera's axis meets; nothing if it meets nothing.
  std::optional<float> touching_distance(const Scene& scene) const;
};

/// Unit vectors along which a camera sees: right, up, forward.
using Orientation = std::array<tetfmt::Vec3f, 3>;
inline constexpr Orientation kAlongMinusZ = {tetfmt::Vec3f{1, 0, 0}, tetfmt::Vec3f{0, 1, 0},
                                             tetfmt::Vec3f{0, 0, -1}};

/// size x size directions, in squares of 4 x 4 pixels, these in squares of 2 x 2, and so on (Z order), as
/// renderers shoot them.
std::vector<tetfmt::Vec3f> view_directions(int size, double field_of_view, const Orientation& = kAlongMinusZ);

/// A point that is surrounded: the middle of the longest stretch between two crossings, of lines along the
/// axes through the bounds. In a space that the surface closes off, if there is one on such a line.
tetfmt::Vec3f surrounded_point(const Scene& scene, const Frame& frame);

}  // namespace tetbench
