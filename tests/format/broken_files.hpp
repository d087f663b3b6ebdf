// SPDX-License-Identifier: AGPL-3.0-or-later
// One small broken file for every code of issues.def: each is a valid file with one thing made wrong (and the
// hashes made to match), so that the code is what the edit deserves and no by-product.
#pragma once

#include <functional>
#include <vector>

#include "format_support.hpp"

namespace tetfmt_test {

struct BrokenFile {
  tetfmt::Code code;
  const char* what;
  std::function<Bytes()> make;
};

/// Several for most codes; 1xxx aside, where there are no bytes.
const std::vector<BrokenFile>& broken_files();

}  // namespace tetfmt_test
