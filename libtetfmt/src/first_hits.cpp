// SPDX-License-Identifier: MIT
#include <algorithm>
#include <array>
#include <cmath>

#include "tetfmt/traverse.hpp"
#include "tile.hpp"

namespace tetfmt {
namespace {

using namespace detail;

/// Fewer rays than this are walked one by one.
constexpr std::size_t kFewRays = 8;

bool suits_tile(const Vec3f& d) {
  const float largest = std::max({std::abs(d.x), std::abs(d.y), std::abs(d.z)});
  return largest >= 0x1p-60f && largest <= 0x1p60f && !std::isnan(d.x + d.y + d.z);
}

template <class View>
std::uint64_t first_hits_in(const View& view, const FileView& file, TileTracer trace, const Location& from,
                            std::span<const Vec3f> directions, std::span<Hit> hits) {
  using State = Location::State;
  const bool place =
      (from.state == State::inside || from.state == State::outside) &&
      std::all_of(from.position.begin(), from.position.end(), [](double x) { return std::isfinite(x); });
  std::uint64_t visits = 0;
  for (std::size_t begin = 0; begin < directions.size(); begin += kTileRays) {
    const auto tile = directions.subspan(begin, std::min(kTileRays, directions.size() - begin));
    const auto answers = hits.subspan(begin, tile.size());
    if (place && tile.size() >= kFewRays && std::all_of(tile.begin(), tile.end(), suits_tile)) {
      visits += trace(file, from, tile, answers);
      continue;
    }
    for (std::size_t i = 0; i < tile.size(); ++i) {
      answers[i] = first_hit(view, from, tile[i]);
      visits += answers[i].steps;
      answers[i].steps = 0;
    }
  }
  return visits;
}

}  // namespace

std::uint64_t first_hits(const FileView& view, const Location& from, std::span<const Vec3f> directions,
                         std::span<Hit> hits) {
  return first_hits_in(view, view, tile_targets().front().checked, from, directions, hits);
}
std::uint64_t first_hits(const TrustedView& view, const Location& from, std::span<const Vec3f> directions,
                         std::span<Hit> hits) {
  return first_hits_in(view, view.view(), tile_targets().front().unchecked, from, directions, hits);
}

}  // namespace tetfmt
