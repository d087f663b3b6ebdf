// SPDX-License-Identifier: AGPL-3.0-or-later
#include "bench/workload.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "bench/camera.hpp"
#include "bench/dice.hpp"
#include "bench/text.hpp"

namespace tetbench {
namespace {

using tetfmt::Hit;
using tetfmt::Location;
using tetfmt::Outcome;
using tetfmt::Vec3f;

Vec3d wide(const Vec3f& v) {
  return {double{v.x}, double{v.y}, double{v.z}};
}
Vec3f rounded(const Vec3d& p) {
  return {static_cast<float>(p[0]), static_cast<float>(p[1]), static_cast<float>(p[2])};
}
double dot(const Vec3d& a, const Vec3d& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}
Vec3d difference(const Vec3d& a, const Vec3d& b) {
  return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
}
Vec3d unit(const Vec3d& v) {
  const double length = std::sqrt(dot(v, v));
  return {v[0] / length, v[1] / length, v[2] / length};
}

/// Rays of one origin.
RayList from_eye(const Scene& scene, const Vec3f& eye, const std::vector<Vec3f>& directions) {
  RayList rays;
  const std::uint32_t place = rays.add_place(tetfmt::locate(scene.view(0), eye));
  for (const Vec3f& direction : directions) rays.add(place, {eye, direction});
  return rays;
}

/// Where a ray has met the surface, for rays that go on from there.
struct Bounce {
  Location side;  ///< the one that the ray came from
  Vec3f point;    ///< for peers
  Vec3d normal;   ///< of unit length, to that side

  Bounce(const Scene& scene, const Hit& hit) : side(tetfmt::near_side(scene.view(0), hit)) {
    point = rounded({side.position[0], side.position[1], side.position[2]});
    const tetfmt::FileView& view = scene.view(0).view();
    const auto& corners = view.triangles()[view.sides()[hit.side].triangle].vertices;
    const auto at = [&](std::size_t k) { return wide(view.vertices()[corners[k]]); };
    const Vec3d e = difference(at(1), at(0)), f = difference(at(2), at(0));
    normal = unit({e[1] * f[2] - e[2] * f[1], e[2] * f[0] - e[0] * f[2], e[0] * f[1] - e[1] * f[0]});
    if (hit.back)
      for (double& component : normal) component = -component;
  }

  /// By the cosine to the normal: a point of the unit sphere around the normal's end (Lambert). Rounding
  /// must not turn it into the face.
  Vec3f diffuse(Dice& dice) const {
    for (;;) {
      Vec3d d = dice.direction();
      for (std::size_t k = 0; k < 3; ++k) d[k] += normal[k];
      if (!(dot(d, d) > 1e-6)) continue;
      const Vec3f direction = rounded(unit(d));
      if (dot(wide(direction), normal) > 1e-4) return direction;
    }
  }
};

std::vector<Bounce> hits_of(const Scene& scene, const RayList& rays) {
  std::vector<Bounce> bounces;
  for (std::size_t i = 0; i < rays.size(); ++i) {
    const Hit hit = tetfmt::first_hit(scene.view(0), rays.places[rays.from[i]], rays.directions[i]);
    if (hit.outcome == Outcome::hit) bounces.emplace_back(scene, hit);
  }
  return bounces;
}

/// What a camera sees that is close enough for the surface to fill most of its view.
std::vector<Bounce> seen(const Scene& scene, const WorkloadOptions& options, int size) {
  return hits_of(scene,
                 from_eye(scene, Frame(scene).eye(6.5F), view_directions(size, options.field_of_view)));
}

RayList camera(const Scene& scene, const WorkloadOptions& options, float distance) {
  RayList rays =
      from_eye(scene, Frame(scene).eye(distance), view_directions(options.size, options.field_of_view));
  rays.distance = distance;
  return rays;
}

RayList touching(const Scene& scene, const WorkloadOptions& options) {
  const auto distance = Frame(scene).touching_distance(scene);
  return distance ? camera(scene, options, *distance) : RayList{};
}

/// Six square views, all around.
RayList room(const Scene& scene, const WorkloadOptions& options) {
  const Orientation all[] = {
      {Vec3f{0, 0, -1}, Vec3f{0, 1, 0}, Vec3f{1, 0, 0}}, {Vec3f{0, 0, 1}, Vec3f{0, 1, 0}, Vec3f{-1, 0, 0}},
      {Vec3f{1, 0, 0}, Vec3f{0, 0, -1}, Vec3f{0, 1, 0}}, {Vec3f{1, 0, 0}, Vec3f{0, 0, 1}, Vec3f{0, -1, 0}},
      {Vec3f{-1, 0, 0}, Vec3f{0, 1, 0}, Vec3f{0, 0, 1}}, kAlongMinusZ};
  const int size = std::max(1, static_cast<int>(options.size / std::sqrt(6.0)));
  std::vector<Vec3f> directions;
  for (const Orientation& orientation : all) {
    const auto view = view_directions(size, 90, orientation);
    directions.insert(directions.end(), view.begin(), view.end());
  }
  return from_eye(scene, surrounded_point(scene, Frame(scene)), directions);
}

/// Four rays from each point that is seen, at most `reach` diagonals long.
RayList ambient(const Scene& scene, const WorkloadOptions& options, double reach) {
  constexpr int kRays = 4;
  const double diagonal = Frame(scene).diagonal;
  const auto epsilon = static_cast<float>(kPeerEpsilon * diagonal),
             far = static_cast<float>(reach * diagonal);
  Dice dice({options.seed, 1});
  RayList rays;
  rays.occlusion = true;
  rays.coherent = false;  // of origin, not of direction
  for (const Bounce& bounce : seen(scene, options, std::max(1, options.size / 2))) {
    const std::uint32_t place = rays.add_place(bounce.side);
    for (int i = 0; i < kRays; ++i) rays.add(place, {bounce.point, bounce.diffuse(dice), epsilon, far});
  }
  return rays;
}

/// To a light above and beside the camera.
RayList shadow(const Scene& scene, const WorkloadOptions& options) {
  const Frame frame(scene);
  const Vec3f eye = frame.eye(6.5F);
  const Vec3f lamp = {eye.x + 4 * frame.unit, eye.y + 6 * frame.unit, eye.z};
  RayList rays;
  rays.occlusion = true;
  const std::uint32_t light = rays.add_place(tetfmt::locate(scene.view(0), lamp));
  for (const Bounce& bounce : seen(scene, options, options.size)) {
    const Vec3d to = difference(wide(lamp), wide(bounce.point));
    if (!(dot(to, bounce.normal) > 0)) continue;  // a renderer does not ask
    const auto epsilon = static_cast<float>(kPeerEpsilon * frame.diagonal / std::sqrt(dot(to, to)));
    rays.add_segment(rays.add_place(bounce.side), light, {bounce.point, rounded(to), epsilon, 1});
  }
  return rays;
}

/// The second and the third ray of paths: all that leave what the camera sees, then all that leave what those
/// meet.
RayList paths(const Scene& scene, const WorkloadOptions& options) {
  const auto epsilon = static_cast<float>(kPeerEpsilon * Frame(scene).diagonal);
  Dice dice({options.seed, 2});
  RayList rays;
  rays.coherent = false;
  std::vector<Bounce> bounces = seen(scene, options, options.size);
  for (int depth = 0; depth < 2; ++depth) {
    std::vector<Bounce> next;
    for (const Bounce& bounce : bounces) {
      const Vec3f direction = bounce.diffuse(dice);
      rays.add(rays.add_place(bounce.side), {bounce.point, direction, epsilon});
      const Hit hit = tetfmt::first_hit(scene.view(0), bounce.side, direction);
      if (hit.outcome == Outcome::hit) next.emplace_back(scene, hit);
    }
    bounces = std::move(next);
  }
  return rays;
}

/// Lines through two points of a sphere around the bounds, evenly over its surface.
RayList lines(const Scene& scene, const WorkloadOptions& options) {
  const Frame frame(scene);
  Dice dice({options.seed, 3});
  const Vec3d middle = wide(frame.middle);
  const auto on_sphere = [&] {
    Vec3d p = dice.direction();
    for (std::size_t k = 0; k < 3; ++k) p[k] = middle[k] + frame.diagonal / 2 * p[k];
    return p;
  };
  RayList rays;
  rays.coherent = false;
  // Each from a place of its own is dear to keep: a location is a hundred bytes.
  const int count = std::max(1, options.size * options.size / 4);
  while (rays.size() < static_cast<std::size_t>(count)) {
    const Vec3f from = rounded(on_sphere());
    const Vec3f direction = rounded(unit(difference(on_sphere(), wide(from))));
    if (!(std::abs(dot(wide(direction), wide(direction)) - 1) < 0.1)) continue;  // twice the same point
    rays.add(rays.add_place(tetfmt::locate(scene.view(0), from)), {from, direction});
  }
  return rays;
}

/// From a vertex of the mesh through another. Few, for float signs send many of them in circles.
RayList vertices(const Scene& scene, const WorkloadOptions& options) {
  Dice dice({options.seed, 4});
  const auto all = scene.view(0).view().vertices();
  RayList rays;
  rays.coherent = false;
  const std::size_t count = std::min<std::size_t>(
      10000, static_cast<std::size_t>(options.size) * static_cast<std::size_t>(options.size));
  while (rays.size() < count) {
    const Vec3f &a = all[dice.below(all.size())], &b = all[dice.below(all.size())];
    if (a == b) continue;
    rays.add(rays.add_place(tetfmt::locate(scene.view(0), a)), {a, {b.x - a.x, b.y - a.y, b.z - a.z}});
  }
  return rays;
}

}  // namespace

std::vector<WorkloadKind> workload_kinds() {
  std::vector<WorkloadKind> kinds;
  for (const float distance : {16.5F, 14.0F, 11.5F, 9.0F, 6.5F, 4.0F})
    kinds.push_back(
        {format("camera-%g", double{distance}),
         format("camera rays from distance %g, where the surface's extent is 10", double{distance}),
         [distance](const Scene& scene, const WorkloadOptions& options) {
           return camera(scene, options, distance);
         }});
  kinds.push_back({"camera-touching", "from just in front of the surface", touching});
  kinds.push_back({"room", "six views from within: the camera is surrounded by surface", room});
  for (const auto& [name, text, reach] :
       {std::tuple{"ao-unbounded", "of any length", static_cast<double>(INFINITY)},
        std::tuple{"ao-10", "up to 10 % of the surface's diagonal", 0.1},
        std::tuple{"ao-2", "up to 2 % of it", 0.02}})
    kinds.push_back({name, std::string("ambient occlusion, four rays from each point seen, ") + text,
                     [reach = reach](const Scene& scene, const WorkloadOptions& options) {
                       return ambient(scene, options, reach);
                     }});
  kinds.push_back({"shadow", "from each point seen to a point light: is it lit", shadow});
  kinds.push_back({"paths", "second and third rays of diffuse paths: what do they meet first", paths});
  kinds.push_back({"lines", "random lines through the surface's bounding sphere", lines});
  kinds.push_back(
      {"vertices", "from a vertex of the mesh through another: walks that are made of ties", vertices});
  return kinds;
}

RayList shuffled(const RayList& rays, std::uint64_t seed) {
  Dice dice({seed, 5});
  std::vector<std::uint32_t> order;
  for (std::uint32_t i = 0; i < rays.size(); ++i) order.push_back(i);
  dice.shuffle(order);
  RayList result = rays.picked(order);
  result.coherent = false;
  return result;
}

}  // namespace tetbench
