// SPDX-License-Identifier: AGPL-3.0-or-later
// Scene -> camera rays -> hits -> colours -> image.
#pragma once

#include "common/progress.hpp"
#include "trace/camera.hpp"
#include "trace/image.hpp"
#include "trace/rays.hpp"
#include "trace/shade.hpp"

namespace tetprep {

struct RenderOptions {
  int width = 1024, height = 1024;
  int samples =
      4;  ///< rays a pixel, on a regular grid: a square number, or any other as a grid as square as possible
  Shade shade = Shade::lambert;  ///< Shade::steps needs rays that are not walked together
  Walks walks = Walks::together;
  int threads = 0;  ///< 0: all
};

struct RenderStatistics {
  RayCounts counts;
  double seconds = 0;  ///< of the tracing, shading included; without opening, developing and writing
  int threads = 0;
  Walks walks = Walks::together;
};

struct Rendering {
  Image image;
  RenderStatistics statistics;
};

/// The picture that `camera` takes of the scene, which must have been opened for this kind of shade. The same
/// for any number of threads: tiles do not depend on each other, each adds up in one order, and sums of a
/// picture are integers. Throws Failure: invalid if a ray meets bytes that are no mesh, or a refracted ray
/// comes to space that a file leaves out; as locate_everywhere for the camera. O(rays * steps) time, 67 bytes
/// a pixel, and a few MB a thread.
Rendering render(const Scene& scene, const Camera& camera, const RenderOptions& options, Progress& progress);

}  // namespace tetprep
