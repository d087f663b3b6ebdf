// SPDX-License-Identifier: AGPL-3.0-or-later
// What the writers of single formats share.
#pragma once

#include "surface/write_surface.hpp"

namespace tetprep {

std::unique_ptr<SurfaceWriter> make_ply_writer(const std::string& path, const SurfaceWriterOptions& options);
std::unique_ptr<SurfaceWriter> make_obj_writer(const std::string& path);

/// A surface point of a triangle's corner, kNone if it has none.
inline Index surface_point(const SurfaceMesh& mesh, std::size_t triangle, std::size_t corner) {
  const auto& corners = mesh.appearance.corners;
  return corners.empty() ? kNone : corners[mesh.input_triangle[triangle]][corner];
}

/// Material or object of a triangle. `of_input` may be empty: all 0.
inline Index of_triangle(const std::vector<Index>& of_input, const SurfaceMesh& mesh, std::size_t triangle) {
  return of_input.empty() ? 0 : of_input[mesh.input_triangle[triangle]];
}

/// `name` on one line: control characters become '_'.
std::string printable(std::string name);

/// `names` made printable (characters of `special` become '_' too). An empty name becomes `fallback` and its
/// number, and a name that an earlier one has gets a number. No two results are equal, and none is in
/// `taken`.
std::vector<std::string> distinct_names(const std::vector<std::string>& names, const std::string& fallback,
                                        std::string_view special, const std::vector<std::string>& taken = {});

}  // namespace tetprep
