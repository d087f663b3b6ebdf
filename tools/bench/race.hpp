// SPDX-License-Identifier: AGPL-3.0-or-later
// `tet bench`: every tracer on every workload, on the same rays, each in turn.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "bench/tally.hpp"
#include "bench/tracer.hpp"
#include "bench/workload.hpp"
#include "common/progress.hpp"

namespace tetbench {

struct RaceOptions {
  WorkloadOptions rays;
  int repeats = 5;                              ///< of every measurement
  std::size_t sample = 2000;                    ///< rays of a workload that the exact reference is asked
  bool shuffle = false;                         ///< every workload in random order, too
  std::vector<std::string> tracers, workloads;  ///< names, or their beginnings up to a hyphen; empty: all
  std::string against;                          ///< the tracer that ratios are to; empty: embree-1 if it is
                                                ///< there, else the first one
};

/// One tracer on one workload.
struct RaceRow {
  TracerKind tracer;
  std::vector<double> ns;  ///< a ray, processor time; of each repetition
  std::optional<double> visits;
  PeerTally verdict;  ///< its `rays` are those that were asked and timed
};

struct RaceWorkload {
  std::string name, description;
  std::size_t rays = 0, hits = 0, sample = 0, sample_failed = 0;
  bool occlusion = false, coherent = true;
  std::optional<double> distance;  ///< of the camera
  std::vector<RaceRow> rows;       ///< in the order of tracer_kinds()
  const RaceRow* find(const std::string& tracer) const;
};

/// What files and structures take.
struct RaceMesh {
  std::string file;
  std::size_t triangles = 0, faces = 0, tets = 0, vertices = 0;
  std::uint64_t file_bytes = 0;
  std::vector<double> open_ms, validate_ms;
  std::vector<Structure> structures;
  std::vector<RaceWorkload> workloads;  ///< that a tracer takes
};

struct RaceResult {
  RaceOptions options;  ///< with `against` decided
  std::vector<RaceMesh> meshes;
  double seconds = 0;
  /// Answers of exact tracers that are wrong or missed, and failed samples: must be none.
  std::uint64_t failures() const;
};

/// The kinds wanted. Throws Failure (usage) for a name that there is not, with those that there are.
std::vector<TracerKind> chosen_tracers(const std::vector<std::string>& names);
std::vector<WorkloadKind> chosen_workloads(const std::vector<std::string>& names);

/// One thread in all that is timed. Throws Failure for files that cannot be tested (Scene), before long work;
/// if no tracer takes any workload (usage).
RaceResult race(const std::vector<std::string>& files, const RaceOptions& options,
                tetprep::Progress& progress);

/// The result as text for people, and in short, which is the end of that; as CSV, a line a row; as JSON.
std::string race_table(const RaceResult& result);
std::string race_summary(const RaceResult& result);
std::string race_csv(const RaceResult& result);
std::string race_json(const RaceResult& result);

/// Pictures as SVG: name and text of each.
struct Picture {
  std::string name, svg;
};
std::vector<Picture> race_pictures(const RaceResult& result);

}  // namespace tetbench
