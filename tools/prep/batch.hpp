// SPDX-License-Identifier: AGPL-3.0-or-later
// Many conversions, each in a process of its own: what one does wrong, the others do not feel.
#pragma once

#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "prep/pipeline.hpp"

namespace tetprep {

/// One conversion of a list.
struct Job {
  std::vector<std::string> inputs;
  std::string output;
  std::size_t line = 0;  ///< of the list, from 1
};

/// Reads a list: a job a line, its fields separated by tabs. One field is an input, whose output is NAME.tet
/// in `folder` (empty: beside the input); of several, the last is the output and the others make one scene.
/// Blanks around fields, empty lines and lines that begin with '#' do not count. `name` is the list's, for
/// messages. Failure: invalid (no job in it, an empty field, two jobs with one output, an output that is
/// the input of some job); all of that is by path: whether files exist is found out by the conversions.
std::vector<Job> parse_jobs(std::string_view list, const std::string& name, const std::string& folder = {});

struct JobResult {
  ExitCode code = ExitCode::runtime;
  std::string outcome;  ///< as outcome() says
  std::string error;    ///< one line; empty if all went well
  std::size_t triangles = 0, tets = 0;
  double seconds = 0, peak_memory_mb = 0;
  std::string report;  ///< the conversion's report, as to_json() makes it
};

/// Converts every job with `common`'s options, `at_once` of them at a time, and goes on after failures.
/// Unless `common` says how many threads each may use, they share the machine's. `finished` is called for
/// each as it ends, from this thread. Results are in the order of `jobs`.
///
/// SIGINT, SIGTERM and SIGHUP end all conversions, which remove their temporaries, and then this process.
/// Must be called from the main thread, by a process that has not used oneTBB: forks.
std::vector<JobResult> run_jobs(const std::vector<Job>& jobs, const ConvertOptions& common, unsigned at_once,
                                Progress& progress,
                                const std::function<void(const Job&, const JobResult&)>& finished);

/// A line a job after a line of titles, fields separated by tabs: file, triangles, outcome, seconds,
/// memory_mb, tets, and the output or the error.
std::string to_table(const std::vector<Job>& jobs, const std::vector<JobResult>& results);

/// One JSON object: how many went well, and every conversion's report.
std::string to_json(const std::vector<Job>& jobs, const std::vector<JobResult>& results);

}  // namespace tetprep
