// SPDX-License-Identifier: AGPL-3.0-or-later
// File -> camera rays -> hits -> colours -> image.
#pragma once

#include "common/progress.hpp"
#include "trace/camera.hpp"
#include "trace/image.hpp"
#include "trace/shade.hpp"

namespace tetprep {

struct RenderOptions {
  int width = 1024, height = 1024;
  int samples =
      4;  ///< rays a pixel, on a regular grid: a square number, or any other as a grid as square as possible
  Shade shade = Shade::lambert;
  int threads = 0;  ///< 0: all
};

struct RenderStatistics {
  std::uint64_t rays = 0, hits = 0, steps = 0;
  std::uint32_t most_steps = 0;
  double seconds = 0;  ///< of the tracing, gathering included; without opening, developing and writing
  int threads = 0;
};

struct Rendering {
  Image image;
  RenderStatistics statistics;
};

/// The picture that `camera` takes of the surface in `view`. The same for any number of threads: pixels do
/// not depend on each other, and sums of a picture are integers. Throws Failure: invalid if a ray meets bytes
/// that are no mesh, usage if the camera is in space that the file leaves out. O(rays * steps) time, 43 bytes
/// a pixel.
Rendering render(const tetfmt::FileView& view, const Camera& camera, const RenderOptions& options,
                 Progress& progress);

}  // namespace tetprep
