// SPDX-License-Identifier: AGPL-3.0-or-later
// Onto a uniform power-of-two grid, before anything is built: rounding to float32 afterwards would invert
// tetrahedra, and on the grid every orientation is integer arithmetic.
#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numeric>

#include "common/parse.hpp"
#include "prep/prep.hpp"

namespace tetprep {
namespace {

/// A new grid has between 2^20 and 2^21 steps over the largest extent. One that the coordinates bring along
/// may be finer than that, up to 2^22: with the box's margins, differences stay below 2^23.
constexpr int kStepBits = 21;
constexpr int kMostStepBits = 22;
/// What float32 can hold: steps that are normal numbers, and 2^24 of them below its largest number.
constexpr int kLeastExponent = std::numeric_limits<float>::min_exponent - 1;
constexpr int kMostExponent = std::numeric_limits<float>::max_exponent - 24;

/// The largest e such that `value` is a multiple of 2^e; `value` is finite and not 0.
int lowest_bit(double value) {
  const auto bits = std::bit_cast<std::uint64_t>(value);
  const auto biased = static_cast<int>(bits >> 52 & 0x7FF);
  std::uint64_t mantissa = bits & ((std::uint64_t{1} << 52) - 1);
  if (biased != 0) mantissa |= std::uint64_t{1} << 52;
  return std::max(biased, 1) - 1075 + std::countr_zero(mantissa);
}

struct Extent {
  Point low, high;
  double largest = 0;
  int lowest_bit = std::numeric_limits<int>::max();  ///< of all coordinates; max() if all are 0
};

Extent extent_of(const TriangleSoup& soup, const std::vector<bool>& used) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  Extent extent{{kInfinity, kInfinity, kInfinity}, {-kInfinity, -kInfinity, -kInfinity}};
  for (std::size_t i = 0; i < soup.points.size(); ++i) {
    if (!used[i]) continue;
    for (std::size_t k = 0; k < 3; ++k) {
      const double value = soup.points[i][k];
      extent.low[k] = std::min(extent.low[k], value);
      extent.high[k] = std::max(extent.high[k], value);
      if (value != 0) extent.lowest_bit = std::min(extent.lowest_bit, lowest_bit(value));
    }
  }
  for (std::size_t k = 0; k < 3; ++k)
    extent.largest = std::max(extent.largest, extent.high[k] - extent.low[k]);
  return extent;
}

/// The grid's exponent: fine enough for Steiner points, and never coarser than coordinates that allow it,
/// unless it is asked to be.
int choose_exponent(const Extent& extent, int coarser_bits) {
  int over = 0;  // 2^over is the least power of two that is not below the extent
  if (std::frexp(extent.largest, &over) == 0.5) --over;
  const int fresh = over - kStepBits + coarser_bits;
  if (coarser_bits > 0) return fresh;
  if (extent.lowest_bit >= fresh) return fresh;
  return extent.largest <= std::ldexp(1.0, extent.lowest_bit + kMostStepBits) ? extent.lowest_bit : fresh;
}

/// 0 where the grid coordinates around 0 are small enough (the box's margin included), else the middle.
/// The middle is a multiple of the step: an origin off the grid would round every point.
Point choose_origin(const Extent& extent, double step) {
  const double reach =
      (kMaxCoordinate - 2) * step - extent.largest / 16;  // box_around()'s margin, rounded up
  Point origin{};
  for (std::size_t k = 0; k < 3; ++k) {
    if (extent.low[k] >= -reach && extent.high[k] <= reach) continue;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const double middle = extent.low[axis] + (extent.high[axis] - extent.low[axis]) / 2;
      origin[axis] = std::nearbyint(middle / step) * step + 0.0;  // + 0.0 turns -0 into 0
    }
    break;
  }
  return origin;
}

/// The grid point of every input point, kNone for those that no triangle uses. Equal ones become one.
std::vector<Index> place_points(const TriangleSoup& soup, const std::vector<bool>& used,
                                CleanSurface& surface) {
  const double step = std::ldexp(1.0, surface.grid_exponent);
  std::vector<GridPoint> grid(soup.points.size());
  std::vector<Index> by_place;
  for (std::size_t i = 0; i < grid.size(); ++i) {
    if (!used[i]) continue;
    double squared = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      const double offset = soup.points[i][k] - surface.origin[k];
      const double rounded = std::nearbyint(offset / step);
      grid[i][k] = static_cast<std::int32_t>(rounded);
      const double error = offset - rounded * step;
      squared += error * error;
    }
    surface.max_deviation = std::max(surface.max_deviation, std::sqrt(squared));
    by_place.push_back(static_cast<Index>(i));
  }
  std::sort(by_place.begin(), by_place.end(),
            [&](Index a, Index b) { return grid[a] != grid[b] ? grid[a] < grid[b] : a < b; });
  std::vector<Index> first(soup.points.size(), kNone);  // the first input point at the same place
  for (std::size_t i = 0; i < by_place.size(); ++i) {
    const bool repeated = i > 0 && grid[by_place[i]] == grid[by_place[i - 1]];
    first[by_place[i]] = repeated ? first[by_place[i - 1]] : by_place[i];
    surface.merged_points += repeated;
  }
  surface.points = std::move(grid);  // for now by input number: keep_sound_triangles() compacts
  return first;
}

bool is_degenerate(const GridPoint& a, const GridPoint& b, const GridPoint& c) {
  for (std::size_t axis = 0; axis < 3; ++axis)
    if (tetfmt::doubled_area(a, b, c, axis) != 0) return false;
  return true;
}

/// Fills in the triangles with an area, each once, and drops the points that are left without one.
void keep_sound_triangles(const TriangleSoup& soup, const std::vector<Index>& first, CleanSurface& surface) {
  struct Candidate {
    std::array<Index, 3> key;  ///< corners, ascending
    Index triangle;
    bool operator<(const Candidate& other) const {
      return key != other.key ? key < other.key : triangle < other.triangle;
    }
  };
  std::vector<Candidate> candidates;
  candidates.reserve(soup.triangles.size());
  for (std::size_t t = 0; t < soup.triangles.size(); ++t) {
    const auto& [a, b, c] = soup.triangles[t];
    if (is_degenerate(surface.points[a], surface.points[b], surface.points[c])) {
      ++surface.degenerate_triangles;
      continue;
    }
    Candidate candidate{{first[a], first[b], first[c]}, static_cast<Index>(t)};
    std::sort(candidate.key.begin(), candidate.key.end());
    candidates.push_back(candidate);
  }
  std::sort(candidates.begin(), candidates.end());
  for (std::size_t i = 0; i < candidates.size(); ++i) {
    if (i > 0 && candidates[i].key == candidates[i - 1].key) {
      ++surface.duplicate_triangles;
    } else {
      surface.input_triangle.push_back(candidates[i].triangle);
    }
  }
  std::sort(surface.input_triangle.begin(), surface.input_triangle.end());

  std::vector<Index> number(surface.points.size(), kNone);
  std::vector<GridPoint> points;
  for (const Index t : surface.input_triangle) {
    std::array<Index, 3> corners{};
    for (std::size_t k = 0; k < 3; ++k) {
      const Index from = first[soup.triangles[t][k]];
      if (number[from] == kNone) {
        number[from] = static_cast<Index>(points.size());
        points.push_back(surface.points[from]);
      }
      corners[k] = number[from];
    }
    surface.triangles.push_back(corners);
  }
  surface.points = std::move(points);
}

/// Whether a triangle has an area beyond what rounding makes of corners on a line.
bool has_area(const Point& a, const Point& b, const Point& c) {
  const auto length = [](const Point& v) { return std::hypot(v[0], v[1], v[2]); };
  const Point u{b[0] - a[0], b[1] - a[1], b[2] - a[2]}, v{c[0] - a[0], c[1] - a[1], c[2] - a[2]};
  const double longest = std::max(length(u), length(v));
  if (longest == 0) return false;
  const Point s{u[0] / longest, u[1] / longest, u[2] / longest};
  const Point t{v[0] / longest, v[1] / longest, v[2] / longest};
  return length({s[1] * t[2] - s[2] * t[1], s[2] * t[0] - s[0] * t[2], s[0] * t[1] - s[1] * t[0]}) > 1e-12;
}

[[noreturn]] void fail_without_area(const TriangleSoup& soup, int grid_exponent, int coarser_bits) {
  const std::string count = std::to_string(soup.triangles.size());
  const bool lost_on_grid = std::any_of(soup.triangles.begin(), soup.triangles.end(), [&](const auto& t) {
    return has_area(soup.points[t[0]], soup.points[t[1]], soup.points[t[2]]);
  });
  if (!lost_on_grid) throw Failure(ExitCode::invalid, "none of the " + count + " triangles has an area");
  throw Failure(ExitCode::invalid,
                "none of the " + count + " triangles keeps an area: smaller than the grid step " +
                    number(std::ldexp(1.0, grid_exponent)) + " (extent / 2^" +
                    std::to_string(kStepBits - coarser_bits) + "); split the scene or scale its parts");
}

}  // namespace

CleanSurface snap(const TriangleSoup& soup, int coarser_bits) {
  std::vector<bool> used(soup.points.size(), false);
  for (const auto& triangle : soup.triangles)
    for (const Index corner : triangle) used[corner] = true;

  CleanSurface surface;
  surface.input_triangle_count = static_cast<Index>(soup.triangles.size());
  const Extent extent = extent_of(soup, used);
  if (extent.largest == 0) throw Failure(ExitCode::invalid, "all points of the surface are one and the same");
  if (std::isfinite(extent.largest)) surface.grid_exponent = choose_exponent(extent, coarser_bits);
  if (!std::isfinite(extent.largest) || surface.grid_exponent < kLeastExponent ||
      surface.grid_exponent > kMostExponent)
    throw Failure(ExitCode::unsupported, "the surface's extent, " + number(extent.largest) +
                                             ", is beyond what single precision can hold: scale it");
  surface.origin = choose_origin(extent, std::ldexp(1.0, surface.grid_exponent));
  const std::vector<Index> first = place_points(soup, used, surface);
  keep_sound_triangles(soup, first, surface);
  if (surface.triangles.empty()) fail_without_area(soup, surface.grid_exponent, coarser_bits);
  return surface;
}

}  // namespace tetprep
