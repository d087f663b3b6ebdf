// SPDX-License-Identifier: MIT
#include "hash.hpp"

// Header-only on purpose: an installed libtetfmt then depends on nothing but the C++ library.
#define XXH_INLINE_ALL
#include <xxhash.h>

namespace tetfmt::detail {

std::uint64_t hash(std::span<const std::byte> bytes) {
  return XXH3_64bits(bytes.data(), bytes.size());
}

}  // namespace tetfmt::detail
