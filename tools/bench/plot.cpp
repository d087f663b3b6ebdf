// SPDX-License-Identifier: AGPL-3.0-or-later
#include "bench/plot.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include "bench/text.hpp"

namespace tetbench {
namespace {

constexpr double kPanelWidth = 400, kPanelHeight = 310;  // with labels
constexpr double kFew = 1.4;                             // times as large if there are one or two of them
constexpr double kLeft = 62, kRight = 14, kTop = 30, kBottom = 48;
constexpr double kLegendRow = 20, kLegendColumn = 190, kHeader = 52;
constexpr double kZeroPlace = 34;  // width of the place for zeros
constexpr double kMark = 4.6;
constexpr const char* kInk = "#222222";
constexpr const char* kGrid = "#dddddd";

std::string escaped(const std::string& text) {
  std::string result;
  for (const char c : text) {
    if (c == '&')
      result += "&amp;";
    else if (c == '<')
      result += "&lt;";
    else if (c == '>')
      result += "&gt;";
    else if (c == '"')
      result += "&quot;";
    else if (static_cast<unsigned char>(c) >= 0x20)
      result += c;
    else
      result += ' ';  // other control characters are no XML
  }
  return result;
}

std::string text(double x, double y, const std::string& words, const char* anchor = "start", int size = 12,
                 const char* more = "") {
  return format("<text x=\"%.1f\" y=\"%.1f\" text-anchor=\"%s\" font-size=\"%d\"%s>", x, y, anchor, size,
                more) +
         escaped(words) + "</text>\n";
}
std::string line(double x1, double y1, double x2, double y2, const char* color) {
  return format("<line x1=\"%.1f\" y1=\"%.1f\" x2=\"%.1f\" y2=\"%.1f\" stroke=\"%s\"/>\n", x1, y1, x2, y2,
                color);
}

std::string mark(double x, double y, const Mark& mark) {
  const double r = kMark;
  std::string path;
  const auto corner = [&](double dx, double dy) {
    path += format("%s%.2f,%.2f", path.empty() ? "" : " ", x + r * dx, y + r * dy);
  };
  const std::string paint = format("fill=\"%s\" stroke=\"%s\" stroke-width=\"1.6\"",
                                   mark.filled ? mark.color : "#ffffff", mark.color);
  switch (mark.shape) {
    case Shape::circle:
      return format("<circle cx=\"%.2f\" cy=\"%.2f\" r=\"%.2f\" %s/>\n", x, y, r, paint.c_str());
    case Shape::square:
      corner(-0.9, -0.9), corner(0.9, -0.9), corner(0.9, 0.9), corner(-0.9, 0.9);
      break;
    case Shape::diamond:
      corner(0, -1.25), corner(1.25, 0), corner(0, 1.25), corner(-1.25, 0);
      break;
    case Shape::triangle:
      corner(0, -1.2), corner(1.1, 0.8), corner(-1.1, 0.8);
      break;
    case Shape::pointer:
      corner(0, 1.2), corner(1.1, -0.8), corner(-1.1, -0.8);
      break;
    case Shape::hexagon:
      corner(-0.55, -1), corner(0.55, -1), corner(1.15, 0), corner(0.55, 1), corner(-0.55, 1),
          corner(-1.15, 0);
      break;
    case Shape::bar:
      corner(-1.3, -0.45), corner(1.3, -0.45), corner(1.3, 0.45), corner(-1.3, 0.45);
      break;
    case Shape::cross:
    case Shape::plus: {
      const double d = mark.shape == Shape::plus ? 0 : r, e = mark.shape == Shape::plus ? 1.25 * r : r;
      return format(
          "<path d=\"M%.2f %.2fL%.2f %.2fM%.2f %.2fL%.2f %.2f\" stroke=\"%s\" "
          "stroke-width=\"2.2\" fill=\"none\"/>\n",
          x - e, y - d, x + e, y + d, x + d, y - e, x - d, y + e, mark.color);
    }
  }
  return "<polygon points=\"" + path + "\" " + paint + "/>\n";
}

/// From values to places along one side of a panel.
class Scale {
 public:
  /// From `start` to `end`, which may be less.
  Scale(const Axis& axis, std::vector<double> values, double start, double end) : axis_(axis) {
    std::erase_if(values, [&](double v) { return !std::isfinite(v) || (axis.log && v <= 0); });
    zeros_ = !axis.zero.empty();
    zero_ = start + (end > start ? 1 : -1) * kZeroPlace / 2;
    start_ = zeros_ ? start + (end > start ? 1 : -1) * kZeroPlace : start;
    end_ = end;
    if (axis.low < axis.high) {
      values.push_back(axis.low);
      values.push_back(axis.high);
    }
    if (values.empty()) values = {1, 10};
    low_ = forward(*std::min_element(values.begin(), values.end()));
    high_ = forward(*std::max_element(values.begin(), values.end()));
    const double room = std::max(0.06 * (high_ - low_), axis.log ? 0.1 : 1e-9 + 0.05 * std::abs(high_));
    low_ -= room, high_ += room;
    if (!axis.log && low_ < 0 && *std::min_element(values.begin(), values.end()) >= 0) low_ = 0;
  }
  bool shows(double value) const {
    return std::isfinite(value) && (!axis_.log || value > 0 || (value == 0 && zeros_));
  }
  double at(double value) const {
    if (axis_.log && value == 0) return zero_;
    double share = (forward(value) - low_) / (high_ - low_);
    if (axis_.reversed) share = 1 - share;
    return start_ + share * (end_ - start_);
  }
  std::vector<double> ticks() const {
    std::vector<double> ticks;
    if (!axis_.log) {
      const double raw = (high_ - low_) / 5, power = std::pow(10, std::floor(std::log10(raw)));
      const double step = power * (raw / power > 5 ? 10 : raw / power > 2 ? 5 : raw / power > 1 ? 2 : 1);
      for (double tick = std::ceil(low_ / step) * step; tick <= high_; tick += step)
        ticks.push_back(std::abs(tick) < step / 1e6 ? 0 : tick);
      return ticks;
    }
    const bool fine = high_ - low_ < 2;
    for (double power = std::floor(low_); power <= high_; ++power)
      for (const double digit : {1.0, 2.0, 5.0}) {
        const double tick = std::log10(digit) + power;
        if ((digit == 1 || fine) && tick >= low_ && tick <= high_) ticks.push_back(std::pow(10, tick));
      }
    return ticks;
  }
  bool zeros() const { return zeros_; }
  double zero() const { return zero_; }
  double first() const { return start_; }

 private:
  double forward(double value) const { return axis_.log ? std::log10(value) : value; }
  const Axis& axis_;
  bool zeros_ = false;
  double low_ = 0, high_ = 1, start_ = 0, end_ = 1, zero_ = 0;
};

std::string number_label(double value) {
  if (value >= 1e6) return format("%g M", value / 1e6);
  if (value >= 1e4) return format("%g k", value / 1e3);
  return format("%.6g", value);
}

std::string drawn(const Panel& panel, double left, double top, double width, double height) {
  std::vector<double> xs, ys;
  for (const Series& series : panel.series)
    for (const Series::Point& point : series.points) xs.push_back(point.x), ys.push_back(point.y);
  const double x0 = left + kLeft, x1 = left + width - kRight, y0 = top + height - kBottom, y1 = top + kTop;
  const Scale x(panel.x, xs, x0, x1), y(panel.y, ys, y0, y1);
  std::string svg = text((x0 + x1) / 2, top + 19, panel.title, "middle", 13, " font-weight=\"bold\"");
  for (const double tick : x.ticks()) {
    svg += line(x.at(tick), y0, x.at(tick), y1, kGrid);
    svg += text(x.at(tick), y0 + 15, number_label(tick), "middle", 11);
  }
  for (const double tick : y.ticks()) {
    svg += line(x0, y.at(tick), x1, y.at(tick), kGrid);
    svg += text(x0 - 6, y.at(tick) + 4, number_label(tick), "end", 11);
  }
  if (x.zeros()) {
    svg += line(x.first(), y0, x.first(), y1, kInk);
    svg += text(x.zero(), y0 + 15, panel.x.zero, "middle", 11);
  }
  svg += format("<rect x=\"%.1f\" y=\"%.1f\" width=\"%.1f\" height=\"%.1f\" fill=\"none\" stroke=\"%s\"/>\n",
                x0, y1, x1 - x0, y0 - y1, kInk);
  svg += text((x0 + x1) / 2, y0 + 34, panel.x.label, "middle");
  svg += format("<g transform=\"translate(%.1f %.1f) rotate(-90)\">", left + 14, (y0 + y1) / 2) +
         text(0, 0, panel.y.label, "middle") + "</g>\n";
  for (const Series& series : panel.series) {
    std::string path, marks;
    for (const Series::Point& point : series.points) {
      if (!x.shows(point.x) || !y.shows(point.y)) continue;
      path += format("%s%.2f,%.2f", path.empty() ? "" : " ", x.at(point.x), y.at(point.y));
      marks += mark(x.at(point.x), y.at(point.y), series.mark);
    }
    if (series.joined && !path.empty())
      svg += "<polyline points=\"" + path + "\" fill=\"none\" stroke=\"" + series.mark.color +
             "\" stroke-width=\"1.4\"/>\n";
    // What a mark is, for those who point at it.
    svg += "<g><title>" + escaped(series.name) + "</title>" + marks + "</g>\n";
  }
  return svg;
}

}  // namespace

std::string figure(const std::string& title, const std::string& note, const std::vector<Panel>& panels) {
  std::vector<std::pair<std::string, Mark>> legend;
  for (const Panel& panel : panels)
    for (const Series& series : panel.series)
      if (std::none_of(legend.begin(), legend.end(),
                       [&](const auto& known) { return known.first == series.name; }))
        legend.emplace_back(series.name, series.mark);
  const std::size_t columns = std::clamp<std::size_t>(panels.size(), 2, 3),
                    rows = (panels.size() + columns - 1) / columns;
  const double enlarged = panels.size() <= 2 ? kFew : 1, panel_width = enlarged * kPanelWidth,
               panel_height = enlarged * kPanelHeight;
  const double width = static_cast<double>(columns) * panel_width;
  const auto across = static_cast<std::size_t>(width / kLegendColumn);
  const std::size_t legend_rows = (legend.size() + across - 1) / across;
  const double legend_top = kHeader + static_cast<double>(rows) * panel_height + 14,
               height = legend_top + static_cast<double>(legend_rows) * kLegendRow + 10;
  std::string svg = format(
      "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"%.0f\" height=\"%.0f\" viewBox=\"0 0 %.0f %.0f\" "
      "font-family=\"Helvetica, Arial, DejaVu Sans, sans-serif\" fill=\"%s\">\n",
      width, height, width, height, kInk);
  svg += "<title>" + escaped(title) + "</title>\n";
  svg += format("<rect width=\"%.0f\" height=\"%.0f\" fill=\"#ffffff\"/>\n", width, height);
  svg += text(16, 24, title, "start", 16, " font-weight=\"bold\"") + text(16, 42, note, "start", 11);
  for (std::size_t i = 0; i < panels.size(); ++i)
    svg += drawn(panels[i], static_cast<double>(i % columns) * panel_width,
                 kHeader + static_cast<double>(i / columns) * panel_height, panel_width, panel_height);
  for (std::size_t i = 0; i < legend.size(); ++i) {
    const double x = 24 + static_cast<double>(i / legend_rows) * kLegendColumn,
                 y = legend_top + static_cast<double>(i % legend_rows) * kLegendRow;
    svg += mark(x, y, legend[i].second) + text(x + 12, y + 4, legend[i].first);
  }
  return svg + "</svg>\n";
}

}  // namespace tetbench
