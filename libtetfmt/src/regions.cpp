// SPDX-License-Identifier: MIT
#include "regions.hpp"

#include <cmath>
#include <string>

#include "report.hpp"
#include "tetfmt/orientation.hpp"

namespace tetfmt::detail {
namespace {

__extension__ using Wide = unsigned __int128;

/// The double nearest to numerator / 6.
double sixth(Wide numerator) {
  int shift = 0;
  while (numerator != 0 && numerator >> 120 == 0) {  // a quotient of at least 117 bits: 64 more than a double
    numerator <<= 1;
    ++shift;
  }
  Wide quotient = numerator / 6;
  if (numerator % 6 != 0) quotient |= 1;  // far below the last bit that is kept: it only breaks ties
  return std::ldexp(static_cast<double>(quotient), -shift);
}

Wide sextuple_volume(const std::array<GridPoint, 4>& p) {
  __extension__ using Signed = __int128;
  const auto difference = [&](std::size_t i, std::size_t k) { return Signed{p[i][k] - p[0][k]}; };
  Signed det = 0;
  for (std::size_t k = 0; k < 3; ++k) {
    const std::size_t i = (k + 1) % 3, j = (k + 2) % 3;
    det += difference(3, k) * (difference(1, i) * difference(2, j) - difference(1, j) * difference(2, i));
  }
  return static_cast<Wide>(det < 0 ? -det : det);
}

}  // namespace

void check_regions(const FileView& view, const Topology& topology, Report& report) {
  const auto regions = view.regions();
  if (view.find(kRegions) == nullptr) return;
  const Index tet_count = view.tet_count();
  const auto bad_table = [&](std::size_t i, const std::string& what) {
    add_issue(report, Code::region_table, i, [&] { return "region entry " + str(i) + ": " + what; });
  };

  std::uint64_t end = 0;
  for (std::size_t i = 0; i < regions.size(); ++i) {
    const Region& region = regions[i];
    if (region.reserved != 0) bad_table(i, "the reserved word is not zero");
    if (i > 0 && region.id <= regions[i - 1].id) bad_table(i, "ids do not ascend");
    if (region.id > kMaxCount) bad_table(i, "its id is out of range");
    if (region.first_tet != end) bad_table(i, "starts at tet " + str(region.first_tet) + ", not " + str(end));
    if (region.tet_count == 0) bad_table(i, "has no tets");
    end = std::uint64_t{region.first_tet} + region.tet_count;
    if (end > tet_count) {
      bad_table(i, "ends at tet " + str(end) + " of " + str(tet_count));
      return;
    }
  }
  if (end != tet_count) bad_table(regions.size(), "missing: tets from " + str(end) + " on are in no region");
  if (!report.valid()) return;

  std::vector<Index> entry_of(tet_count);
  for (Index i = 0; i < regions.size(); ++i)
    std::fill_n(entry_of.begin() + regions[i].first_tet, regions[i].tet_count, i);

  const auto bad_extent = [&](Index i, const std::string& what) {
    add_issue(report, Code::region_extent, i, [&] { return "region " + str(regions[i].id) + " " + what; });
  };
  std::vector<bool> reached(tet_count);
  std::vector<Index> stack;
  for (Index i = 0; i < regions.size(); ++i) {
    Index found = 0;
    bool at_hull = false;
    const auto reach = [&](Index t) {
      reached[t] = true;
      stack.push_back(t);
    };
    reach(regions[i].first_tet);
    while (!stack.empty()) {
      const Index t = stack.back();
      stack.pop_back();
      ++found;
      for (const Ref ref : topology.tets[t].neighbors) {
        at_hull |= ref == kHull;
        if (!is_tet(ref)) continue;
        if (entry_of[ref] != i) {
          bad_extent(i, "has tet " + str(t) + ", and tet " + str(ref) + " across a free face is in another");
        } else if (!reached[ref]) {
          reach(ref);
        }
      }
    }
    if (found != regions[i].tet_count) bad_extent(i, "is in several pieces: constrained faces divide it");
    if (at_hull != (regions[i].id == 0))
      bad_extent(i, at_hull ? "touches the hull, so it must be 0" : "does not touch the hull");
  }
}

void check_region_measures(const FileView& view, const Topology& topology, Report& report) {
  const int exponent = view.header().grid_exponent;
  const auto grid_point = [&](Index id) {
    const Vec3f& p = view.vertices()[id];
    const auto steps = [&](float x) { return static_cast<std::int32_t>(std::ldexp(double{x}, -exponent)); };
    return GridPoint{steps(p.x), steps(p.y), steps(p.z)};
  };
  const auto regions = view.regions();
  for (std::size_t i = 0; i < regions.size(); ++i) {
    const Region& region = regions[i];
    Wide volume = 0;
    Bounds bounds;
    for (Index t = region.first_tet; t < region.first_tet + region.tet_count; ++t) {
      const auto& v = topology.tets[t].vertices;
      volume += sextuple_volume({grid_point(v[0]), grid_point(v[1]), grid_point(v[2]), grid_point(v[3])});
      for (const Index id : v) bounds.add(view.vertices()[id]);
    }
    const double expected = std::ldexp(sixth(volume), 3 * exponent);
    if (region.volume != expected) {
      add_issue(report, Code::region_measure, i, [&] {
        return "region " + str(region.id) + " claims volume " + std::to_string(region.volume) + ", has " +
               std::to_string(expected);
      });
    }
    if (!(region.lower == bounds.lower && region.upper == bounds.upper)) {
      add_issue(report, Code::region_measure, i,
                [&] { return "region " + str(region.id) + " claims bounds that are not its vertices'"; });
    }
  }
}

}  // namespace tetfmt::detail
