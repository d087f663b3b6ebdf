// SPDX-License-Identifier: AGPL-3.0-or-later
#include "prep/cut_plan.hpp"

#include <algorithm>
#include <numeric>

#include "prep/contact.hpp"

namespace tetprep {
namespace {

using Corners = std::array<Index, 3>;
using Edge = std::array<Index, 2>;

/// Groups that grow together.
class UnionFind {
 public:
  explicit UnionFind(std::size_t count) : parent_(count) {
    std::iota(parent_.begin(), parent_.end(), Index{0});
  }
  /// The least member of the group.
  Index find(Index i) {
    while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
    return i;
  }
  void join(Index i, Index j) {
    i = find(i);
    j = find(j);
    parent_[std::max(i, j)] = std::min(i, j);
  }

 private:
  std::vector<Index> parent_;
};

/// Every triangle that has one of the edges, with that edge; by triangle.
std::vector<std::pair<Index, Edge>> with_edges(const std::vector<Corners>& triangles,
                                               const NearContacts& near) {
  Index most = 0;
  for (const auto& [edge, list] : near.of_edges) most = std::max(most, edge[1]);
  std::vector<bool> ends(std::size_t{most} + 1, false);
  for (const auto& [edge, list] : near.of_edges) ends[edge[0]] = ends[edge[1]] = true;
  const auto is_end = [&](Index point) { return point <= most && ends[point]; };
  std::vector<std::pair<Index, Edge>> found;
  for (Index t = 0; t < triangles.size(); ++t) {
    for (std::size_t i = 0; i < 3; ++i) {
      const Index p = triangles[t][i], q = triangles[t][(i + 1) % 3];
      if (!is_end(p) || !is_end(q)) continue;
      const Edge edge{std::min(p, q), std::max(p, q)};
      if (near.of_edges.contains(edge)) found.emplace_back(t, edge);
    }
  }
  return found;
}

}  // namespace

CutPlan plan_cuts(const std::vector<GridPoint>& points, const std::vector<Corners>& triangles,
                  const std::vector<TrianglePair>& pairs) {
  UnionFind planes(triangles.size());
  std::vector<bool> coplanar(pairs.size()), involved(triangles.size(), false);
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    const auto [a, b] = pairs[i];
    involved[a] = involved[b] = true;
    coplanar[i] = in_one_plane(points, triangles[a], triangles[b]);
    if (coplanar[i]) planes.join(a, b);
  }
  CutPlan plan;
  for (Index t = 0; t < triangles.size(); ++t)
    if (involved[t]) plan.members.push_back(t);
  std::stable_sort(plan.members.begin(), plan.members.end(),
                   [&](Index a, Index b) { return planes.find(a) < planes.find(b); });
  std::vector<std::size_t> task_of(triangles.size());
  const std::span<const Index> members(plan.members);
  for (std::size_t begin = 0, end = 0; begin < members.size(); begin = end) {
    const Index plane = planes.find(members[begin]);
    for (end = begin; end < members.size() && planes.find(members[end]) == plane; ++end)
      task_of[members[end]] = plan.tasks.size();
    plan.tasks.push_back({members.subspan(begin, end - begin), {}, {}, {}});
  }
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    if (coplanar[i]) continue;
    const auto [a, b] = pairs[i];
    plan.tasks[task_of[a]].contacts.push_back({a, b});
    plan.tasks[task_of[b]].contacts.push_back({b, a});
  }
  return plan;
}

CutPlan plan_bends(const std::vector<Corners>& triangles, const NearContacts& near) {
  const auto of_edges = with_edges(triangles, near);
  CutPlan plan;
  for (const auto& [triangle, edge] : of_edges) plan.members.push_back(triangle);
  for (const auto& [triangle, list] : near.of_triangles) plan.members.push_back(triangle);
  std::sort(plan.members.begin(), plan.members.end());
  plan.members.erase(std::unique(plan.members.begin(), plan.members.end()), plan.members.end());
  std::vector<std::size_t> task_of(triangles.size());
  const std::span<const Index> members(plan.members);
  for (std::size_t i = 0; i < members.size(); ++i) {
    task_of[members[i]] = i;
    plan.tasks.push_back({members.subspan(i, 1), {}, {}, {}});
  }
  for (const auto& [triangle, edge] : of_edges)
    for (const Index through : near.of_edges.at(edge))
      plan.tasks[task_of[triangle]].edge_bends.push_back({edge[0], edge[1], through});
  for (const auto& [triangle, list] : near.of_triangles)
    for (const Index through : list) plan.tasks[task_of[triangle]].inner_bends.push_back({triangle, through});
  return plan;
}

}  // namespace tetprep
