// SPDX-License-Identifier: AGPL-3.0-or-later
#include <array>
#include <cmath>
#include <nlohmann/json.hpp>

#include "prep/pipeline.hpp"
#include "tetfmt/version.hpp"

namespace tetprep {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::array kOptimizeNames = {"none", "fast", "best"};
constexpr std::array kKeepNames = {"all", "outside", "reachable-from"};
constexpr std::array kAttributeNames = {"none", "normals", "all"};

template <std::size_t N, class Enum>
const char* name_of(const std::array<const char*, N>& names, Enum value) {
  return names[static_cast<std::size_t>(value)];
}

Json options_json(const ConvertOptions& options) {
  Json json = {{"layout", options.layout == tetfmt::Layout::tet20 ? "tet20" : "tet16"},
               {"threads", options.threads},
               {"radius_edge", options.radius_edge},
               {"optimize", name_of(kOptimizeNames, options.optimize)},
               {"time_limit_seconds", options.time_limit},
               {"memory_limit_bytes", options.memory_limit},
               {"attributes", name_of(kAttributeNames, options.attributes)},
               {"surface", options.draco ? "draco" : "plain"},
               {"keep", name_of(kKeepNames, options.keep)},
               {"simplify", options.simplify}};
  if (options.keep == Keep::reachable_from) json["reachable_from"] = options.reachable_from;
  return json;
}

Json resolve_json(const ResolveReport& report) {
  return {{"intersecting_pairs", report.intersecting_pairs},
          {"rounds", report.rounds},
          {"cut_triangles", report.cut_triangles},
          {"pieces", report.pieces},
          {"new_points", report.new_points},
          {"overlaps", report.overlaps},
          {"grid_coarsening", report.grid_coarsening},
          {"max_deviation", report.max_deviation}};
}

Json tetgen_json(const TetrahedralizeReport& report) {
  Json failed = Json::array();
  for (const FailedAttempt& attempt : report.failed_attempts)
    failed.push_back({{"switches", attempt.switches}, {"reason", attempt.reason}});
  return {{"switches", report.switches},
          {"seconds", report.tetgen_seconds},
          {"failed_attempts", failed},
          {"grid_refinement", report.grid_refinement},
          {"cut_triangles", report.cut_triangles},
          {"cut_deviation", report.cut_deviation},
          {"steiner_points", report.steiner_points},
          {"moved_steiner_points", report.moved_steiner_points}};
}

Json attributes_json(const AttributeReport& report) {
  return {{"materials", report.materials},
          {"objects", report.objects},
          {"surface_points", report.surface_points},
          {"normals", report.normals},
          {"texcoords", report.texcoords},
          {"colors", report.colors},
          {"properties", report.properties},
          {"sections", report.sections},
          {"bytes", report.bytes},
          {"bytes_saved", report.bytes_saved}};
}

Json result_json(const ConvertReport& report) {
  const auto per = [&](std::size_t count) {
    return count == 0 ? 0.0 : static_cast<double>(report.output_bytes) / static_cast<double>(count);
  };
  return {{"vertices", report.vertices},
          {"tets", report.tets},
          {"sides", report.sides},
          {"hull_faces", report.hull_faces},
          {"bytes", report.output_bytes},
          {"bytes_per_tet", per(report.tets)},
          {"bytes_per_triangle", per(report.input_triangles)}};
}

}  // namespace

std::string fallback_note(const TetrahedralizeReport& report) {
  if (report.failed_attempts.empty()) return {};
  std::string text;
  for (const FailedAttempt& attempt : report.failed_attempts)
    text += (text.empty() ? "TetGen -" : "; -") + attempt.switches + " failed (" + attempt.reason + ")";
  return text + "; used -" + report.switches + " instead, so the tets differ from what was asked for";
}

std::string outcome(const ConvertReport& report, const Failure* failure) {
  if (failure == nullptr) return report.resolve.intersecting_pairs > 0 ? "ok (cut)" : "ok";
  switch (failure->code()) {
    case ExitCode::usage:
      return "usage";
    case ExitCode::io:
      return "io";
    case ExitCode::invalid:
      return "invalid";
    case ExitCode::unsupported:
      return "unsupported";
    default:
      return "runtime";
  }
}

std::string to_json(const ConvertOptions& options, const ConvertReport& report, const Failure* failure) {
  Json json;
  json["program"] = "tet convert";
  json["version"] = TETFMT_VERSION;
  json["outcome"] = outcome(report, failure);
  if (failure != nullptr) {
    json["error"] = failure->what();
    json["exit_code"] = static_cast<int>(failure->code());
  }
  json["inputs"] = options.inputs;
  json["output"] = options.output;
  json["options"] = options_json(options);
  json["warnings"] = report.warnings;
  json["surface"] = {{"input_points", report.input_points},
                     {"input_triangles", report.input_triangles},
                     {"merged_points", report.merged_points},
                     {"degenerate_triangles", report.degenerate_triangles},
                     {"duplicate_triangles", report.duplicate_triangles},
                     {"points", report.surface_points},
                     {"triangles", report.surface_triangles}};
  if (options.simplify > 0)
    json["simplify"] = {{"triangles_before", report.simplify.triangles_before},
                        {"triangles_after", report.simplify.triangles_after},
                        {"skipped_triangles", report.simplify.skipped_triangles},
                        {"max_deviation", report.simplify.max_deviation}};
  json["grid"] = {{"exponent", report.grid_exponent},
                  {"step", std::ldexp(1.0, report.grid_exponent)},
                  {"origin", report.origin},
                  {"coarser_bits", report.coarser_bits},
                  {"max_deviation", report.max_deviation}};
  json["resolve"] = resolve_json(report.resolve);
  if (report.tetrahedralize.intersection_count > 0) {
    json["intersection_count"] = report.tetrahedralize.intersection_count;
    json["intersections"] = report.tetrahedralize.intersections;
  }
  json["tetgen"] = tetgen_json(report.tetrahedralize);
  if (options.optimize != Optimize::none)
    json["crossings"] = {{"replacements", report.crossings.replacements},
                         {"new_points", report.crossings.new_points},
                         {"dropped_points", report.crossings.dropped_points},
                         {"area_before", report.crossings.area_before},
                         {"area_after", report.crossings.area_after}};
  json["regions"] = {{"count", report.regions.count},
                     {"kept", report.regions.kept},
                     {"left_out", report.regions.count - report.regions.kept},
                     {"tets_left_out", report.regions.tets_left_out},
                     {"bytes_saved", report.regions.bytes_saved}};
  json["attributes"] = attributes_json(report.attributes);
  json["result"] = result_json(report);
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
