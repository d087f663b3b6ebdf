// SPDX-License-Identifier: AGPL-3.0-or-later
#include "prep/reduce_crossings.hpp"

#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cstdint>
#include <utility>

#include "prep/box.hpp"
#include "prep/cone_finder.hpp"
#include "prep/replace_tets.hpp"

namespace tetprep {
namespace {

/// A gap for every so many tets: now and then more tets come than go.
constexpr std::size_t kGapSpacing = 16;
/// Tets of a block, at least and at most; else an eighth of all. They decide about the result, so threads may
/// not.
constexpr std::size_t kSmallestBlock = 4096, kLargestBlock = 65536;
/// Tets that one task measures.
constexpr std::size_t kPart = 4096;

constexpr std::uint8_t kAllCorners = 0b1111;

struct BlockResult {
  double gain = 0;
  Index replacements = 0;
};

/// What one thread needs to improve blocks, one after the other.
class Worker {
 public:
  Worker(TetMesh& mesh, std::vector<std::uint8_t>& pending)
      : mesh_(mesh), pending_(pending), finder_(mesh), replacer_(mesh) {}

  /// Looks at every corner that is pending, and at those of tets that come, until nothing is found.
  BlockResult improve(const Block& block) {
    BlockResult result;
    finder_.enter(block);
    replacer_.enter(block);
    next_.clear();
    for (Index t = block.first; t < block.end; ++t) look(t, result);
    while (!next_.empty()) {
      current_.swap(next_);
      next_.clear();
      for (const Index t : current_) look(t, result);
    }
    return result;
  }

 private:
  void look(Index t, BlockResult& result) {
    for (std::size_t k = 0; k < 4; ++k) {
      if ((pending_[t] >> k & 1) == 0 || !finder_.go_to(t, k)) continue;
      for (const Index other : finder_.around()) {
        std::size_t j = 0;
        while (mesh_.tets[other][j] != finder_.vertex()) ++j;
        pending_[other] &= static_cast<std::uint8_t>(~(1u << j));
      }
      if (!finder_.find(cone_) || !replacer_.apply(cone_)) continue;
      result.gain += cone_.gain;
      ++result.replacements;
      for (const Index gone : cone_.tets) pending_[gone] = 0;
      for (const Index made : replacer_.made()) {
        pending_[made] = kAllCorners;
        next_.push_back(made);
      }
    }
  }

  TetMesh& mesh_;
  std::vector<std::uint8_t>& pending_;
  ConeFinder finder_;
  TetReplacer replacer_;
  Cone cone_;
  std::vector<Index> current_, next_;
};

class Reducer {
 public:
  Reducer(TetMesh& mesh, Progress& progress) : mesh_(mesh), progress_(progress) {}

  CrossingReport run(Optimize /*effort*/) {
    CrossingReport report;
    const double free_area = measure();
    const std::vector<bool> used = used_points();
    make_gaps(mesh_, kGapSpacing);
    const std::size_t count = mesh_.tets.size();
    pending_.assign(count, kAllCorners);
    for (std::size_t t = 0; t < count; ++t)
      if (is_gap(mesh_, static_cast<Index>(t))) pending_[t] = 0;
    // Each thread has a block of its own, to read and to write. What lies where blocks meet is looked at with
    // blocks that meet elsewhere, and what is then left by one thread.
    const std::size_t size = std::clamp(count / 8, kSmallestBlock, kLargestBlock);
    double gained = 0;
    for (const std::size_t shift : {std::size_t{0}, size / 2, count}) {
      const BlockResult result = improve(shift, size);
      gained += result.gain;
      report.replacements += result.replacements;
    }
    close_gaps(mesh_);
    drop_points(used);
    const double box = box_area();
    report.area_before = free_area / box;
    report.area_after = (free_area - gained) / box;
    return report;
  }

 private:
  std::vector<bool> used_points() const {
    std::vector<bool> used(mesh_.points.size(), false);
    for (const auto& tet : mesh_.tets)
      for (const Index v : tet) used[v] = true;
    return used;
  }

  /// Takes away the points that belonged to some tet and no longer do.
  void drop_points(const std::vector<bool>& used_before) {
    const std::vector<bool> used = used_points();
    std::vector<Index> new_number(used.size());
    Index count = 0;
    for (std::size_t i = 0; i < used.size(); ++i) {
      new_number[i] = count;
      if (used[i] || !used_before[i]) mesh_.points[count++] = mesh_.points[i];
    }
    if (count == used.size()) return;
    mesh_.points.resize(count);
    for (auto& tet : mesh_.tets)
      for (Index& v : tet) v = new_number[v];
  }

  BlockResult improve(std::size_t shift, std::size_t size) {
    const std::size_t count = mesh_.tets.size();
    std::vector<Block> blocks;
    for (std::size_t first = 0, end = shift == 0 ? size : shift; first < count; first = end, end += size)
      blocks.push_back({static_cast<Index>(first), static_cast<Index>(std::min(end, count))});
    std::vector<BlockResult> results(blocks.size());
    tbb::enumerable_thread_specific<Worker> workers([&] { return Worker(mesh_, pending_); });
    tbb::parallel_for(
        std::size_t{0}, blocks.size(),
        [&](std::size_t i) { results[i] = workers.local().improve(blocks[i]); }, tbb::simple_partitioner());
    BlockResult sum;
    for (const BlockResult& result : results) {
      sum.gain += result.gain;
      sum.replacements += result.replacements;
    }
    return sum;
  }

  double face_area(std::size_t t, std::size_t k) const {
    const auto& v = mesh_.tets[t];
    const auto& face = kFaceCorners[k];
    return triangle_area(mesh_.points[v[face[0]]], mesh_.points[v[face[1]]], mesh_.points[v[face[2]]]);
  }

  /// Makes every tet positive, and returns the area of all faces between two tets that no triangle
  /// constrains.
  double measure() {
    const std::size_t count = mesh_.tets.size();
    std::vector<double> sums((count + kPart - 1) / kPart, 0.0);  // added in one order, whatever the threads
    tbb::parallel_for(std::size_t{0}, sums.size(), [&](std::size_t block) {
      for (std::size_t t = block * kPart; t < std::min(count, (block + 1) * kPart); ++t) {
        make_positive(t);
        for (std::size_t k = 0; k < 4; ++k) {
          const bool free = mesh_.face_triangle[t][k] == kNone && mesh_.neighbors[t][k] != kNone;
          if (free) sums[block] += face_area(t, k) / 2;  // the tet beyond has the other half
        }
      }
    });
    double sum = 0;
    for (const double part : sums) sum += part;
    return sum;
  }

  void make_positive(std::size_t t) {
    auto& v = mesh_.tets[t];
    const auto& p = mesh_.points;
    if (tetfmt::orientation(p[v[0]], p[v[1]], p[v[2]], p[v[3]]) > 0) return;
    std::swap(v[0], v[1]);
    std::swap(mesh_.neighbors[t][0], mesh_.neighbors[t][1]);
    std::swap(mesh_.face_triangle[t][0], mesh_.face_triangle[t][1]);
  }

  double box_area() const {
    const Box box = bounds_of(mesh_.points);
    std::array<double, 3> edge{};
    for (std::size_t k = 0; k < 3; ++k) edge[k] = box.high[k] - box.low[k];
    return 2 * (edge[0] * edge[1] + edge[1] * edge[2] + edge[2] * edge[0]);
  }

  TetMesh& mesh_;
  Progress& progress_;
  std::vector<std::uint8_t> pending_;  ///< of each tet the corners to look at, a bit each
};

}  // namespace

CrossingReport reduce_crossings(TetMesh& mesh, Optimize effort, Progress& progress) {
  if (effort == Optimize::none) return {};
  return Reducer(mesh, progress).run(effort);
}

}  // namespace tetprep
