// SPDX-License-Identifier: AGPL-3.0-or-later
// The truth about a line and a surface. Knows faces only, nothing of tetrahedra, and shares no code with the
// library's traversal, so that it shares no mistake with what it judges.
#pragma once

#include <limits>
#include <vector>

#include "bench/truth/box_tree.hpp"
#include "bench/truth/exact_line.hpp"
#include "bench/truth/surface.hpp"

namespace tetbench {

/// Where a line crosses the perturbed surface.
struct Crossing {
  std::uint32_t face = 0;
  bool back = false;  ///< the line runs along the face's normal
  tetfmt::Index side() const { return 2 * face + (back ? 1 : 0); }
  double low = 0, high = 0;  ///< bounds of t
  friend bool operator==(const Crossing&, const Crossing&) = default;
};

class ExactReference {
 public:
  explicit ExactReference(Surface surface);

  const Surface& surface() const { return surface_; }

  /// The crossings at t_min < t < t_max, in order along the line. Where t_min or t_max is exactly that of a
  /// crossing, the tie rule decides. The line's direction must not be zero. t_min at least 0.
  std::vector<Crossing> crossings(const ExactLine& line, double t_min, double t_max) const;
  /// The first of them, or none: at most one.
  std::vector<Crossing> first_crossing(const ExactLine& line, double t_min, double t_max) const;
  /// crossings() without the box tree: every face is tried. O(n).
  std::vector<Crossing> crossings_without_tree(const ExactLine& line, double t_min, double t_max) const;

 private:
  bool find(const ExactLine& line, std::uint32_t face, double t_min, double t_max, Crossing& found) const;
  bool before(const ExactLine& line, const Crossing& a, const Crossing& b) const;
  void sort(const ExactLine& line, std::vector<Crossing>& crossings) const;

  Surface surface_;
  BoxTree tree_;
};

}  // namespace tetbench
