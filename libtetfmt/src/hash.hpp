// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

namespace tetfmt::detail {

/// XXH3-64 with seed 0.
std::uint64_t hash(std::span<const std::byte> bytes);

}  // namespace tetfmt::detail
