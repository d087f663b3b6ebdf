// SPDX-License-Identifier: AGPL-3.0-or-later
// The benchmarks of `tet bench`, one file each; stress.hpp is the largest and has its own header.
#pragma once

#include <memory>
#include <span>
#include <string>
#include <vector>

#include "tetfmt/traverse.hpp"
#include "tetfmt/validate.hpp"

namespace tetbench {

/// What every tracer answers, so that answers can be compared: the input triangle, or kNone.
using Answers = std::vector<tetfmt::Index>;

/// Something that finds first hits: one of the project's kernels, or a peer.
class Tracer {
 public:
  virtual ~Tracer() = default;
  virtual std::string name() const = 0;
  /// First hits of rays that share their origin, in order. `answers` has the rays' size.
  virtual void trace(std::span<const tetfmt::Ray> rays, Answers& answers) const = 0;
};

/// Embree's rtcIntersect1 over the file's input triangles, high build quality; `robust` is the scene flag of
/// that name. Nothing where Embree is not built in. Any thread may trace.
std::unique_ptr<Tracer> make_embree(const tetfmt::FileView& view, bool robust = false);

struct CameraSeries {
  int size = 500;             ///< width and height of each view, in rays
  int repeats = 5;            ///< of every measurement
  double field_of_view = 45;  ///< degrees, across width and height
};

/// Camera rays at seven distances from the surface, each tracer in turn, `repeats` times.
/// `other` is the same mesh in the other layout, or null. Writes a table to standard output.
void camera_series(const tetfmt::TrustedView& view, const tetfmt::TrustedView* other,
                   const CameraSeries& options);

/// The rays of one view: from in front of the surface's middle, `distance` tenths of its largest extent away,
/// in squares of pixels.
std::vector<tetfmt::Ray> camera_view(const tetfmt::FileView& view, float distance,
                                     const CameraSeries& options);

/// Every arithmetic and basis of tetfmt/kernels.hpp on the view at distance 6.5 and on rays from what it
/// shows. Writes a table to standard output.
void compare_variants(const tetfmt::TrustedView& view, const CameraSeries& options);

/// Opening and validating the file at `path`, `repeats` times. Writes a table to standard output.
void file_costs(const std::string& path, int repeats);

}  // namespace tetbench
