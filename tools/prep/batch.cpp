// SPDX-License-Identifier: AGPL-3.0-or-later
// Lists of conversions, and what is told of their results. run_jobs() is in batch_run.cpp.
#include "prep/batch.hpp"

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>

#include "common/output.hpp"
#include "common/parse.hpp"
#include "tetfmt/version.hpp"

namespace tetprep {
namespace {

namespace fs = std::filesystem;

/// One name for a file however it is written; the path itself if it cannot be made absolute.
std::string canonical(const std::string& path) {
  std::error_code error;
  const fs::path whole = fs::weakly_canonical(fs::absolute(path), error);
  return error ? path : whole.string();
}

Job parse_job(std::string_view line, const std::string& where, const std::string& folder) {
  Job job;
  for (std::size_t begin = 0; begin <= line.size();) {
    const std::size_t end = std::min(line.find('\t', begin), line.size());
    const std::string_view field = trim(line.substr(begin, end - begin));
    if (field.empty())
      throw Failure(ExitCode::invalid,
                    where + ": an empty field: inputs and output are separated by one tab each");
    job.inputs.emplace_back(field);
    begin = end + 1;
  }
  if (job.inputs.size() > 1) {
    job.output = std::move(job.inputs.back());
    job.inputs.pop_back();
  } else {
    const fs::path input = job.inputs.front();
    const fs::path place = folder.empty() ? input.parent_path() : fs::path(folder);
    job.output = (place / input.stem()).string() + ".tet";
  }
  return job;
}

void refuse_shared_files(const std::vector<Job>& jobs, const std::string& name) {
  std::map<std::string, std::size_t> writers;  // output to line
  for (const Job& job : jobs) {
    const auto [found, fresh] = writers.emplace(canonical(job.output), job.line);
    if (!fresh)
      throw Failure(ExitCode::invalid, name + ":" + std::to_string(job.line) + ": writes " + job.output +
                                           ", as line " + std::to_string(found->second) +
                                           " does; name another output after a tab");
  }
  for (const Job& job : jobs) {
    for (const std::string& input : job.inputs) {
      const auto found = writers.find(canonical(input));
      if (found != writers.end())
        throw Failure(ExitCode::invalid, name + ":" + std::to_string(job.line) + ": reads " + input +
                                             ", which line " + std::to_string(found->second) + " writes");
    }
  }
}

}  // namespace

std::vector<Job> parse_jobs(std::string_view list, const std::string& name, const std::string& folder) {
  std::vector<Job> jobs;
  for (std::size_t begin = 0, number = 1; begin < list.size(); ++number) {
    const std::size_t end = std::min(list.find('\n', begin), list.size());
    const std::string_view line = list.substr(begin, end - begin);
    begin = end + 1;
    if (trim(line).empty() || trim(line).front() == '#') continue;
    jobs.push_back(parse_job(line, name + ":" + std::to_string(number), folder));
    jobs.back().line = number;
  }
  if (jobs.empty()) throw Failure(ExitCode::invalid, name + ": no conversions in it: one input a line");
  refuse_shared_files(jobs, name);
  return jobs;
}

std::string to_table(const std::vector<Job>& jobs, const std::vector<JobResult>& results) {
  std::string table = "file\ttriangles\toutcome\tseconds\tmemory_mb\ttets\tdetail\n";
  for (std::size_t i = 0; i < jobs.size(); ++i) {
    const JobResult& result = results[i];
    std::string files;
    for (const std::string& input : jobs[i].inputs) files += (files.empty() ? "" : " + ") + one_line(input);
    char costs[64];
    std::snprintf(costs, sizeof costs, "%.2f\t%.0f", result.seconds, result.peak_memory_mb);
    table += files + '\t' + std::to_string(result.triangles) + '\t' + result.outcome + '\t' + costs + '\t' +
             std::to_string(result.tets) + '\t' +
             one_line(result.error.empty() ? jobs[i].output : result.error) + '\n';
  }
  return table;
}

std::string to_json(const std::vector<Job>& jobs, const std::vector<JobResult>& results) {
  using Json = nlohmann::ordered_json;
  Json json;
  json["program"] = "tet convert --batch";
  json["version"] = TETFMT_VERSION;
  json["conversions"] = jobs.size();
  json["failed"] = std::count_if(results.begin(), results.end(),
                                 [](const JobResult& result) { return result.code != ExitCode::ok; });
  Json& list = json["jobs"] = Json::array();
  for (const JobResult& result : results) list.push_back(Json::parse(result.report));
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace tetprep
