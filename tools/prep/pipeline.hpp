// SPDX-License-Identifier: AGPL-3.0-or-later
// From a mesh file to a tet file.
#pragma once

#include <cstdint>
#include <string>

#include "prep/prep.hpp"
#include "prep/reduce_crossings.hpp"
#include "tetfmt/layout.hpp"

namespace tetprep {

/// Which space stays in the file.
enum class Keep {
  all,
  outside,         ///< region 0: for rays that start outside of everything, among opaque surfaces
  reachable_from,  ///< the regions of given points
};

struct ConvertOptions {
  std::vector<std::string> inputs;  ///< at least one; several make one scene
  std::string output;
  std::string report;      ///< where to write the report as JSON; empty for nowhere
  std::string debug_mesh;  ///< where to write the surface if it cannot be converted, or had to be cut
  tetfmt::Layout layout = tetfmt::Layout::tet20;
  unsigned threads = 0;  ///< 0: as many as the machine has
  double radius_edge = TetrahedralizeOptions{}.radius_edge;
  double time_limit = 0;           ///< seconds for an attempt of TetGen; 0 chooses by size
  std::uint64_t memory_limit = 0;  ///< bytes that TetGen may use; 0: none
  Optimize optimize = Optimize::fast;
  KeepAttributes attributes = KeepAttributes::all;
  bool draco = false;  ///< attributes in a DRAC section
  Keep keep = Keep::all;
  std::vector<Point> reachable_from;  ///< model coordinates
  double simplify = 0;                ///< largest deviation, model units; 0: leave the surface as it is
};

/// What happened, for the user and for the report file.
struct ConvertReport {
  std::size_t input_points = 0, input_triangles = 0;
  std::size_t merged_points = 0, degenerate_triangles = 0, duplicate_triangles = 0;
  std::size_t surface_points = 0, surface_triangles = 0;
  std::size_t vertices = 0, tets = 0, sides = 0, hull_faces = 0;
  std::array<double, 3> origin{};
  int grid_exponent = 0;
  double max_deviation = 0;
  TetrahedralizeReport tetrahedralize;
  CrossingReport crossings;  ///< all zero if that stage was left out
  std::vector<StageCost> stages;
  double seconds = 0;
  double peak_memory_mb = 0;  ///< of this process and TetGen's together, at their worst moments
  std::uint64_t output_bytes = 0;
};

/// The whole conversion. The output appears under its name only when it is complete and has passed validation
/// at Level::geometry; after a Failure (any exit code) nothing of it is left. A surface that intersects
/// itself still gets its report, which then has "error" and "intersections". Failure (usage): two of input,
/// output and report are one file.
ConvertReport convert(const ConvertOptions& options, Progress& progress);

/// The report file's text: one JSON object. `error`: what the conversion ended with, empty for success.
std::string to_json(const ConvertOptions& options, const ConvertReport& report,
                    const std::string& error = {});

/// One line on the attempts that failed before one succeeded; empty if the first one did.
std::string fallback_note(const TetrahedralizeReport& report);

}  // namespace tetprep
