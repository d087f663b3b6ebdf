// SPDX-License-Identifier: AGPL-3.0-or-later
// What `tet bench` found, as pictures.
#include <algorithm>
#include <map>
#include <set>

#include "bench/plot.hpp"
#include "bench/provenance.hpp"
#include "bench/race.hpp"
#include "bench/statistics.hpp"
#include "bench/text.hpp"

namespace tetbench {
namespace {

/// Colours that people of any sight tell apart (Okabe and Ito 2008), by family.
constexpr const char* kColors[] = {"#0072b2", "#56b4e9", "#d55e00", "#e69f00",
                                   "#009e73", "#cc79a7", "#000000"};

using Marks = std::map<std::string, Mark>;

/// The same for every picture: a shape for each of a family; what is ours and not exact is hollow.
Marks marks_of_all() {
  Marks marks;
  std::map<Family, std::size_t> shapes;
  for (const TracerKind& kind : tracer_kinds()) {
    const bool ours = kind.family == Family::tet20 || kind.family == Family::tet16;
    marks[kind.name] = {kColors[static_cast<std::size_t>(kind.family)],
                        static_cast<Shape>(shapes[kind.family]++ % kShapes), kind.exact || !ours};
  }
  return marks;
}

std::string base_name(const std::string& path) {
  const std::string name = path.substr(path.find_last_of('/') + 1);
  return name.substr(0, name.rfind('.'));
}

std::string note() {
  std::string text = "one thread, processor time, median;";
  for (const auto& [name, value] : provenance())
    if (name == "processor" || name == "commit" || name == "compiler") text += " " + name + " " + value + ";";
  return text.substr(0, text.size() - 1);
}

std::string title(const RaceMesh& mesh, const std::string& what) {
  return format("%s (%zu triangles): ", base_name(mesh.file).c_str(), mesh.triangles) + what;
}

/// Nanoseconds a ray against error rate: a panel a workload, a mark a tracer.
Picture errors(const RaceMesh& mesh, const Marks& marks) {
  std::vector<Panel> panels;
  for (const RaceWorkload& workload : mesh.workloads) {
    Panel panel{workload.name,
                {"wrong or missed, of a million rays", true, false, "none", 1, 1e6},
                {"ns a ray", true},
                {}};
    for (const RaceRow& row : workload.rows) {
      const double wrong = static_cast<double>(row.verdict.wrong + row.verdict.missed);
      panel.series.push_back(
          {row.tracer.name,
           marks.at(row.tracer.name),
           false,
           {{1e6 * wrong / static_cast<double>(row.verdict.rays), summarize(row.ns).median}}});
    }
    panels.push_back(std::move(panel));
  }
  return {base_name(mesh.file) + "-errors.svg", figure(title(mesh, "time against errors"), note(), panels)};
}

/// Table 1 of Aman, Demirci and Gudukbay (2022): time, and visited nodes or tetrahedra, against distance.
std::optional<Picture> table1(const RaceMesh& mesh, const Marks& marks) {
  const Axis distance{"distance of the camera; the surface's extent is 10", false, true};
  Panel times{"Time", distance, {"ns a ray", true}, {}},
      visits{"Visited", distance, {"nodes or tetrahedra a ray", true}, {}};
  std::size_t views = 0;
  for (const RaceWorkload& workload : mesh.workloads) {
    if (!workload.distance || workload.name.ends_with("-shuffled")) continue;
    ++views;
    for (const RaceRow& row : workload.rows) {
      const auto add = [&](Panel& panel, double value) {
        auto series = std::find_if(panel.series.begin(), panel.series.end(),
                                   [&](const Series& each) { return each.name == row.tracer.name; });
        if (series == panel.series.end())
          series = panel.series.insert(series, {row.tracer.name, marks.at(row.tracer.name), true, {}});
        series->points.push_back({*workload.distance, value});
      };
      add(times, summarize(row.ns).median);
      if (row.visits) add(visits, *row.visits);
    }
  }
  if (views < 2) return std::nullopt;
  return Picture{base_name(mesh.file) + "-table1.svg",
                 figure(title(mesh, "camera rays from far to touching"), note(), {times, visits})};
}

/// Cost against size: a panel a workload.
Picture growth(const RaceResult& result, const Marks& marks) {
  std::vector<Panel> panels;
  for (const RaceMesh& mesh : result.meshes)
    for (const RaceWorkload& workload : mesh.workloads) {
      auto panel = std::find_if(panels.begin(), panels.end(),
                                [&](const Panel& each) { return each.title == workload.name; });
      if (panel == panels.end())
        panel = panels.insert(panel, {workload.name, {"triangles", true}, {"ns a ray", true}, {}});
      for (const RaceRow& row : workload.rows) {
        auto series = std::find_if(panel->series.begin(), panel->series.end(),
                                   [&](const Series& each) { return each.name == row.tracer.name; });
        if (series == panel->series.end())
          series = panel->series.insert(series, {row.tracer.name, marks.at(row.tracer.name), true, {}});
        series->points.push_back({static_cast<double>(mesh.triangles), summarize(row.ns).median});
      }
    }
  for (Panel& panel : panels)
    for (Series& series : panel.series)
      std::sort(series.points.begin(), series.points.end(),
                [](const Series::Point& a, const Series::Point& b) { return a.x < b.x; });
  return {"growth.svg", figure("Cost against size", note(), panels)};
}

}  // namespace

std::vector<Picture> race_pictures(const RaceResult& result) {
  const Marks marks = marks_of_all();
  std::vector<Picture> pictures;
  std::set<std::string> names;
  for (const RaceMesh& mesh : result.meshes) {
    std::vector<Picture> of_mesh;
    if (!mesh.workloads.empty()) of_mesh.push_back(errors(mesh, marks));
    if (auto picture = table1(mesh, marks)) of_mesh.push_back(std::move(*picture));
    for (Picture& picture : of_mesh) {
      // Files of one name in several folders.
      for (int again = 2; !names.insert(picture.name).second; ++again)
        picture.name = format("%d-", again) + picture.name;
      pictures.push_back(std::move(picture));
    }
  }
  if (result.meshes.size() > 1) pictures.push_back(growth(result, marks));
  return pictures;
}

}  // namespace tetbench
