// SPDX-License-Identifier: AGPL-3.0-or-later
// An output that is the input would destroy what it is made from.
#pragma once

#include <string>

namespace tetprep {

/// Whether both paths lead to one file, be it there already or not. A device may be named twice; "-" is a
/// standard stream and no file, and an empty path nothing.
bool same_file(const std::string& a, const std::string& b);

/// Throws Failure (usage) if they do.
void refuse_same_file(const std::string& input, const std::string& output);

}  // namespace tetprep
