// SPDX-License-Identifier: AGPL-3.0-or-later
// Hits to colours.
#pragma once

#include "tetfmt/traverse.hpp"
#include "trace/camera.hpp"
#include "trace/image.hpp"
#include "trace/scene_file.hpp"

namespace tetprep {

enum class Shade : std::uint8_t {
  scene,    ///< the scene's materials and light
  lambert,  ///< a clay model under a key light and a headlight
  normal,   ///< the input triangle's unit normal n as the colour (n + 1) / 2; a surface seen from the back
            ///< shows it too
  depth,    ///< distance along the view axis, near bright
  steps,    ///< tetrahedra that the ray visited, misses included
};

/// What the rays of one pixel add up to. lambert and normal gather colours; depth and steps gather numbers,
/// whose range is known only when all rays are done.
struct Pixel {
  Rgb colour;           ///< sum over the hits
  double quantity = 0;  ///< sum over the hits (depth) or all rays (steps)
  int hits = 0, rays = 0;
};

/// Over the whole picture.
struct Range {
  double low = 0, high = 0;
};

/// What a white surface scatters of lights that are fixed to the camera, so that every view is well lit: a
/// warm key light over its left shoulder, a cool headlight that keeps facets on the far side readable, and a
/// little from the sky. `n` faces the camera.
Rgb camera_light(Vec3 n, const Camera& camera);

/// Adds one answered ray; of Shade::scene there is nothing to gather. `direction` is the ray's, as the
/// traversal saw it. Invariant of `hit`: not corrupt.
void gather(Pixel& pixel, Shade shade, const tetfmt::FileView& view, const Camera& camera, Vec3 direction,
            const tetfmt::Hit& hit);

/// The colour of a finished pixel. `height` is its place in the picture, 0 at the top to 1; `range` is that
/// of depths or steps a pixel.
Rgb develop(const Pixel& pixel, Shade shade, Range range, const Background& background, double height);

/// The mean quantity of a pixel. Of depth: only if it has hits.
double mean_quantity(const Pixel& pixel, Shade shade);

}  // namespace tetprep
