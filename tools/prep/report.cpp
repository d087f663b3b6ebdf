// SPDX-License-Identifier: AGPL-3.0-or-later
#include <array>
#include <nlohmann/json.hpp>

#include "prep/pipeline.hpp"
#include "tetfmt/version.hpp"

namespace tetprep {
namespace {

constexpr std::array kOptimizeNames = {"none", "fast", "best"};

}  // namespace

std::string fallback_note(const TetrahedralizeReport& report) {
  if (report.failed_attempts.empty()) return {};
  std::string text;
  for (const FailedAttempt& attempt : report.failed_attempts)
    text += (text.empty() ? "TetGen -" : "; -") + attempt.switches + " failed (" + attempt.reason + ")";
  return text + "; used -" + report.switches + " instead, so the tets differ from what was asked for";
}

std::string to_json(const ConvertOptions& options, const ConvertReport& report, const std::string& error) {
  using Json = nlohmann::ordered_json;
  Json json;
  json["program"] = "tet convert";
  json["version"] = TETFMT_VERSION;
  if (!error.empty()) json["error"] = error;
  json["inputs"] = options.inputs;
  json["output"] = options.output;
  json["options"] = {{"layout", options.layout == tetfmt::Layout::tet20 ? "tet20" : "tet16"},
                     {"threads", options.threads},
                     {"radius_edge", options.radius_edge},
                     {"optimize", kOptimizeNames[static_cast<std::size_t>(options.optimize)]},
                     {"time_limit_seconds", options.time_limit}};
  json["surface"] = {{"input_points", report.input_points},
                     {"input_triangles", report.input_triangles},
                     {"merged_points", report.merged_points},
                     {"degenerate_triangles", report.degenerate_triangles},
                     {"duplicate_triangles", report.duplicate_triangles},
                     {"points", report.surface_points},
                     {"triangles", report.surface_triangles}};
  json["grid"] = {
      {"exponent", report.grid_exponent}, {"origin", report.origin}, {"max_deviation", report.max_deviation}};
  const TetrahedralizeReport& tetgen = report.tetrahedralize;
  Json failed = Json::array();
  for (const FailedAttempt& attempt : tetgen.failed_attempts)
    failed.push_back({{"switches", attempt.switches}, {"reason", attempt.reason}});
  json["tetgen"] = {{"switches", tetgen.switches},
                    {"seconds", tetgen.tetgen_seconds},
                    {"failed_attempts", failed},
                    {"steiner_points", tetgen.steiner_points},
                    {"moved_steiner_points", tetgen.moved_steiner_points}};
  if (tetgen.intersection_count > 0) {
    json["intersection_count"] = tetgen.intersection_count;
    json["intersections"] = tetgen.intersections;
  }
  if (options.optimize != Optimize::none) {
    json["crossings"] = {{"flips", report.crossings.flips},
                         {"area_before", report.crossings.area_before},
                         {"area_after", report.crossings.area_after}};
  }
  const auto per = [&](std::size_t count) {
    return count == 0 ? 0.0 : static_cast<double>(report.output_bytes) / static_cast<double>(count);
  };
  json["result"] = {{"vertices", report.vertices},
                    {"tets", report.tets},
                    {"sides", report.sides},
                    {"hull_faces", report.hull_faces},
                    {"bytes", report.output_bytes},
                    {"bytes_per_tet", per(report.tets)},
                    {"bytes_per_triangle", per(report.input_triangles)}};
  Json stages = Json::array();
  for (const StageCost& stage : report.stages)
    stages.push_back(
        {{"name", stage.name}, {"seconds", stage.seconds}, {"peak_memory_mb", stage.peak_memory_mb}});
  json["stages"] = stages;
  json["seconds"] = report.seconds;
  json["peak_memory_mb"] = report.peak_memory_mb;
  // A path may hold any bytes; JSON may not.
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace tetprep
