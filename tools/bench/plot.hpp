// SPDX-License-Identifier: AGPL-3.0-or-later
// Plots as SVG: panels in a grid, one legend for all.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace tetbench {

enum class Shape : std::uint8_t { circle, square, diamond, triangle, pointer, hexagon, cross, plus, bar };
inline constexpr std::size_t kShapes = 9;

/// How a series looks, in every panel.
struct Mark {
  const char* color = "#000000";
  Shape shape = Shape::circle;
  bool filled = true;
};

struct Series {
  std::string name;  ///< the same name has the same mark
  Mark mark;
  bool joined = false;  ///< points are joined by lines, in their order
  struct Point {
    double x = 0, y = 0;
  };
  std::vector<Point> points;
};

struct Axis {
  std::string label;
  bool log = false;
  bool reversed = false;     ///< large values first
  std::string zero = {};     ///< log: the label of a place beside the axis for values that are 0; empty: none
  double low = 0, high = 0;  ///< shown at least, if low < high, beside what the values need
};

struct Panel {
  std::string title;
  Axis x, y;
  std::vector<Series> series;
};

/// The whole SVG file. Values that an axis cannot show (0 or less on a log axis without a place for them,
/// not finite) are left out.
std::string figure(const std::string& title, const std::string& note, const std::vector<Panel>& panels);

}  // namespace tetbench
