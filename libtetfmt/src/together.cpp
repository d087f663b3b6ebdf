// SPDX-License-Identifier: MIT
// Rays from one place, tile by tile; those that no tile can take, one by one.
#include <algorithm>
#include <array>
#include <cmath>

#include "tetfmt/traverse.hpp"
#include "tile.hpp"

namespace tetfmt {
namespace {

using namespace detail;

/// Fewer rays than this are walked one by one.
constexpr std::size_t kLeastTogether = 8;

const TileTracers& tracers(const FileView&) {
  return tile_targets().front().checked;
}
const TileTracers& tracers(const TrustedView&) {
  return tile_targets().front().unchecked;
}
const FileView& file_of(const FileView& view) {
  return view;
}
const FileView& file_of(const TrustedView& view) {
  return view.view();
}

/// Calls together(first, count) or alone(index) for every ray.
template <class Together, class Alone>
void each_tile(const Location& from, std::size_t count, const Together& together, const Alone& alone) {
  using State = Location::State;
  const bool place =
      (from.state == State::inside || from.state == State::outside) &&
      std::all_of(from.position.begin(), from.position.end(), [](double x) { return std::isfinite(x); });
  for (std::size_t begin = 0; begin < count; begin += kTileRays) {
    const std::size_t size = std::min(kTileRays, count - begin);
    if (place && size >= kLeastTogether) {
      together(begin, size);
    } else {
      for (std::size_t i = begin; i < begin + size; ++i) alone(i);
    }
  }
}

template <class View>
std::uint64_t first_hits_in(const View& view, const Location& from, std::span<const Vec3f> directions,
                            std::span<Hit> hits) {
  std::uint64_t visits = 0;
  each_tile(
      from, directions.size(),
      [&](std::size_t first, std::size_t count) {
        visits += tracers(view).first_hits(file_of(view), from, directions.subspan(first, count),
                                           hits.subspan(first, count));
      },
      [&](std::size_t i) {
        hits[i] = first_hit(view, from, directions[i]);
        visits += std::exchange(hits[i].steps, 0);
      });
  return visits;
}

template <class View>
std::uint64_t occlusions_in(const View& view, const Location& from, std::span<const Location> targets,
                            std::span<Outcome> outcomes) {
  std::uint64_t visits = 0;
  each_tile(
      from, targets.size(),
      [&](std::size_t first, std::size_t count) {
        visits += tracers(view).occlusions(file_of(view), from, targets.subspan(first, count),
                                           outcomes.subspan(first, count));
      },
      [&](std::size_t i) { outcomes[i] = occlusion(view, from, targets[i]); });
  return visits;
}

}  // namespace

std::uint64_t first_hits(const FileView& view, const Location& from, std::span<const Vec3f> directions,
                         std::span<Hit> hits) {
  return first_hits_in(view, from, directions, hits);
}
std::uint64_t first_hits(const TrustedView& view, const Location& from, std::span<const Vec3f> directions,
                         std::span<Hit> hits) {
  return first_hits_in(view, from, directions, hits);
}

std::uint64_t occlusions(const FileView& view, const Location& from, std::span<const Location> targets,
                         std::span<Outcome> outcomes) {
  return occlusions_in(view, from, targets, outcomes);
}
std::uint64_t occlusions(const TrustedView& view, const Location& from, std::span<const Location> targets,
                         std::span<Outcome> outcomes) {
  return occlusions_in(view, from, targets, outcomes);
}

}  // namespace tetfmt
