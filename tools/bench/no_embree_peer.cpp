// SPDX-License-Identifier: AGPL-3.0-or-later
#include "bench/bench.hpp"

namespace tetbench {

std::unique_ptr<Tracer> make_embree(const tetfmt::FileView&, bool) {
  return nullptr;
}

}  // namespace tetbench
