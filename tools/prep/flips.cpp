// SPDX-License-Identifier: AGPL-3.0-or-later
#include "prep/flips.hpp"

#include <algorithm>
#include <limits>
#include <utility>

namespace tetprep {
namespace {

/// A flip must gain at least this share of the area it touches; rounding then cannot make two flips undo each
/// other for ever.
constexpr double kLeastGain = 1e-6;

}  // namespace

bool FlipFinder::remove_edge(Index a, Index b, Flip& flip) {
  const std::size_t n = ring_size_;
  double before = 0;
  for (std::size_t i = 0; i < n; ++i) before += area(a, b, ring_[i]);
  if (before < threshold_ || !fill_ring(a, b, before * (1 - kLeastGain))) return false;
  flip.gain = before - cost_[0][n - 1];
  flip.old_tets.assign(ring_tets_.begin(), ring_tets_.begin() + static_cast<std::ptrdiff_t>(n));
  flip.new_tets.clear();
  collect(a, b, 0, n - 1, flip);
  return true;
}

/// The cheapest way to cut the ring into triangles, each the base of one tetrahedron with a and one with b
/// (Klincsek 1980, with areas of faces for lengths of diagonals). False if none is valid and below `limit`.
bool FlipFinder::fill_ring(Index a, Index b, double limit) {
  const std::size_t n = ring_size_;
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t j = i + 2; j < n; ++j)
      diagonal_[i][j] = i == 0 && j == n - 1 ? 0 : area(a, ring_[i], ring_[j]) + area(b, ring_[i], ring_[j]);
  for (std::size_t i = 0; i + 1 < n; ++i) cost_[i][i + 1] = diagonal_[i][i + 1] = 0;
  for (std::size_t length = 2; length < n; ++length) {
    for (std::size_t i = 0; i + length < n; ++i) {
      const std::size_t j = i + length;
      cost_[i][j] = kInfinity;
      for (std::size_t k = i + 1; k < j; ++k) {
        double cost = cost_[i][k] + cost_[k][j] + diagonal_[i][k] + diagonal_[k][j];
        if (cost >= std::min(limit, cost_[i][j])) continue;
        cost += area(ring_[i], ring_[k], ring_[j]);
        if (cost >= std::min(limit, cost_[i][j])) continue;
        if (!positive(ring_[i], ring_[k], ring_[j], b) || !positive(ring_[k], ring_[i], ring_[j], a))
          continue;
        cost_[i][j] = cost;
        split_[i][j] = k;
      }
    }
  }
  return cost_[0][n - 1] < limit;
}

void FlipFinder::collect(Index a, Index b, std::size_t i, std::size_t j, Flip& flip) const {
  if (j == i + 1) return;
  const std::size_t k = split_[i][j];
  flip.new_tets.push_back({ring_[i], ring_[k], ring_[j], b});
  flip.new_tets.push_back({ring_[k], ring_[i], ring_[j], a});
  collect(a, b, i, k, flip);
  collect(a, b, k, j, flip);
}

/// The face opposite vertex k of `t`, between apexes a and b, gives way to the edge (a, b): two tets become
/// three.
bool FlipFinder::replace_face(Index t, std::size_t k, Flip& flip) const {
  const Index other = mesh_.neighbors[t][k];
  if (other == kNone || mesh_.face_triangle[t][k] != kNone) return false;
  std::array<Index, 3> f{};
  for (std::size_t i = 0, n = 0; i < 4; ++i)
    if (i != k) f[n++] = mesh_.tets[t][i];
  const double before = area(f[0], f[1], f[2]);
  if (before < threshold_) return false;
  const Index a = mesh_.tets[t][k], b = fourth(other, f[0], f[1], f[2]);
  if (k % 2 == 0) std::swap(f[1], f[2]);  // now (f, a) is positive: a has moved past 3 - k vertices
  double after = 0;
  for (std::size_t i = 0; i < 3; ++i) after += area(a, b, f[i]);
  if (after >= before * (1 - kLeastGain)) return false;
  flip.new_tets.clear();
  for (std::size_t i = 0; i < 3; ++i) {
    const Index p = f[i], q = f[(i + 1) % 3];
    if (!positive(p, q, b, a)) return false;
    flip.new_tets.push_back({p, q, b, a});
  }
  flip.gain = before - after;
  flip.old_tets = {t, other};
  return true;
}

}  // namespace tetprep
