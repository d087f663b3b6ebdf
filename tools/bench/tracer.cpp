// SPDX-License-Identifier: AGPL-3.0-or-later
#include "bench/tracer.hpp"

namespace tetbench {

std::vector<TracerKind> tracer_kinds() {
  std::vector<TracerKind> kinds;
  add_ours(kinds);
#ifdef TETFMT_HAVE_EMBREE
  add_embree(kinds);
#endif
  add_trees(kinds);
#ifdef TETFMT_HAVE_CGAL
  add_cgal(kinds);
#endif
  return kinds;
}

}  // namespace tetbench
