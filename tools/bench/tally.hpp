// SPDX-License-Identifier: AGPL-3.0-or-later
// What a stress test counts. Sums of tallies do not depend on the order, so that results are the same for any
// number of threads.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "bench/truth/surface.hpp"
#include "tetfmt/kernels.hpp"

namespace tetbench {

enum class Fault : std::uint8_t {
  wrong,      ///< another face, side or tetrahedron than the truth's, or t, u, v out of bounds
  missed,     ///< a crossing was not reported
  false_hit,  ///< a crossing was reported that is none
  doubled,    ///< all_hits: a crossing twice, in the wrong order, or an odd number through a closed surface
  hung,       ///< a walk was cut short, or took more steps than there are tetrahedra
  started,    ///< a place was given to a tetrahedron that does not contain it
  self_hit,   ///< a ray from a side of a face met that face, though it leaves it
  differs,    ///< layouts, views, bases, exact arithmetics, or one ray at a time and many disagreed
};
inline constexpr std::array<const char*, 8> kFaultNames = {"wrong", "missed",  "false", "double",
                                                           "hung",  "started", "self",  "differ"};

/// Errors in units of the last place: 1/16 apart up to 64, then by powers of two.
class UlpHistogram {
 public:
  void add(double ulps);
  void add(const UlpHistogram& more);
  std::uint64_t count() const { return count_; }
  /// An upper bound of the value below which `share` of all lie, within the width of a bin; 0 if there are
  /// none.
  double quantile(double share) const;
  double max() const { return max_; }

 private:
  static constexpr std::size_t kFine = 1024;
  std::array<std::uint64_t, kFine + 64> bins_{};
  std::uint64_t count_ = 0;
  double max_ = 0;
};

/// A failure, such that it can be repeated.
struct Reproducer {
  Fault fault{};
  std::string file, set;
  Vec3d origin{}, direction{};  ///< of a segment: from and to
  double t_min = 0, t_max = 0;
  tetfmt::Index from_side = tetfmt::kNone;  ///< the origin is on this side of a face
  std::string text;
};

/// Of one peer: rays that it got wrong, of those that it was asked.
struct PeerTally {
  std::uint64_t rays = 0, wrong = 0, missed = 0;
};

struct Tally {
  static constexpr std::size_t kExamples = 10;
  std::uint64_t rays = 0, hits = 0, crossings = 0;
  std::uint64_t leaving =
      0;  ///< rays off sides of faces, besides `rays`, only asked not to meet their own face
  std::array<std::uint64_t, kFaultNames.size()> faults{};
  std::uint64_t float_wrong = 0, float_lost = 0;  ///< Kernel::float_only, of `rays` without segments
  UlpHistogram steep, shallow;                    ///< errors of t, of hits at more than 1 degree and at less
  tetfmt::SignCounts signs;                       ///< of a share of the rays
  std::array<PeerTally, 2> peers;
  std::vector<Reproducer> examples;  ///< at most kExamples
  double seconds = 0;                ///< of all threads

  void add(const Tally& more);
  std::uint64_t failures() const;
};

}  // namespace tetbench
