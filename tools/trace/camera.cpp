// SPDX-License-Identifier: AGPL-3.0-or-later
#include "trace/camera.hpp"

#include <algorithm>
#include <limits>

#include "common/failure.hpp"
#include "trace/scene.hpp"

namespace tetprep {
namespace {

constexpr Vec3 kUp{0, 1, 0};
constexpr double kPi = 3.141592653589793;
/// How much of the picture's half width and height the surface may fill.
constexpr double kFill = 0.88;
/// From the surface towards the default camera. Which way is the front depends on what is up: +z where y is
/// up (as most models of figures have it), -y where z is up (as CAD has it).
Vec3 default_outlook(const CameraWish& wish) {
  const Vec3 up = unit(wish.up.value_or(kUp));
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

/// Calls `use` with every corner of the surface, or of the tetrahedra where there is no surface.
template <class Use>
void for_each_point(const Scene& scene, bool surface, Use use) {
  for (const auto& part : scene.parts) {
    const auto moved = [&](const std::array<double, 3>& p) { use(vec3(p) + part->offset); };
    if (surface) {
      for_each_surface_corner(part->view(), moved);
    } else {
      const Bounds box = vertex_bounds(part->view());
      for (std::size_t corner = 0; corner < 8 && !box.empty(); ++corner)
        moved({(corner & 1 ? box.high : box.low)[0], (corner & 2 ? box.high : box.low)[1],
               (corner & 4 ? box.high : box.low)[2]});
    }
  }
}

}  // namespace

Camera make_camera(const CameraWish& wish, const Scene& scene, double aspect) {
  Camera camera;
  camera.where = wish.where;
  camera.half_height = std::tan(wish.fov * kPi / 360);
  camera.half_width = aspect * camera.half_height;
  const auto refuse = [&](const std::string& problem, const std::string& options) {
    if (wish.where.empty()) throw Failure(ExitCode::usage, problem + " (" + options + ")");
    throw Failure(ExitCode::invalid, wish.where + ": " + problem);
  };
  const auto turn = [&](Vec3 forward) {
    if (!(length(forward) > 0))
      refuse("the camera's eye and look-at are the same point; move one", "--eye, --look-at");
    if (!orient(camera, forward, wish.up.value_or(kUp)) && (wish.up || !orient(camera, forward, {0, 0, 1})))
      refuse("the camera's up is parallel to the view direction; choose another", "--up");
  };
  if (wish.eye && wish.look_at) {
    camera.eye = *wish.eye - scene.origin;
    turn(*wish.look_at - scene.origin - camera.eye);
    return camera;
  }

  Bounds bounds;
  const auto add = [&](Vec3 p) { bounds.add({p.x, p.y, p.z}); };
  for_each_point(scene, true, add);
  const bool has_surface = !bounds.empty();
  if (!has_surface) for_each_point(scene, false, add);
  if (bounds.empty())
    throw Failure(ExitCode::invalid, scene.parts.front()->file.path() +
                                         ": the file has no finite vertex; run `tet validate` on it");
  const Vec3 low = vec3(bounds.low), high = vec3(bounds.high), middle = 0.5 * (low + high);

  const Vec3 target = wish.look_at ? *wish.look_at - scene.origin : middle;
  turn(wish.eye ? target - (*wish.eye - scene.origin) : -default_outlook(wish));
  if (wish.eye) {
    camera.eye = *wish.eye - scene.origin;
    return camera;
  }
  Fit fit{kFill * camera.half_width, kFill * camera.half_height};
  for_each_point(scene, has_surface, [&](Vec3 p) { fit.add(camera, p); });
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
