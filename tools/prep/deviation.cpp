// SPDX-License-Identifier: AGPL-3.0-or-later
#include "prep/deviation.hpp"

#include <tbb/parallel_for.h>

#include "prep/surface_tree.hpp"

namespace tetprep {

std::vector<double> deviations(const Triangles& of, const Triangles& from, double spacing) {
  std::vector<Kernel::Triangle_3> triangles;
  triangles.reserve(from.size());
  for (const auto& [a, b, c] : from) triangles.emplace_back(cgal_point(a), cgal_point(b), cgal_point(c));
  const SurfaceTree tree(std::move(triangles));

  // Samples that follow each other are neighbours, so the triangle nearest to the last one is a good first
  // guess. Blocks of fixed size, for the guess decides how a distance is rounded.
  constexpr std::size_t kBlock = 1024;
  std::vector<double> farthest(of.size(), 0.0);
  tbb::parallel_for(std::size_t{0}, (of.size() + kBlock - 1) / kBlock, [&](std::size_t block) {
    auto nearest = tree.any();
    for (std::size_t t = block * kBlock; t < std::min(of.size(), (block + 1) * kBlock); ++t) {
      for_each_sample(of[t], spacing, [&](const Point& sample, double, double) {
        farthest[t] = std::max(farthest[t], tree.squared_distance(cgal_point(sample), nearest));
      });
      farthest[t] = std::sqrt(farthest[t]);
    }
  });
  return farthest;
}

}  // namespace tetprep
