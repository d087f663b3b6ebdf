// SPDX-License-Identifier: AGPL-3.0-or-later
// From a hit to what a shader wants to know of the surface there.
#pragma once

#include "trace/rays.hpp"

namespace tetprep {

struct SurfacePoint {
  Material material;  ///< its colour is the one at this point: textures and colours of points are in it
  Vec3 true_normal;   ///< of the triangle; unit length, towards where the ray came from
  Vec3 normal;        ///< the one to shade with: the file's, where it has one; on the same side
};

/// (b - a) x (c - a) of an input triangle, unit length; zero for a triangle that is none.
Vec3 triangle_normal(const tetfmt::FileView& view, tetfmt::Index triangle);

/// `direction` is the ray's.
SurfacePoint surface_at(const Scene& scene, const SceneHit& hit, Vec3 direction);

}  // namespace tetprep
