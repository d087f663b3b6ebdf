// SPDX-License-Identifier: AGPL-3.0-or-later
// An output that is the input would destroy what it is made from.
#pragma once

#include <string>

namespace tetprep {

/// Throws Failure (usage) if both names lead to the same existing file, by whatever path, hard or symbolic
/// link. "-" is a standard stream and no file.
void refuse_same_file(const std::string& input, const std::string& output);

}  // namespace tetprep
