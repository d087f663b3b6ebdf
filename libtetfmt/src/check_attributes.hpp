// SPDX-License-Identifier: MIT
#pragma once

#include "tetfmt/validate.hpp"
#include "tetfmt/view.hpp"

namespace tetfmt::detail {

/// Level::topology, the optional sections about the surface: counts that belong together, indices, texts.
/// O(their elements).
void check_attributes(const FileView& view, Report& report);

}  // namespace tetfmt::detail
