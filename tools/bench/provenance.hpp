// SPDX-License-Identifier: AGPL-3.0-or-later
// Where figures come from: a number without its machine and its version means little.
#pragma once

#include <string>
#include <utility>
#include <vector>

namespace tetbench {

/// Name and value: version, commit, compiler, flags of the build, processor, number of threads that it runs.
std::vector<std::pair<std::string, std::string>> provenance();

/// The same, one line each.
std::string provenance_text();

}  // namespace tetbench
