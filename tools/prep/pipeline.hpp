// SPDX-License-Identifier: AGPL-3.0-or-later
// From mesh files to a tet file.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "prep/prep.hpp"
#include "prep/reduce_crossings.hpp"
#include "prep/resolve.hpp"
#include "prep/simplify.hpp"
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

/// The optional sections about the surface.
struct AttributeReport {
  std::size_t materials = 0, objects = 0, surface_points = 0, properties = 0;
  bool normals = false, texcoords = false, colors = false;  ///< that the input has, stored or not
  std::vector<std::string> sections;                        ///< kinds stored
  std::uint64_t bytes = 0;                                  ///< in those
  std::int64_t bytes_saved = 0;  ///< against plain sections of everything that the input has
};

struct RegionReport {
  std::size_t count = 0, kept = 0;
  std::size_t tets_left_out = 0;
  std::uint64_t bytes_saved = 0;  ///< against the same file with all regions
};

/// What happened, for the user and for the report file. Conversions that failed filled in what they reached.
struct ConvertReport {
  std::size_t input_points = 0, input_triangles = 0;  ///< of all inputs, before anything was done to them
  SimplifyReport simplify;                            ///< all zero if not asked for
  std::size_t merged_points = 0, degenerate_triangles = 0, duplicate_triangles = 0;
  std::array<double, 3> origin{};
  int grid_exponent = 0;
  int coarser_bits = 0;      ///< the surface's grid is 2^this coarser than it would have been
  double max_deviation = 0;  ///< by snapping, model units
  ResolveReport resolve;     ///< all zero if nothing intersected
  std::size_t surface_points = 0, surface_triangles = 0;  ///< cut where they had to be
  TetrahedralizeReport tetrahedralize;
  CrossingReport crossings;  ///< all zero if that stage was left out
  RegionReport regions;
  AttributeReport attributes;
  std::size_t vertices = 0, tets = 0, sides = 0, hull_faces = 0;
  std::uint64_t output_bytes = 0;
  std::vector<std::string> warnings;  ///< one line each
  std::vector<StageCost> stages;
  double seconds = 0;
  double peak_memory_mb = 0;  ///< of this process and TetGen's together, at their worst moments
};

/// The whole conversion. The output appears under its name only when it is complete and has passed validation
/// at Level::geometry; after a Failure (any exit code) nothing of it is left. The report file is written in
/// either case; after a Failure it has "error" and "exit_code", and lists what is known of the reason.
/// Failure (usage): two of the files are one; a point of `reachable_from` lies outside of the box.
/// `report` is filled in as far as the work got, also when it fails.
void convert(const ConvertOptions& options, Progress& progress, ConvertReport& report);
inline ConvertReport convert(const ConvertOptions& options, Progress& progress) {
  ConvertReport report;
  convert(options, progress, report);
  return report;
}

/// In a word or two: "ok"; "ok (cut)" if triangles were cut because they intersected; else the exit code's
/// class: "usage", "io", "invalid", "runtime" or "unsupported". `failure`: null for success.
std::string outcome(const ConvertReport& report, const Failure* failure);

/// The report file's text: one JSON object. `failure`: what the conversion ended with, null for success.
std::string to_json(const ConvertOptions& options, const ConvertReport& report,
                    const Failure* failure = nullptr);

/// One line on the attempts that failed before one succeeded; empty if the first one did.
std::string fallback_note(const TetrahedralizeReport& report);

}  // namespace tetprep
