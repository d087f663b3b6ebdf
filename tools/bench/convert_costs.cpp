// SPDX-License-Identifier: AGPL-3.0-or-later
#include "bench/convert_costs.hpp"

#include <stdlib.h>

#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>

#include "bench/provenance.hpp"
#include "bench/statistics.hpp"
#include "bench/text.hpp"
#include "common/failure.hpp"
#include "common/parse.hpp"
#include "prep/pipeline.hpp"

namespace tetbench {
namespace {

using Json = nlohmann::ordered_json;
using tetprep::number;

constexpr std::pair<const char*, tetprep::Optimize> kEfforts[] = {
    {"none", tetprep::Optimize::none}, {"fast", tetprep::Optimize::fast}, {"best", tetprep::Optimize::best}};

/// Removed with everything in it.
class TemporaryFolder {
 public:
  TemporaryFolder() {
    const char* chosen = getenv("TMPDIR");
    const std::string parent = chosen && *chosen != 0 ? chosen : "/tmp";
    path_ = parent + "/tet-bench-XXXXXX";
    if (mkdtemp(path_.data()) == nullptr)
      throw tetprep::Failure(
          tetprep::ExitCode::io,
          parent + ": cannot make a folder for temporary files there; set TMPDIR to another place");
  }
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;
  ~TemporaryFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  std::string file(const std::string& name) const { return path_ + "/" + name; }

 private:
  std::string path_;
};

double seconds_of(const tetprep::ConvertReport& report, const std::string& stage) {
  double sum = 0;
  for (const tetprep::StageCost& cost : report.stages)
    if (cost.name == stage) sum += cost.seconds;
  return sum;
}

void add(ConvertCost& cost, const tetprep::ConvertReport& report) {
  cost.triangles = report.input_triangles;
  cost.tets = report.tets;
  cost.seconds.push_back(report.seconds);
  cost.tetgen.push_back(report.tetrahedralize.tetgen_seconds);
  cost.reduce_crossings.push_back(seconds_of(report, "reduce crossings"));
  cost.area_before = report.crossings.area_before;
  cost.area_after = report.crossings.area_after;
  cost.peak_memory_mb = std::max(cost.peak_memory_mb, report.peak_memory_mb);
  for (const tetprep::StageCost& stage : report.stages) {
    auto known = std::find_if(cost.stages.begin(), cost.stages.end(),
                              [&](const StageSeconds& each) { return each.name == stage.name; });
    if (known == cost.stages.end()) known = cost.stages.insert(known, {stage.name, {}});
    // A stage may run more than once in a conversion; what counts is all of it.
    if (known->seconds.size() < cost.seconds.size()) known->seconds.push_back(0);
    known->seconds.back() += stage.seconds;
  }
}

/// Of TetGen's time; 0 if the stage was left out. Nothing if TetGen took less than the clock tells.
std::optional<Summary> share(const ConvertCost& cost) {
  if (std::any_of(cost.tetgen.begin(), cost.tetgen.end(), [](double s) { return !(s > 0); }))
    return std::nullopt;
  return ratio(cost.reduce_crossings, cost.tetgen, 1);
}

Json summary_json(const Summary& summary) {
  return {{"median", summary.median}, {"low", summary.low}, {"high", summary.high}};
}

}  // namespace

std::vector<ConvertCost> convert_costs(const std::vector<std::string>& meshes, int repeats,
                                       tetprep::Progress& progress) {
  const TemporaryFolder folder;
  for (const std::string& mesh : meshes) {
    progress.stage("read " + mesh);
    tetprep::read_soup(mesh);
  }
  std::vector<ConvertCost> costs;
  for (const std::string& mesh : meshes) {
    const std::size_t first = costs.size();
    for (const auto& [name, effort] : kEfforts) {
      costs.emplace_back();
      costs.back().file = mesh;
      costs.back().optimize = name;
    }
    for (int repeat = 0; repeat < repeats; ++repeat)
      for (std::size_t i = 0; i < std::size(kEfforts); ++i) {
        tetprep::ConvertOptions options;
        options.inputs = {mesh};
        options.output = folder.file("out.tet");
        options.optimize = kEfforts[i].second;
        options.threads = 1;
        progress.stage(
            format("convert %s, %s, %d of %d", mesh.c_str(), kEfforts[i].first, repeat + 1, repeats));
        tetprep::Progress quiet;
        add(costs[first + i], tetprep::convert(options, quiet));
      }
  }
  return costs;
}

std::string convert_table(const std::vector<ConvertCost>& costs, int repeats) {
  std::string result = "tet bench --convert: seconds by the clock\n" + provenance_text();
  result += format(
      "one thread beside TetGen's process; median (lowest .. highest) of %d repetitions in turn\n", repeats);
  for (const ConvertCost& cost : costs) {
    result += format("\n%s, --optimize %s: %zu triangles, %zu tets, %.0f MB\n", cost.file.c_str(),
                     cost.optimize.c_str(), cost.triangles, cost.tets, cost.peak_memory_mb);
    const auto line = [&](const std::string& name, const std::vector<double>& seconds) {
      result += format("  %-28s %s\n", name.c_str(), text(summarize(seconds), 3).c_str());
    };
    for (const StageSeconds& stage : cost.stages)
      line((stage.name.starts_with("tetgen: ") ? "  " : "") + stage.name, stage.seconds);
    line("in all", cost.seconds);
    line("of that TetGen", cost.tetgen);
    const std::optional<Summary> of_tetgen = share(cost);
    if (cost.area_before > 0)
      result += format("  reducing crossings / TetGen  %s; area of unconstrained faces %.2f -> %.2f boxes\n",
                       of_tetgen ? text(*of_tetgen, 3).c_str() : "-", cost.area_before, cost.area_after);
  }
  return result;
}

std::string convert_csv(const std::vector<ConvertCost>& costs) {
  std::string text = "file,triangles,tets,optimize,stage,seconds,seconds_low,seconds_high\n";
  for (const ConvertCost& cost : costs) {
    const auto line = [&](const std::string& stage, const std::vector<double>& seconds) {
      const Summary s = summarize(seconds);
      text += quoted(cost.file) + format(",%zu,%zu,", cost.triangles, cost.tets) + cost.optimize + "," +
              quoted(stage) + "," + number(s.median) + "," + number(s.low) + "," + number(s.high) + "\n";
    };
    for (const StageSeconds& stage : cost.stages) line(stage.name, stage.seconds);
    line("all", cost.seconds);
    line("all of tetgen", cost.tetgen);
  }
  return text;
}

std::string convert_json(const std::vector<ConvertCost>& costs, int repeats) {
  Json json = {{"benchmark", "convert"}};
  for (const auto& [name, value] : provenance()) json[name] = value;
  json["repeats"] = repeats;
  json["conversions"] = Json::array();
  for (const ConvertCost& cost : costs) {
    const std::optional<Summary> of_tetgen = share(cost);
    Json entry = {{"file", cost.file},
                  {"optimize", cost.optimize},
                  {"triangles", cost.triangles},
                  {"tets", cost.tets},
                  {"peak_memory_mb", cost.peak_memory_mb},
                  {"seconds", summary_json(summarize(cost.seconds))},
                  {"tetgen_seconds", summary_json(summarize(cost.tetgen))},
                  {"reduce_crossings_seconds", summary_json(summarize(cost.reduce_crossings))},
                  {"reduce_crossings_to_tetgen", of_tetgen ? summary_json(*of_tetgen) : Json()},
                  {"area_before", cost.area_before},
                  {"area_after", cost.area_after},
                  {"stages", Json::array()}};
    for (const StageSeconds& stage : cost.stages)
      entry["stages"].push_back({{"name", stage.name}, {"seconds", summary_json(summarize(stage.seconds))}});
    json["conversions"].push_back(entry);
  }
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace tetbench
