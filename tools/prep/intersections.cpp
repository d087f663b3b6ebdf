// SPDX-License-Identifier: AGPL-3.0-or-later
#include "prep/intersections.hpp"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <bit>

#include "prep/box_tree.hpp"

namespace tetprep {
namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;

Kernel::Point_3 exact_point(const GridPoint& p) {
  return {p[0], p[1], p[2]};
}

/// Whether the segment (p, q) and the triangle (a, b, c) have a point in common.
bool segment_meets(const GridPoint& p, const GridPoint& q, const GridPoint& a, const GridPoint& b,
                   const GridPoint& c) {
  // Nearly always both ends lie strictly on one side of the plane; CGAL decides the rest.
  if (tetfmt::orientation(a, b, c, p) * tetfmt::orientation(a, b, c, q) > 0) return false;
  return CGAL::do_intersect(Kernel::Segment_3(exact_point(p), exact_point(q)),
                            Kernel::Triangle_3(exact_point(a), exact_point(b), exact_point(c)));
}

/// Triangles (u, v, p) and (u, v, q): beyond the edge they meet only if they lie in one plane, folded onto
/// each other.
bool fold_overlaps(const GridPoint& u, const GridPoint& v, const GridPoint& p, const GridPoint& q) {
  if (tetfmt::orientation(u, v, p, q) != 0) return false;
  for (std::size_t axis = 0; axis < 3; ++axis) {  // any projection that keeps the triangles' area will do
    const std::int64_t of_p = tetfmt::doubled_area(u, v, p, axis), of_q = tetfmt::doubled_area(u, v, q, axis);
    if (of_p != 0) return (of_p > 0) == (of_q > 0);
  }
  return false;
}

using Corners = std::array<Index, 3>;

/// Rotates so that the corners that are shared come first, in ascending order of `shared`'s first entries.
/// Returns how many are shared, and leaves the others behind them.
int shared_first(Corners& a, Corners& b) {
  std::size_t shared = 0;
  for (std::size_t i = 0; i < 3; ++i) {
    const auto found = std::find(b.begin() + static_cast<std::ptrdiff_t>(shared), b.end(), a[i]);
    if (found == b.end()) continue;
    std::swap(b[shared], *found);
    std::swap(a[shared], a[i]);
    ++shared;
  }
  return static_cast<int>(shared);
}

bool contains(const Corners& triangle, Index corner) {
  return triangle[0] == corner || triangle[1] == corner || triangle[2] == corner;
}

/// Whether all corners of `b` that are not in `a` are strictly on one side of the plane of `a`: then the
/// triangles have nothing but their common corners in common.
bool apart(const std::vector<GridPoint>& points, const Corners& a, const Corners& b) {
  int common = 0;
  for (const Index corner : b) {
    if (contains(a, corner)) continue;
    const int side = tetfmt::orientation(points[a[0]], points[a[1]], points[a[2]], points[corner]);
    if (side == 0 || side == -common) return false;
    common = side;
  }
  return true;
}

/// One search. Its tasks are stretches of leaves, in a fixed order: what counts when there are too many pairs
/// is their order, not who comes first.
class Search {
 public:
  Search(const std::vector<GridPoint>& points, const std::vector<Corners>& triangles, std::size_t most_pairs,
         const std::atomic<bool>& cancelled, std::atomic<std::size_t>& found_count)
      : points_(points),
        triangles_(triangles),
        most_pairs_(most_pairs),
        cancelled_(cancelled),
        found_count_(found_count) {}

  std::vector<TrianglePair> run(const std::vector<bool>& active) {
    const auto box = [&](Index t) { return box_around(points_, triangles_[t]); };
    std::vector<Index> in_tree, others;
    for (Index t = 0; t < triangles_.size(); ++t)
      (active.empty() || active[t] ? in_tree : others).push_back(t);
    if (in_tree.empty()) return {};
    const BoxTree tree(std::move(in_tree), box);
    std::vector<TrianglePair> pairs;
    collect(tree, tree, pairs);
    std::erase_if(others, [&](Index t) { return !tree.may_overlap(box(t)); });
    if (!others.empty()) collect(BoxTree(std::move(others), box), tree, pairs);
    std::sort(pairs.begin(), pairs.end());
    return pairs;
  }

 private:
  static constexpr std::size_t kLeavesPerTask = 32;

  struct Task {
    std::vector<TrianglePair> pairs;
    std::atomic<std::size_t> count{0};
  };

  void collect(const BoxTree& queries, const BoxTree& tree, std::vector<TrianglePair>& pairs) {
    const std::size_t most = most_pairs_ - std::min(most_pairs_, pairs.size());
    std::vector<Task> tasks((queries.leaves() + kLeavesPerTask - 1) / kLeavesPerTask);
    tbb::parallel_for(std::size_t{0}, tasks.size(), [&](std::size_t task) {
      if (enough_before(tasks, task, most)) return;
      const std::size_t end = std::min(queries.leaves(), (task + 1) * kLeavesPerTask);
      for (std::size_t leaf = task * kLeavesPerTask; leaf < end; ++leaf)
        search_leaf(queries, leaf, tree, most, tasks[task]);
    });
    for (const Task& task : tasks) pairs.insert(pairs.end(), task.pairs.begin(), task.pairs.end());
    if (pairs.size() > most_pairs_) pairs.resize(most_pairs_);
  }

  /// Whether nothing that this task finds will be among the first `most` pairs.
  bool enough_before(const std::vector<Task>& tasks, std::size_t task, std::size_t most) const {
    if (found_count_.load(std::memory_order_relaxed) < most) return false;
    std::size_t before = 0;
    for (std::size_t i = 0; i < task && before < most; ++i)
      before += tasks[i].count.load(std::memory_order_relaxed);
    return before >= most;
  }

  void search_leaf(const BoxTree& queries, std::size_t leaf, const BoxTree& tree, std::size_t most,
                   Task& task) {
    const EightBoxes& boxes = queries.leaf(leaf);
    const bool same = &queries == &tree;  // then each pair is met from its earlier leaf
    tree.visit_leaves(boxes.bounds(), same ? leaf : 0, [&](std::size_t other) {
      if (cancelled_.load(std::memory_order_relaxed)) return;
      const unsigned near = boxes.overlapping(tree.leaf(other).bounds());
      for (unsigned rest = near; rest != 0; rest &= rest - 1) {
        const auto i = static_cast<unsigned>(std::countr_zero(rest));
        unsigned mask = tree.leaf(other).overlapping(boxes.get(i));
        if (same && other == leaf) mask &= 0xFEu << i;
        for (; mask != 0; mask &= mask - 1)
          check(queries.item(leaf, i), tree.item(other, static_cast<std::size_t>(std::countr_zero(mask))),
                most, task);
      }
    });
  }

  void check(Index a, Index b, std::size_t most, Task& task) {
    if (task.pairs.size() >= most) return;
    if (!triangles_intersect(points_, triangles_[a], triangles_[b])) return;
    task.pairs.emplace_back(std::min(a, b), std::max(a, b));
    task.count.store(task.pairs.size(), std::memory_order_relaxed);
    found_count_.fetch_add(1, std::memory_order_relaxed);
  }

  const std::vector<GridPoint>& points_;
  const std::vector<Corners>& triangles_;
  const std::size_t most_pairs_;
  const std::atomic<bool>& cancelled_;
  std::atomic<std::size_t>& found_count_;
};

}  // namespace

bool triangles_intersect(const std::vector<GridPoint>& points, const Corners& first, const Corners& second) {
  if (apart(points, first, second) || apart(points, second, first)) return false;
  Corners a = first, b = second;
  const int shared = shared_first(a, b);
  const auto at = [&](Index i) -> const GridPoint& { return points[i]; };
  if (shared == 2) return fold_overlaps(at(a[0]), at(a[1]), at(a[2]), at(b[2]));
  if (shared == 1) {
    // Both are convex and contain the corner, so what they have in common beyond it reaches from there to the
    // opposite edge of one of them.
    return segment_meets(at(a[1]), at(a[2]), at(b[0]), at(b[1]), at(b[2])) ||
           segment_meets(at(b[1]), at(b[2]), at(a[0]), at(a[1]), at(a[2]));
  }
  return CGAL::do_intersect(
      Kernel::Triangle_3(exact_point(at(a[0])), exact_point(at(a[1])), exact_point(at(a[2]))),
      Kernel::Triangle_3(exact_point(at(b[0])), exact_point(at(b[1])), exact_point(at(b[2]))));
}

std::vector<TrianglePair> find_intersections(const std::vector<GridPoint>& points,
                                             const std::vector<Corners>& triangles,
                                             const std::vector<bool>& active, std::size_t most_pairs,
                                             const std::atomic<bool>& cancelled,
                                             std::atomic<std::size_t>& found_count) {
  return Search(points, triangles, most_pairs, cancelled, found_count).run(active);
}

IntersectionSearch::IntersectionSearch(const CleanSurface& surface, unsigned threads)
    : thread_([this, &surface, threads] {
        try {
          tbb::task_arena(static_cast<int>(threads)).execute([&] {
            pairs_ = find_intersections(surface.points, surface.triangles, {}, kMostPairs, cancelled_,
                                        found_count_);
          });
        } catch (...) {
          error_ = std::current_exception();
        }
      }) {}

IntersectionSearch::~IntersectionSearch() {
  cancelled_.store(true, std::memory_order_relaxed);
  if (thread_.joinable()) thread_.join();
}

const std::vector<TrianglePair>& IntersectionSearch::wait() {
  if (thread_.joinable()) thread_.join();
  if (error_) std::rethrow_exception(error_);
  return pairs_;
}

}  // namespace tetprep
