// SPDX-License-Identifier: AGPL-3.0-or-later
#include "bench/race.hpp"

#include <algorithm>
#include <chrono>

#include "bench/dice.hpp"
#include "bench/statistics.hpp"
#include "bench/verdict.hpp"
#include "common/failure.hpp"

namespace tetbench {
namespace {

using tetprep::ExitCode;
using tetprep::Failure;

/// Those named, in their own order. What is no name itself names all that begin with it and a hyphen.
template <class Kind>
std::vector<Kind> chosen(const std::vector<Kind>& kinds, const std::vector<std::string>& names,
                         const char* option) {
  if (names.empty()) return kinds;
  std::vector<bool> wanted(kinds.size());
  for (const std::string& name : names) {
    const bool is_one =
        std::any_of(kinds.begin(), kinds.end(), [&](const Kind& kind) { return kind.name == name; });
    bool found = false;
    for (std::size_t i = 0; i < kinds.size(); ++i) {
      if (is_one ? kinds[i].name != name : !kinds[i].name.starts_with(name + "-")) continue;
      wanted[i] = found = true;
    }
    if (found) continue;
    std::string known;
    for (const Kind& kind : kinds) known += (known.empty() ? "" : ", ") + kind.name;
    throw Failure(ExitCode::usage,
                  std::string(option) + ": no '" + name + "' in this build; there are " + known);
  }
  std::vector<Kind> result;
  for (std::size_t i = 0; i < kinds.size(); ++i)
    if (wanted[i]) result.push_back(kinds[i]);
  return result;
}

/// Opening and validating, each from the file's bytes on.
void file_costs(RaceMesh& mesh, int repeats) {
  for (int i = 0; i < repeats; ++i) {
    mesh.open_ms.push_back(1e3 * seconds([&] {
                             const auto file = tetfmt::MappedFile::open(mesh.file);
                             if (!file) throw Failure(ExitCode::io, tetfmt::to_string(file.error()));
                             const auto view = tetfmt::FileView::open(file->bytes());
                             if (!view) throw Failure(ExitCode::invalid, tetfmt::to_string(view.error()));
                           }));
    const auto file = tetfmt::MappedFile::open(mesh.file);
    if (!file) throw Failure(ExitCode::io, tetfmt::to_string(file.error()));
    mesh.file_bytes = file->bytes().size();
    mesh.validate_ms.push_back(1e3 * seconds([&] {
                                 if (!tetfmt::validate(file->bytes()).valid())
                                   throw Failure(ExitCode::invalid, mesh.file + ": run `tet validate`");
                               }));
  }
}

/// One tracer and the rays that it is asked.
struct Entrant {
  const Tracer* tracer;
  std::optional<RayList> sampled;  ///< if it is too slow for all
  Truth sampled_truth;
  Answers answers;
  RaceRow row;
  const RayList& rays(const RayList& all) const { return sampled ? *sampled : all; }
};

/// Whole packets, evenly over the list, so that neighbours stay neighbours.
std::vector<std::uint32_t> packets_of(std::size_t rays, std::size_t most) {
  const std::size_t packets = rays / Packet::kSize, wanted = std::max<std::size_t>(1, most / Packet::kSize);
  std::vector<std::uint32_t> numbers;
  for (std::size_t k = 0; k < wanted; ++k)
    for (std::size_t i = 0; i < Packet::kSize; ++i)
      numbers.push_back(static_cast<std::uint32_t>(k * packets / wanted * Packet::kSize + i));
  return numbers;
}

class MeshRace {
 public:
  MeshRace(const std::string& file, const RaceOptions& options, const std::vector<TracerKind>& kinds,
           tetprep::Progress& progress)
      : options_(options), progress_(progress), scene_(file), judge_(scene_), structures_(scene_) {
    const tetfmt::FileView& view = scene_.view(0).view();
    result_.file = file;
    result_.triangles = view.input_triangles().size();
    result_.faces = view.sides().size() / 2;
    result_.tets = view.tet_count();
    result_.vertices = view.vertices().size();
    file_costs(result_, options.repeats);
    for (const TracerKind& kind : kinds) {
      progress_.stage("build " + kind.name);
      tracers_.push_back({kind, kind.make(structures_)});
      const Structure& structure = tracers_.back().tracer->structure();
      if (std::none_of(result_.structures.begin(), result_.structures.end(),
                       [&](const Structure& known) { return known.name == structure.name; }))
        result_.structures.push_back(structure);
    }
  }

  void run(const WorkloadKind& kind) {
    progress_.stage(kind.name);
    const RayList rays = kind.make(scene_, options_.rays);
    if (rays.size() == 0) return;  // such as a camera that touches nothing
    run(kind.name, kind.description, rays);
    if (options_.shuffle)
      run(kind.name + "-shuffled", kind.description + ", in random order",
          shuffled(rays, options_.rays.seed));
  }

  RaceMesh take() { return std::move(result_); }

 private:
  struct Named {
    TracerKind kind;
    std::unique_ptr<Tracer> tracer;
  };

  void run(const std::string& name, const std::string& description, const RayList& rays) {
    if (std::none_of(tracers_.begin(), tracers_.end(),
                     [&](const Named& each) { return each.tracer->takes(rays); }))
      return;
    RaceWorkload workload{name,           description,   rays.size(),   0, 0, 0,
                          rays.occlusion, rays.coherent, rays.distance, {}};
    const Truth truth = find_truth(scene_, judge_, rays, options_.sample, options_.rays.seed);
    workload.hits = truth.hits;
    workload.sample = truth.sample;
    workload.sample_failed = truth.failed;

    std::vector<Entrant> entrants;
    for (const Named& each : tracers_) {
      if (!each.tracer->takes(rays)) continue;
      Entrant entrant{each.tracer.get(), {}, {}, {}, {each.kind, {}, {}, {}}};
      if (rays.size() > entrant.tracer->most_rays()) {
        const auto numbers = packets_of(rays.size(), entrant.tracer->most_rays());
        entrant.sampled = rays.picked(numbers);
        for (const std::uint32_t i : numbers) entrant.sampled_truth.answers.push_back(truth.answers[i]);
      }
      entrant.answers.resize(entrant.rays(rays).size());
      entrants.push_back(std::move(entrant));
    }

    Dice dice({options_.rays.seed, 7});
    std::vector<std::size_t> order;
    for (std::size_t i = 0; i < entrants.size(); ++i) order.push_back(i);
    // The first round warms up, and shows what is right.
    for (int repeat = -1; repeat < options_.repeats; ++repeat) {
      dice.shuffle(order);
      for (const std::size_t i : order) {
        Entrant& entrant = entrants[i];
        const RayList& asked = entrant.rays(rays);
        const double spent = seconds([&] { entrant.tracer->trace(asked, entrant.answers); });
        if (repeat >= 0) {
          entrant.row.ns.push_back(1e9 * spent / static_cast<double>(asked.size()));
          continue;
        }
        entrant.row.visits = entrant.tracer->visits(asked);
        entrant.row.verdict = judged(scene_, judge_, asked, entrant.sampled ? entrant.sampled_truth : truth,
                                     entrant.answers, entrant.row.tracer.exact);
      }
      progress_.fraction(static_cast<double>(repeat + 2) / (options_.repeats + 1));
    }
    for (Entrant& entrant : entrants) workload.rows.push_back(std::move(entrant.row));
    result_.workloads.push_back(std::move(workload));
  }

  const RaceOptions& options_;
  tetprep::Progress& progress_;
  const Scene scene_;
  const Judge judge_;
  Structures structures_;
  std::vector<Named> tracers_;
  RaceMesh result_;
};

}  // namespace

const RaceRow* RaceWorkload::find(const std::string& tracer) const {
  for (const RaceRow& row : rows)
    if (row.tracer.name == tracer) return &row;
  return nullptr;
}

std::uint64_t RaceResult::failures() const {
  std::uint64_t failures = 0;
  for (const RaceMesh& mesh : meshes)
    for (const RaceWorkload& workload : mesh.workloads) {
      failures += workload.sample_failed;
      for (const RaceRow& row : workload.rows)
        if (row.tracer.exact) failures += row.verdict.wrong + row.verdict.missed;
    }
  return failures;
}

std::vector<TracerKind> chosen_tracers(const std::vector<std::string>& names) {
  return chosen(tracer_kinds(), names, "--tracers");
}

std::vector<WorkloadKind> chosen_workloads(const std::vector<std::string>& names) {
  return chosen(workload_kinds(), names, "--workloads");
}

RaceResult race(const std::vector<std::string>& files, const RaceOptions& options,
                tetprep::Progress& progress) {
  const auto started = std::chrono::steady_clock::now();
  const std::vector<TracerKind> tracers = chosen_tracers(options.tracers);
  const std::vector<WorkloadKind> workloads = chosen_workloads(options.workloads);
  RaceResult result{options, {}, 0};
  const auto has = [&](const std::string& name) {
    return std::any_of(tracers.begin(), tracers.end(),
                       [&](const TracerKind& kind) { return kind.name == name; });
  };
  if (options.against.empty())
    result.options.against = has("embree-1") ? "embree-1" : tracers.front().name;
  else if (!has(options.against))
    throw Failure(ExitCode::usage, "--against: '" + options.against + "' is not among the tracers");
  for (const std::string& file : files) {
    progress.stage("check " + file);
    Scene::check(file);
  }
  for (const std::string& file : files) {
    progress.stage("open " + file);
    MeshRace mesh(file, options, tracers, progress);
    for (const WorkloadKind& kind : workloads) mesh.run(kind);
    result.meshes.push_back(mesh.take());
  }
  if (std::all_of(result.meshes.begin(), result.meshes.end(),
                  [](const RaceMesh& mesh) { return mesh.workloads.empty(); }))
    throw Failure(ExitCode::usage,
                  "nothing to measure: none of the tracers (--tracers) takes any of the workloads "
                  "(--workloads); `tet bench --help` describes both");
  result.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - started).count();
  return result;
}

}  // namespace tetbench
