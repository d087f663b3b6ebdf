// SPDX-License-Identifier: AGPL-3.0-or-later
#include "trace/camera.hpp"

#include <algorithm>
#include <limits>

#include "common/failure.hpp"
#include "common/tet_file.hpp"

namespace tetprep {
namespace {

constexpr double kPi = 3.141592653589793;
/// How much of the picture's half width and height the surface may fill.
constexpr double kFill = 0.88;
/// From the surface towards the default camera. Which way is the front depends on what is up: +z where y is
/// up (as most models of figures have it), -y where z is up (as CAD has it).
Vec3 default_outlook(const CameraWish& wish) {
  const Vec3 up = unit(wish.up);
  const bool y_up = std::abs(up.y) >= std::max(std::abs(up.x), std::abs(up.z));
  const Vec3 front_guess = y_up ? Vec3{0, 0, 1} : Vec3{0, -1, 0};
  const Vec3 right = unit(cross(up, front_guess));
  const Vec3 front = cross(right, up);
  const double azimuth = wish.azimuth * kPi / 180, elevation = wish.elevation * kPi / 180;
  return std::cos(elevation) * (std::cos(azimuth) * front + std::sin(azimuth) * right) +
         std::sin(elevation) * up;
}

/// Turns the camera to look along `forward` with `up` upwards. False if they are parallel.
bool orient(Camera& camera, Vec3 forward, Vec3 up) {
  const Vec3 sideways = cross(unit(forward), unit(up));
  if (!(length(sideways) > 1e-6)) return false;
  camera.forward = unit(forward);
  camera.right = unit(sideways);
  camera.up = cross(camera.right, camera.forward);
  return true;
}

/// The extent of the surface as the camera's axes see it. A point is inside the left and right planes of the
/// picture if |p.right - e.right| <= w * (p.forward - e.forward): so w * e.forward +- e.right is bounded by
/// the extremes of w * p.forward +- p.right, and likewise for height. The eye goes as far forward as both
/// pairs allow.
struct Fit {
  double w, h;
  double left = kFar, right = kFar, below = kFar, above = kFar;
  static constexpr double kFar = std::numeric_limits<double>::infinity();

  void add(const Camera& camera, Vec3 p) {
    const double x = dot(p, camera.right), y = dot(p, camera.up), z = dot(p, camera.forward);
    left = std::min(left, w * z + x);
    right = std::min(right, w * z - x);
    below = std::min(below, h * z + y);
    above = std::min(above, h * z - y);
  }
  Vec3 eye(const Camera& camera) const {
    const double z = std::min((left + right) / (2 * w), (below + above) / (2 * h));
    return ((left - right) / 2) * camera.right + ((below - above) / 2) * camera.up + z * camera.forward;
  }
};

}  // namespace

Camera make_camera(const CameraWish& wish, bool up_given, const tetfmt::FileView& view, double aspect) {
  Bounds bounds = surface_bounds(view);
  const bool has_surface = !bounds.empty();
  if (!has_surface) bounds = vertex_bounds(view);
  if (bounds.empty())
    throw Failure(ExitCode::invalid, "the file has no finite vertex; run `tet validate` on it");
  const Vec3 low = vec3(bounds.low), high = vec3(bounds.high), middle = 0.5 * (low + high);
  const Vec3 origin = vec3(view.header().origin);

  Camera camera;
  camera.half_height = std::tan(wish.fov * kPi / 360);
  camera.half_width = aspect * camera.half_height;

  const Vec3 target = wish.look_at ? *wish.look_at - origin : middle;
  const Vec3 forward = wish.eye ? target - (*wish.eye - origin) : -default_outlook(wish);
  if (!(length(forward) > 0)) {
    throw Failure(ExitCode::usage, "--eye and --look-at are the same point; move one of them");
  }
  if (!orient(camera, forward, wish.up) && (up_given || !orient(camera, forward, {0, 0, 1}))) {
    throw Failure(ExitCode::usage, "--up is parallel to the view direction; choose another");
  }
  if (wish.eye) {
    camera.eye = *wish.eye - origin;
    return camera;
  }
  Fit fit{kFill * camera.half_width, kFill * camera.half_height};
  if (has_surface) {
    for_each_surface_corner(view, [&](const std::array<double, 3>& p) { fit.add(camera, vec3(p)); });
  } else {
    for (int corner = 0; corner < 8; ++corner) {
      fit.add(camera,
              {corner & 1 ? high.x : low.x, corner & 2 ? high.y : low.y, corner & 4 ? high.z : low.z});
    }
  }
  camera.eye = fit.eye(camera);
  // A wish to look at some point keeps the distance, and gives up the fit.
  if (wish.look_at)
    camera.eye = target - std::max(dot(middle - camera.eye, camera.forward), 0.0) * camera.forward;
  // A flat or single-point surface seen edge-on can bring the eye onto it.
  const double size = length(high - low);
  if (!(dot(middle - camera.eye, camera.forward) > 1e-3 * size)) {
    camera.eye = camera.eye - (size > 0 ? size : 1) * camera.forward;
  }
  return camera;
}

}  // namespace tetprep
