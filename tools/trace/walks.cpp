// SPDX-License-Identifier: AGPL-3.0-or-later
#include "trace/walks.hpp"

#include <array>

namespace tetprep {
namespace {

using tetfmt::BatchRay, tetfmt::FileView, tetfmt::Hit, tetfmt::Location, tetfmt::Outcome, tetfmt::Vec3f;

tetfmt::Kernel kernel_of(Walks walks) {
  return walks == Walks::float_signs ? tetfmt::Kernel::float_only : tetfmt::Kernel::exact;
}

}  // namespace

std::uint64_t first_hits(Walks walks, const FileView& view, const Location& from,
                         std::span<const Vec3f> directions, std::span<Hit> hits) {
  if (walks == Walks::together) return tetfmt::first_hits(view, from, directions, hits);
  std::uint64_t visits = 0;
  for (std::size_t i = 0; i < directions.size(); ++i) {
    hits[i] = tetfmt::first_hit(view, from, directions[i], {}, kernel_of(walks));
    visits += hits[i].steps;
  }
  return visits;
}

void first_hits(Walks walks, const FileView& view, std::span<const Location> places,
                std::span<const BatchRay> rays, std::span<Hit> hits) {
  if (walks == Walks::together) return tetfmt::trace_batch(view, places, rays, hits);
  for (std::size_t i = 0; i < rays.size(); ++i) {
    hits[i] =
        tetfmt::first_hit(view, places[rays[i].from], rays[i].direction, rays[i].interval, kernel_of(walks));
  }
}

void occlusions(Walks walks, const FileView& view, std::span<const Location> places,
                std::span<const BatchRay> rays, std::span<Outcome> outcomes) {
  if (walks == Walks::together) return tetfmt::occlude_batch(view, places, rays, outcomes);
  for (std::size_t i = 0; i < rays.size(); ++i) {
    const BatchRay& ray = rays[i];
    const Location& from = places[ray.from];
    outcomes[i] =
        walks == Walks::one_by_one
            ? tetfmt::occlusion(view, from, ray.direction, ray.interval)
            : tetfmt::first_hit(view, from, ray.direction, ray.interval, tetfmt::Kernel::float_only).outcome;
  }
}

void occlusions(Walks walks, const FileView& view, std::span<const Location> places, const Location& target,
                std::span<Outcome> outcomes) {
  if (walks == Walks::together) {
    tetfmt::occlusions(view, target, places, outcomes);
    return;
  }
  for (std::size_t i = 0; i < places.size(); ++i) {
    const Location& from = places[i];
    if (walks == Walks::one_by_one) {
      outcomes[i] = tetfmt::occlusion(view, from, target);
      continue;
    }
    std::array<float, 3> to{};
    for (std::size_t k = 0; k < 3; ++k) to[k] = static_cast<float>(target.position[k] - from.position[k]);
    outcomes[i] =
        tetfmt::first_hit(view, from, {to[0], to[1], to[2]}, {0, 1}, tetfmt::Kernel::float_only).outcome;
  }
}

}  // namespace tetprep
