// SPDX-License-Identifier: AGPL-3.0-or-later
#include "prep/intersections.hpp"

#include <CGAL/Box_intersection_d/Box_d.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/box_intersection_d.h>
#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>

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

struct Stop {};

}  // namespace

bool triangles_intersect(const std::vector<GridPoint>& points, const Corners& first, const Corners& second) {
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

IntersectionSearch::IntersectionSearch(const CleanSurface& surface, unsigned threads)
    : surface_(surface), thread_([this, threads] {
        try {
          search(threads);
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

void IntersectionSearch::search(unsigned threads) {
  using Box = CGAL::Box_intersection_d::Box_with_info_d<double, 3, Index>;
  std::vector<Box> boxes;
  boxes.reserve(surface_.triangles.size());
  for (Index t = 0; t < surface_.triangles.size(); ++t) {
    CGAL::Bbox_3 bounds;
    for (const Index corner : surface_.triangles[t]) {
      const GridPoint& p = surface_.points[corner];
      bounds += CGAL::Bbox_3(p[0], p[1], p[2], p[0], p[1], p[2]);
    }
    boxes.emplace_back(bounds, t);
  }
  tbb::enumerable_thread_specific<std::vector<TrianglePair>> found;
  const auto check = [&](const Box& a, const Box& b) {
    if (cancelled_.load(std::memory_order_relaxed)) throw Stop{};
    if (!triangles_intersect(surface_.points, surface_.triangles[a.info()], surface_.triangles[b.info()]))
      return;
    found.local().emplace_back(std::min(a.info(), b.info()), std::max(a.info(), b.info()));
    if (found_count_.fetch_add(1, std::memory_order_relaxed) + 1 >= kMostPairs) throw Stop{};
  };
  try {
    if (threads > 1) {
      tbb::task_arena(static_cast<int>(threads)).execute([&] {
        CGAL::box_self_intersection_d<CGAL::Parallel_tag>(boxes.begin(), boxes.end(), check);
      });
    } else {
      CGAL::box_self_intersection_d<CGAL::Sequential_tag>(boxes.begin(), boxes.end(), check);
    }
  } catch (const Stop&) {
  }
  for (const auto& part : found) pairs_.insert(pairs_.end(), part.begin(), part.end());
  std::sort(pairs_.begin(), pairs_.end());
}

}  // namespace tetprep
