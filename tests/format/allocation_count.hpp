// SPDX-License-Identifier: AGPL-3.0-or-later
// How much a piece of code asked operator new for.
#pragma once

#include <cstddef>

namespace tetfmt_test {

/// Bytes requested from operator new by this process since the last reset, freed or not.
std::size_t allocated_bytes();
void reset_allocated_bytes();

}  // namespace tetfmt_test
