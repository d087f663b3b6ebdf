// SPDX-License-Identifier: AGPL-3.0-or-later
// A pinhole camera, and where to put it when nobody says.
#pragma once

#include <optional>
#include <string>

#include "trace/vector.hpp"

namespace tetprep {

struct Scene;

/// What the user may say about the camera, in model coordinates. What is left open is chosen to suit the
/// surface.
struct CameraWish {
  std::optional<Vec3> eye, look_at;
  std::optional<Vec3> up;               ///< without: 0,1,0, or another if that is where the camera looks
  double fov = 30;                      ///< vertical opening angle in degrees, 0 to 180 exclusive
  double azimuth = 30, elevation = 18;  ///< degrees to the right of the front and above it; without an eye
  std::string where;  ///< in the scene file, for messages; empty if the command line says any of the above
};

/// In world coordinates (Scene). right, up and forward are orthonormal.
struct Camera {
  Vec3 eye, right, up, forward;
  double half_height = 0;  ///< tangent of half the vertical opening angle
  double half_width = 0;
  std::string where;  ///< as the wish has it

  /// Through the picture at (x, y), both 0 to 1 from the upper left corner. Of length 1 or more, not unit.
  Vec3 direction(double x, double y) const {
    return forward + ((2 * x - 1) * half_width) * right + ((1 - 2 * y) * half_height) * up;
  }
};

/// Fills in what `wish` leaves open. Without an eye, the surface is seen from the front, right and above (a
/// three-quarter view, unless azimuth and elevation say otherwise) at the distance from which all of it just
/// fits; without a look_at, the camera turns to the middle of the surface. `aspect` is width / height. Throws
/// Failure for a view direction of length zero or parallel to an up that was wished for (usage, or invalid
/// if the scene file says so), and if the surface is needed and a file has no finite point (invalid). Reads
/// the surface only where something is left open.
Camera make_camera(const CameraWish& wish, const Scene& scene, double aspect);

}  // namespace tetprep
