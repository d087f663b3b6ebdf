// SPDX-License-Identifier: AGPL-3.0-or-later
#include <algorithm>
#include <array>
#include <nlohmann/json.hpp>

#include "bench/provenance.hpp"
#include "bench/stress.hpp"
#include "bench/text.hpp"
#include "common/parse.hpp"
#include "common/threads.hpp"

namespace tetbench {
namespace {

using Json = nlohmann::ordered_json;
using tetprep::number;

constexpr std::array<const char*, 2> kPeerNames = {"embree", "embree_robust"};  // the order of Tester
constexpr std::array<double, 3> kQuantiles = {0.5, 0.99, 0.9999};
constexpr std::array<const char*, 3> kQuantileNames = {"50", "99", "99_99"};

std::string base_name(const std::string& path) {
  return path.substr(path.find_last_of('/') + 1);
}

double percent(std::uint64_t part, std::uint64_t whole) {
  return whole == 0 ? 0 : 100 * static_cast<double>(part) / static_cast<double>(whole);
}

std::uint64_t all_signs(const tetfmt::SignCounts& s) {
  return s.in_float + s.in_double + s.in_double2 + s.exact + s.tied;
}

std::string row_text(const std::string& name, const Tally& t) {
  std::string text = format("%-24s %10llu %5.1f", name.c_str(), static_cast<unsigned long long>(t.rays),
                            percent(t.hits, t.rays));
  for (const std::uint64_t faults : t.faults)
    text += format(" %7llu", static_cast<unsigned long long>(faults));
  text += format(" %8llu %6llu", static_cast<unsigned long long>(t.float_wrong),
                 static_cast<unsigned long long>(t.float_lost));
  for (const double share : kQuantiles) text += format(" %5.2f", t.steep.quantile(share));
  text += format(" %5.2f", t.steep.max());
  const std::uint64_t signs = all_signs(t.signs);
  text += format(" %8.3f %8.4f %8.4f", percent(t.signs.in_double2, signs), percent(t.signs.exact, signs),
                 percent(t.signs.tied, signs));
  text += format(" %6.2f\n", t.rays == 0 ? 0 : 1e6 * t.seconds / static_cast<double>(t.rays));
  return text;
}

std::string header_text() {
  std::string text = format("%-24s %10s %5s", "", "rays", "hit %");
  for (const char* name : kFaultNames) text += format(" %7s", name);
  text += format(" %8s %6s %5s %5s %5s %5s %8s %8s %8s %6s\n", "fl.wrong", "lost", "ulp50", "99", "99.99",
                 "max", "double2%", "exact%", "tied%", "us/ray");
  return text;
}

std::string reproducer_text(const Reproducer& r) {
  const bool segment = r.set == "segments";
  std::string text =
      format("%s, %s, %s: ", r.file.c_str(), r.set.c_str(), kFaultNames[static_cast<std::size_t>(r.fault)]);
  text += r.text + "\n    ";
  text += format(segment ? "from %a %a %a to %a %a %a" : "origin %a %a %a direction %a %a %a", r.origin[0],
                 r.origin[1], r.origin[2], r.direction[0], r.direction[1], r.direction[2]);
  if (!segment && (r.t_min != 0 || r.t_max < 1e308)) text += format(" interval %a %a", r.t_min, r.t_max);
  if (r.from_side != tetfmt::kNone) text += " from side " + std::to_string(r.from_side);
  return text + "\n";
}

Json tally_json(const Tally& t) {
  Json json = {
      {"rays", t.rays}, {"hits", t.hits}, {"all_hits_crossings", t.crossings}, {"leaving_rays", t.leaving}};
  for (std::size_t i = 0; i < t.faults.size(); ++i) json["faults"][kFaultNames[i]] = t.faults[i];
  json["float_kernel"] = {{"wrong", t.float_wrong}, {"lost", t.float_lost}};
  const auto ulps = [](const UlpHistogram& histogram) {
    Json quantiles = {{"hits", histogram.count()}};
    for (std::size_t i = 0; i < kQuantiles.size(); ++i)
      quantiles[kQuantileNames[i]] = histogram.quantile(kQuantiles[i]);
    quantiles["max"] = histogram.max();  // infinity is null
    return quantiles;
  };
  json["t_error_ulp"] = {{"above_1_degree", ulps(t.steep)}, {"below_1_degree", ulps(t.shallow)}};
  json["signs"] = {{"in_double", t.signs.in_double},
                   {"in_double2", t.signs.in_double2},
                   {"exact", t.signs.exact},
                   {"tied", t.signs.tied}};
  Json peers = Json::object();
  for (std::size_t i = 0; i < t.peers.size(); ++i)
    if (t.peers[i].rays > 0)
      peers[kPeerNames[i]] = {
          {"rays", t.peers[i].rays}, {"wrong", t.peers[i].wrong}, {"missed", t.peers[i].missed}};
  json["peers"] = peers;
  json["thread_seconds"] = t.seconds;
  return json;
}

Json reproducer_json(const Reproducer& r) {
  Json json = {{"fault", kFaultNames[static_cast<std::size_t>(r.fault)]},
               {"file", r.file},
               {"set", r.set},
               {"text", r.text}};
  json[r.set == "segments" ? "from" : "origin"] = r.origin;
  json[r.set == "segments" ? "to" : "direction"] = r.direction;
  json["t_min"] = r.t_min;
  json["t_max"] = r.t_max;  // infinity is null
  if (r.from_side != tetfmt::kNone) json["from_side"] = r.from_side;
  return json;
}

}  // namespace

std::string stress_table(const StressResult& result, const StressOptions& options) {
  std::string text = "tet bench --stress: rays against exact arithmetic\n" + provenance_text();
  text += format("seed %llu, %d threads\n", static_cast<unsigned long long>(options.seed),
                 tetprep::thread_count(options.threads));
  std::string file;
  for (const StressRow& row : result.rows) {
    if (row.file != file) {
      file = row.file;
      const auto mesh = std::find_if(result.meshes.begin(), result.meshes.end(),
                                     [&](const StressMesh& m) { return m.file == file; });
      text += format("\n%s: %zu triangles, %zu faces, %zu tets, %s\n", base_name(file).c_str(),
                     mesh->triangles, mesh->faces, mesh->tets, mesh->closed ? "closed" : "open");
      text += header_text();
    }
    text += row_text("  " + row.set, row.tally);
  }
  text += "\nall files\n" + header_text();
  std::vector<std::string> sets;
  for (const StressRow& row : result.rows)
    if (std::find(sets.begin(), sets.end(), row.set) == sets.end()) sets.push_back(row.set);
  for (const std::string& set : sets) text += row_text("  " + set, result.total(set));
  const Tally total = result.total();
  text += row_text("all sets", total);
  for (std::size_t i = 0; i < total.peers.size(); ++i)
    if (total.peers[i].rays > 0)
      text += format("%s, of %llu of these rays: %llu wrong, %llu missed\n", kPeerNames[i],
                     static_cast<unsigned long long>(total.peers[i].rays),
                     static_cast<unsigned long long>(total.peers[i].wrong),
                     static_cast<unsigned long long>(total.peers[i].missed));
  text += format("besides, %llu rays off sides of faces, only asked not to meet their own face\n",
                 static_cast<unsigned long long>(total.leaving));
  text += format("%.1f s, %.2f million rays a second\n", result.seconds,
                 static_cast<double>(total.rays) / result.seconds / 1e6);
  for (const StressRow& row : result.rows)
    for (const Reproducer& example : row.tally.examples) text += reproducer_text(example);
  text += total.failures() == 0 ? "no failures\n" : std::to_string(total.failures()) + " failures\n";
  return text;
}

std::string stress_csv(const StressResult& result) {
  std::string text = "file,set,rays,hits";
  for (const char* name : kFaultNames) text += std::string(",") + name;
  text += ",float_wrong,float_lost";
  for (const char* name : kQuantileNames) text += std::string(",ulp_") + name;
  text += ",ulp_max,shallow_hits,shallow_ulp_99_99,shallow_ulp_max,in_double,in_double2,exact,tied";
  for (const char* name : kPeerNames)
    text += std::string(",") + name + "_rays," + name + "_wrong," + name + "_missed";
  text += ",leaving_rays,thread_seconds\n";
  for (const StressRow& row : result.rows) {
    const Tally& t = row.tally;
    text += quoted(row.file) + "," + row.set;
    const auto add = [&](auto value) { text += "," + number(static_cast<double>(value)); };
    add(t.rays);
    add(t.hits);
    for (const std::uint64_t faults : t.faults) add(faults);
    add(t.float_wrong);
    add(t.float_lost);
    for (const double share : kQuantiles) add(t.steep.quantile(share));
    add(t.steep.max());
    add(t.shallow.count());
    add(t.shallow.quantile(kQuantiles[2]));
    add(t.shallow.max());
    for (const std::uint64_t signs : {t.signs.in_double, t.signs.in_double2, t.signs.exact, t.signs.tied})
      add(signs);
    for (const PeerTally& peer : t.peers) {
      add(peer.rays);
      add(peer.wrong);
      add(peer.missed);
    }
    add(t.leaving);
    add(t.seconds);
    text += "\n";
  }
  return text;
}

std::string stress_json(const StressResult& result, const StressOptions& options) {
  Json json = {{"benchmark", "stress"}};
  for (const auto& [name, value] : provenance()) json[name] = value;
  json["seed"] = options.seed;
  json["threads"] = tetprep::thread_count(options.threads);
  json["seconds"] = result.seconds;
  json["meshes"] = Json::array();
  for (const StressMesh& mesh : result.meshes)
    json["meshes"].push_back({{"file", mesh.file},
                              {"triangles", mesh.triangles},
                              {"faces", mesh.faces},
                              {"tets", mesh.tets},
                              {"closed", mesh.closed}});
  json["rows"] = Json::array();
  Json failures = Json::array();
  for (const StressRow& row : result.rows) {
    Json row_json = {{"file", row.file}, {"set", row.set}};
    row_json.update(tally_json(row.tally));
    json["rows"].push_back(row_json);
    for (const Reproducer& example : row.tally.examples) failures.push_back(reproducer_json(example));
  }
  json["total"] = tally_json(result.total());
  json["failures"] = result.total().failures();
  json["reproducers"] = failures;
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace tetbench
