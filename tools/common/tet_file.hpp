// SPDX-License-Identifier: AGPL-3.0-or-later
// A tet file, open for reading by a tool.
#pragma once

#include <array>
#include <cmath>
#include <optional>
#include <string>

#include "tetfmt/mapped_file.hpp"
#include "tetfmt/view.hpp"

namespace tetprep {

/// The file may be sound, but this version does not know what it holds: exit code 5, not 3.
bool is_unsupported(tetfmt::Code code);

/// Owner of a mapping and of the view on it. Level::structure is checked, nothing deeper: the view's arrays
/// may hold anything.
class TetFile {
 public:
  /// Throws Failure: io if it cannot be read, unsupported if it is of a version, section or codec that this
  /// build does not know, invalid if it is broken or no tet file.
  explicit TetFile(const std::string& path);

  const std::string& path() const { return path_; }
  const tetfmt::FileView& view() const { return *view_; }

 private:
  std::string path_;
  tetfmt::MappedFile file_;
  std::optional<tetfmt::FileView> view_;
};

/// An axis-aligned box. Empty (low > high) until something was added.
struct Bounds {
  std::array<double, 3> low, high;
  Bounds();
  void add(const std::array<double, 3>& point);
  bool empty() const { return low[0] > high[0]; }
};

/// Of every finite vertex, local coordinates: the box that the tetrahedra fill.
Bounds vertex_bounds(const tetfmt::FileView& view);

/// Calls `use(const std::array<double, 3>&)` with every corner of the input triangles, in local coordinates:
/// as often as triangles share it, and not at all where an unchecked file's index or coordinate makes no
/// sense.
template <class Use>
void for_each_surface_corner(const tetfmt::FileView& view, Use use) {
  const auto vertices = view.vertices();
  for (const tetfmt::Triangle& triangle : view.triangles()) {
    for (const tetfmt::Index v : triangle.vertices) {
      if (v >= vertices.size()) continue;
      const std::array<double, 3> corner{vertices[v].x, vertices[v].y, vertices[v].z};
      if (std::isfinite(corner[0]) && std::isfinite(corner[1]) && std::isfinite(corner[2])) use(corner);
    }
  }
}

/// Of the input surface (its triangles' corners), local coordinates. Empty if there is none.
Bounds surface_bounds(const tetfmt::FileView& view);

}  // namespace tetprep
