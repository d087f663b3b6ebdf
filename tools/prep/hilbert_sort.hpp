// SPDX-License-Identifier: AGPL-3.0-or-later
// Things in space, put in order along a Hilbert curve.
#pragma once

#include <tbb/parallel_for.h>
#include <tbb/parallel_sort.h>

#include <cstdint>
#include <utility>
#include <vector>

#include "prep/hilbert.hpp"
#include "prep/prep.hpp"

namespace tetprep {

/// The numbers 0 to count - 1 by the curve's positions of `place(i)`, which is three coordinates of 0 to
/// `largest` (each). Equal positions by number, so the result is always the same. O(count log count).
template <class Place>
std::vector<Index> hilbert_sort(std::size_t count, std::int64_t largest, Place place) {
  int shift = 0;
  while (largest >> shift >= std::int64_t{1} << kHilbertBits) ++shift;
  std::vector<std::pair<std::uint64_t, Index>> keyed(count);
  tbb::parallel_for(std::size_t{0}, count, [&](std::size_t i) {
    std::array<std::uint32_t, 3> x{};
    const std::array<std::int64_t, 3> at = place(i);
    for (std::size_t k = 0; k < 3; ++k) x[k] = static_cast<std::uint32_t>(at[k] >> shift);
    keyed[i] = {hilbert_position(x), static_cast<Index>(i)};
  });
  tbb::parallel_sort(keyed.begin(), keyed.end());
  std::vector<Index> sorted(count);
  tbb::parallel_for(std::size_t{0}, count, [&](std::size_t i) { sorted[i] = keyed[i].second; });
  return sorted;
}

}  // namespace tetprep
