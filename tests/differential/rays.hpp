// SPDX-License-Identifier: AGPL-3.0-or-later
// Rays that are usual, and rays that are meant to hurt, around one file.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "tetfmt/traverse.hpp"
#include "tetfmt/view.hpp"

namespace tetfmt_test {

struct RayFamily {
  std::string name;
  std::vector<tetfmt::Ray> rays;
};

/// `count` rays in local coordinates, in families; the same on every machine for the same file and seed. The
/// file must be valid and have at least one triangle. Families that aim at a vertex or an edge do so exactly:
/// the float32 ray, taken as it is, passes through that point.
std::vector<RayFamily> make_rays(const tetfmt::FileView& view, std::size_t count, std::uint64_t seed);

}  // namespace tetfmt_test
