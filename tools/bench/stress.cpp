// SPDX-License-Identifier: AGPL-3.0-or-later
#include "bench/stress.hpp"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <atomic>
#include <chrono>

#include "bench/statistics.hpp"
#include "bench/tester.hpp"
#include "common/failure.hpp"
#include "common/threads.hpp"

namespace tetbench {
namespace {

/// Rays are drawn and tested in blocks of this many, each with dice of its own: blocks, not threads, decide
/// what is tested.
constexpr std::uint64_t kBlock = 4096;

}  // namespace

std::vector<RaySet> chosen_sets(const std::vector<std::string>& names) {
  std::vector<RaySet> sets;
  std::string known;
  for (const RaySet& set : ray_sets()) {
    known += std::string(known.empty() ? "" : ", ") + set.name;
    if (names.empty() || std::find(names.begin(), names.end(), set.name) != names.end()) sets.push_back(set);
  }
  for (const std::string& name : names)
    if (std::none_of(sets.begin(), sets.end(), [&](const RaySet& set) { return set.name == name; }))
      throw tetprep::Failure(tetprep::ExitCode::usage, "--sets: no set '" + name + "'; there are " + known);
  return sets;
}

Tally StressResult::total(const std::string& set) const {
  Tally total;
  for (const StressRow& row : rows)
    if (set.empty() || row.set == set) total.add(row.tally);
  return total;
}

StressResult stress(const std::vector<std::string>& files, const StressOptions& options,
                    tetprep::Progress& progress) {
  const auto started = std::chrono::steady_clock::now();
  const std::vector<RaySet> sets = chosen_sets(options.sets);
  std::uint64_t weights = 0;
  for (const RaySet& set : sets) weights += static_cast<std::uint64_t>(set.weight);
  StressResult result;
  for (const std::string& file : files) {
    progress.stage("check " + file);
    Scene::check(file);
  }
  for (const std::string& file : files) {
    progress.stage("open " + file);
    const Bench bench(file);
    const Surface& surface = bench.scene.surface();
    result.meshes.push_back({file, bench.scene.view(0).view().input_triangles().size(), surface.faces.size(),
                             bench.scene.mesh().tets.size(), surface.closed});
    progress.stage("stress " + file);
    std::atomic<std::uint64_t> done = 0;
    const std::uint64_t of_file = std::max<std::uint64_t>(1, options.rays / files.size());
    for (std::size_t s = 0; s < sets.size(); ++s) {
      const std::uint64_t count =
          std::max<std::uint64_t>(1, of_file * static_cast<std::uint64_t>(sets[s].weight) / weights);
      const std::size_t blocks = (count + kBlock - 1) / kBlock;
      std::vector<Tally> tallies(blocks);
      // Of the set's name, so that a set has the same rays whatever others are run.
      std::uint64_t set_seed = 0;
      for (const char* c = sets[s].name; *c != 0; ++c)
        set_seed = set_seed * 131 + static_cast<unsigned char>(*c);
      tetprep::with_threads(options.threads, [&] {
        tbb::parallel_for(std::size_t{0}, blocks, [&](std::size_t b) {
          const double begun = thread_seconds();
          Tester tester(bench, sets[s], {options.seed, set_seed, b});
          tester.run(std::min(kBlock, count - b * kBlock));
          tallies[b] = tester.take();
          tallies[b].seconds = thread_seconds() - begun;
          progress.fraction(static_cast<double>(done += tallies[b].rays) / static_cast<double>(of_file));
        });
      });
      StressRow row{file, sets[s].name, {}};
      for (const Tally& tally : tallies) row.tally.add(tally);
      result.rows.push_back(std::move(row));
    }
  }
  result.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - started).count();
  return result;
}

}  // namespace tetbench
