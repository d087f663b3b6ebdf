// SPDX-License-Identifier: AGPL-3.0-or-later
// What `tet bench` found, as a table, as CSV and as JSON.
#include <algorithm>
#include <nlohmann/json.hpp>

#include "bench/provenance.hpp"
#include "bench/race.hpp"
#include "bench/statistics.hpp"
#include "bench/text.hpp"
#include "common/parse.hpp"

namespace tetbench {
namespace {

using Json = nlohmann::ordered_json;
using tetprep::number;

/// The fastest of Embree's modes that are not robust, by medians; null without Embree.
const RaceRow* best_embree(const RaceWorkload& workload) {
  const RaceRow* best = nullptr;
  for (const RaceRow& row : workload.rows)
    if (row.tracer.family == Family::embree &&
        (!best || summarize(row.ns).median < summarize(best->ns).median))
      best = &row;
  return best;
}

std::string count(double value) {
  return value < 10 ? format("%.2f", value) : format("%.1f", value);
}

std::string structures_text(const RaceMesh& mesh, int repeats) {
  std::string text = format("  open %s ms, validate %s ms (median, lowest .. highest of %d)\n",
                            tetbench::text(summarize(mesh.open_ms), 3).c_str(),
                            tetbench::text(summarize(mesh.validate_ms), 0).c_str(), repeats);
  text += format("  %-16s %14s %12s %10s %10s\n", "in memory", "bytes", "a triangle", "a tet", "built in s");
  for (const Structure& s : mesh.structures) {
    const auto per = [&](std::size_t n) { return static_cast<double>(s.bytes) / static_cast<double>(n); };
    const bool ours = s.build_seconds == 0;
    text += format("  %-16s %14llu %12.1f %10s %10s  %s\n", s.name.c_str(),
                   static_cast<unsigned long long>(s.bytes), per(mesh.triangles),
                   ours ? format("%.1f", per(mesh.tets)).c_str() : "",
                   ours ? "" : format("%.3f", s.build_seconds).c_str(), s.version.c_str());
  }
  return text;
}

std::string workload_text(const RaceWorkload& workload, const RaceOptions& options) {
  std::string text =
      format("\n%s: %s\n  %zu rays, %.1f %% of them %s; sample against exact arithmetic: %zu of %zu wrong\n",
             workload.name.c_str(), workload.description.c_str(), workload.rays,
             100.0 * static_cast<double>(workload.hits) / static_cast<double>(workload.rays),
             workload.occlusion ? "blocked" : "hit", workload.sample_failed, workload.sample);
  const RaceRow* against = workload.find(options.against);
  const RaceRow* embree = best_embree(workload);
  text += format("  %-24s %-26s", "", "ns a ray");
  if (against) text += format(" %-24s", ("/ " + options.against).c_str());
  if (embree) text += format(" %-24s", ("/ " + embree->tracer.name + ", its best").c_str());
  text += format(" %8s %8s %8s\n", "visits", "wrong", "missed");
  for (const RaceRow& row : workload.rows) {
    text += format("  %-24s %-26s", row.tracer.name.c_str(), tetbench::text(summarize(row.ns), 1).c_str());
    for (const RaceRow* other : {against, embree})
      if (other)
        text += format(" %-24s", tetbench::text(ratio(row.ns, other->ns, options.rays.seed), 3).c_str());
    text += format(" %8s %8llu %8llu", row.visits ? count(*row.visits).c_str() : "",
                   static_cast<unsigned long long>(row.verdict.wrong),
                   static_cast<unsigned long long>(row.verdict.missed));
    if (row.verdict.rays != workload.rays)
      text += format("  of %llu rays", static_cast<unsigned long long>(row.verdict.rays));
    text += "\n";
  }
  return text;
}

Json summary_json(const Summary& summary) {
  return {{"median", summary.median}, {"low", summary.low}, {"high", summary.high}};
}

Json row_json(const RaceRow& row, const RaceWorkload& workload, const RaceOptions& options) {
  Json json = {{"tracer", row.tracer.name}, {"exact", row.tracer.exact}, {"rays", row.verdict.rays}};
  json["ns"] = summary_json(summarize(row.ns));
  json["ns"]["all"] = row.ns;
  for (const RaceRow* other : {workload.find(options.against), best_embree(workload)})
    if (other) json["ratios"][other->tracer.name] = summary_json(ratio(row.ns, other->ns, options.rays.seed));
  if (row.visits) json["visits"] = *row.visits;
  json["wrong"] = row.verdict.wrong;
  json["missed"] = row.verdict.missed;
  return json;
}

Json mesh_json(const RaceMesh& mesh, const RaceOptions& options) {
  Json json = {{"file", mesh.file},
               {"triangles", mesh.triangles},
               {"faces", mesh.faces},
               {"tets", mesh.tets},
               {"vertices", mesh.vertices},
               {"file_bytes", mesh.file_bytes},
               {"open_ms", summary_json(summarize(mesh.open_ms))},
               {"validate_ms", summary_json(summarize(mesh.validate_ms))},
               {"structures", Json::array()},
               {"workloads", Json::array()}};
  for (const Structure& s : mesh.structures) {
    Json structure = {
        {"name", s.name},
        {"bytes", s.bytes},
        {"bytes_per_triangle", static_cast<double>(s.bytes) / static_cast<double>(mesh.triangles)},
        {"bytes_per_tet", static_cast<double>(s.bytes) / static_cast<double>(mesh.tets)}};
    if (!s.version.empty()) structure["version"] = s.version;
    if (s.build_seconds > 0) structure["build_seconds"] = s.build_seconds;
    json["structures"].push_back(structure);
  }
  for (const RaceWorkload& w : mesh.workloads) {
    Json workload = {{"name", w.name},
                     {"description", w.description},
                     {"rays", w.rays},
                     {"hits", w.hits},
                     {"asked", w.occlusion ? "occlusion" : "first hit"},
                     {"coherent", w.coherent},
                     {"sample", w.sample},
                     {"sample_wrong", w.sample_failed},
                     {"rows", Json::array()}};
    if (w.distance) workload["distance"] = *w.distance;
    for (const RaceRow& row : w.rows) workload["rows"].push_back(row_json(row, w, options));
    json["workloads"].push_back(workload);
  }
  return json;
}

}  // namespace

std::string race_table(const RaceResult& result) {
  const RaceOptions& options = result.options;
  std::string text = "tet bench: the same rays for every tracer\n" + provenance_text();
  text += format(
      "seed %llu; views of %d x %d rays; one thread, processor time; median (lowest .. highest) of %d\n"
      "repetitions in turn, each in another order; ratios: median of the repetitions' (95 %% by the "
      "bootstrap)\n",
      static_cast<unsigned long long>(options.rays.seed), options.rays.size, options.rays.size,
      options.repeats);
  for (const RaceMesh& mesh : result.meshes) {
    text +=
        format("\n%s: %zu triangles, %zu tets, %zu vertices, %llu bytes\n", mesh.file.c_str(), mesh.triangles,
               mesh.tets, mesh.vertices, static_cast<unsigned long long>(mesh.file_bytes));
    text += structures_text(mesh, options.repeats);
    for (const RaceWorkload& workload : mesh.workloads) text += workload_text(workload, options);
  }
  text += race_summary(result);
  text += format("\n%.1f s in all; answers of exact tracers that are wrong: %llu\n", result.seconds,
                 static_cast<unsigned long long>(result.failures()));
  return text;
}

std::string race_csv(const RaceResult& result) {
  std::string text =
      "file,triangles,tets,workload,distance,tracer,exact,rays,ns,ns_low,ns_high,against,ratio,ratio_low,"
      "ratio_high,visits,wrong,missed\n";
  for (const RaceMesh& mesh : result.meshes)
    for (const RaceWorkload& workload : mesh.workloads)
      for (const RaceRow& row : workload.rows) {
        text += quoted(mesh.file) + format(",%zu,%zu,", mesh.triangles, mesh.tets) + workload.name + "," +
                (workload.distance ? number(*workload.distance) : "") + "," + row.tracer.name + "," +
                (row.tracer.exact ? "1" : "0") + "," + std::to_string(row.verdict.rays);
        const auto add = [&](const Summary& s) {
          text += "," + number(s.median) + "," + number(s.low) + "," + number(s.high);
        };
        add(summarize(row.ns));
        text += "," + result.options.against;
        if (const RaceRow* against = workload.find(result.options.against))
          add(ratio(row.ns, against->ns, result.options.rays.seed));
        else
          text += ",,,";
        text += "," + (row.visits ? number(*row.visits) : "") + "," + std::to_string(row.verdict.wrong) +
                "," + std::to_string(row.verdict.missed) + "\n";
      }
  return text;
}

std::string race_json(const RaceResult& result) {
  const RaceOptions& options = result.options;
  Json json = {{"benchmark", "race"}};
  for (const auto& [name, value] : provenance()) json[name] = value;
  json["seed"] = options.rays.seed;
  json["size"] = options.rays.size;
  json["field_of_view"] = options.rays.field_of_view;
  json["repeats"] = options.repeats;
  json["against"] = options.against;
  json["peer_epsilon_diagonals"] = kPeerEpsilon;
  json["seconds"] = result.seconds;
  json["failures"] = result.failures();
  json["meshes"] = Json::array();
  for (const RaceMesh& mesh : result.meshes) json["meshes"].push_back(mesh_json(mesh, options));
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace tetbench
