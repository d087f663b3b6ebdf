// SPDX-License-Identifier: AGPL-3.0-or-later
// What `tet bench` found, in short: tables of Markdown, to be read as they are or pasted into a page.
#include <algorithm>

#include "bench/race.hpp"
#include "bench/statistics.hpp"
#include "bench/text.hpp"

namespace tetbench {
namespace {

std::string digits(double value, int significant) {
  const int before = value >= 100 ? 3 : value >= 10 ? 2 : 1;
  return format("%.*f", std::max(0, significant - before), value);
}

using Cells = std::vector<std::vector<std::string>>;

/// The first row is the head. Rows without anything but their name are left out, and so is a table
/// without other rows.
std::string table(const std::string& title, Cells rows) {
  std::erase_if(rows, [](const std::vector<std::string>& row) {
    return std::all_of(row.begin() + 1, row.end(), [](const std::string& cell) { return cell.empty(); });
  });
  if (rows.size() == 1) return "";
  std::vector<std::size_t> widths(rows.front().size(), 1);
  for (const auto& row : rows)
    for (std::size_t k = 0; k < row.size(); ++k) widths[k] = std::max(widths[k], row[k].size());
  std::string text = "\n" + title + "\n\n";
  for (std::size_t i = 0; i < rows.size(); ++i) {
    for (std::size_t k = 0; k < widths.size(); ++k) {
      const std::string blanks(widths[k] - rows[i][k].size(), ' ');
      text += "| " + (k == 0 ? rows[i][k] + blanks : blanks + rows[i][k]) + " ";
    }
    text += "|\n";
    if (i > 0) continue;
    for (std::size_t k = 0; k < widths.size(); ++k)
      text += "|" + (k == 0 ? std::string(widths[k] + 2, '-') : std::string(widths[k] + 1, '-') + ":");
    text += "|\n";
  }
  return text;
}

/// A row a tracer, a column for each of `columns`: `cell` has the text for a row of results, if there is one.
template <class Cell>
std::string by_tracer(const std::string& title, const std::vector<std::string>& heads,
                      const std::vector<const RaceWorkload*>& columns, const RaceResult& result, Cell cell) {
  Cells rows = {{"tracer"}};
  rows[0].insert(rows[0].end(), heads.begin(), heads.end());
  for (const TracerKind& kind : chosen_tracers(result.options.tracers)) {
    rows.push_back({kind.name});
    for (const RaceWorkload* workload : columns) {
      const RaceRow* row = workload ? workload->find(kind.name) : nullptr;
      rows.back().push_back(row ? cell(*workload, *row) : "");
    }
  }
  return table(title, std::move(rows));
}

std::string ns(const RaceWorkload&, const RaceRow& row) {
  return digits(summarize(row.ns).median, 3);
}

}  // namespace

std::string race_summary(const RaceResult& result) {
  const RaceOptions& options = result.options;
  std::string text;
  for (const RaceMesh& mesh : result.meshes) {
    std::vector<std::string> heads;
    std::vector<const RaceWorkload*> columns;
    for (const RaceWorkload& workload : mesh.workloads) {
      heads.push_back(workload.name);
      columns.push_back(&workload);
    }
    const auto add = [&](const char* what, auto cell) {
      text += by_tracer(mesh.file + ": " + what, heads, columns, result, cell);
    };
    add("nanoseconds a ray", ns);
    add(("time / " + options.against).c_str(), [&](const RaceWorkload& workload, const RaceRow& row) {
      const RaceRow* against = workload.find(options.against);
      return against ? digits(ratio(row.ns, against->ns, options.rays.seed).median, 3) : "";
    });
    add("visited nodes or tetrahedra a ray",
        [](const RaceWorkload&, const RaceRow& row) { return row.visits ? digits(*row.visits, 3) : ""; });
    add("wrong + missed", [](const RaceWorkload& workload, const RaceRow& row) {
      const auto [rays, wrong, missed] = row.verdict;
      std::string counts = wrong + missed == 0 ? "0" : std::to_string(wrong) + " + " + std::to_string(missed);
      if (rays != workload.rays) counts += " of " + std::to_string(rays);
      return counts;
    });
  }
  if (result.meshes.size() < 2) return text;
  // Cost against size: a table a workload.
  std::vector<std::string> names, heads;
  for (const RaceMesh& mesh : result.meshes) {
    heads.push_back(format("%zu triangles", mesh.triangles));
    for (const RaceWorkload& workload : mesh.workloads)
      if (std::find(names.begin(), names.end(), workload.name) == names.end()) names.push_back(workload.name);
  }
  for (const std::string& name : names) {
    std::vector<const RaceWorkload*> columns;
    for (const RaceMesh& mesh : result.meshes) {
      const auto found = std::find_if(mesh.workloads.begin(), mesh.workloads.end(),
                                      [&](const RaceWorkload& each) { return each.name == name; });
      columns.push_back(found == mesh.workloads.end() ? nullptr : &*found);
    }
    text += by_tracer(name + ": nanoseconds a ray, by mesh", heads, columns, result, ns);
  }
  return text;
}

}  // namespace tetbench
