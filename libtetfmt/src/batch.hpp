// SPDX-License-Identifier: MIT
// Batches by the vectors of a given kind of processor: what tetfmt/batch.hpp does by the best of them.
#pragma once

#include "batch_lanes.hpp"
#include "tetfmt/batch.hpp"

namespace tetfmt::detail {

void trace_batch(const BatchTarget& target, const FileView& view, std::span<const Location> places,
                 std::span<const BatchRay> rays, std::span<Hit> hits);
void trace_batch(const BatchTarget& target, const TrustedView& view, std::span<const Location> places,
                 std::span<const BatchRay> rays, std::span<Hit> hits);
void occlude_batch(const BatchTarget& target, const FileView& view, std::span<const Location> places,
                   std::span<const BatchRay> rays, std::span<Outcome> outcomes);
void occlude_batch(const BatchTarget& target, const TrustedView& view, std::span<const Location> places,
                   std::span<const BatchRay> rays, std::span<Outcome> outcomes);
void occlude_batch(const BatchTarget& target, const FileView& view, std::span<const Location> places,
                   std::span<const BatchSegment> segments, std::span<Outcome> outcomes);
void occlude_batch(const BatchTarget& target, const TrustedView& view, std::span<const Location> places,
                   std::span<const BatchSegment> segments, std::span<Outcome> outcomes);

}  // namespace tetfmt::detail
