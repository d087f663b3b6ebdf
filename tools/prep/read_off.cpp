// SPDX-License-Identifier: AGPL-3.0-or-later
// Geomview's OFF, ascii and binary: [ST][C][N][4]OFF with colours of vertices or faces.
// http://www.geomview.org/docs/html/OFF.html
//
// Not by CGAL: its reader takes three times as long, answers "no" without saying why, and believes counts.
#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

#include "prep/read_soup.hpp"
#include "prep/text_lines.hpp"

namespace tetprep {
namespace {

constexpr float kNoValue = std::numeric_limits<float>::quiet_NaN();

class OffReader {
 public:
  explicit OffReader(const SourceFile& file) : file_(file), lines_(file.text), warnings_(file.path) {}

  PolygonSoup read() {
    header();
    if (binary_)
      binary_body();
    else
      text_body();
    finish_colors();
    warnings_.append_to(soup_.warnings);
    return std::move(soup_);
  }

 private:
  [[noreturn]] void fail(const std::string& message) const { file_.fail(lines_.number(), message); }
  [[noreturn]] void cut_short() const {
    file_.fail(binary_ ? 0 : lines_.number(), "ends before all of its " + std::to_string(points_) +
                                                  " points and " + std::to_string(faces_) +
                                                  " faces have come: cut short, or damaged");
  }

  void header() {
    std::string_view line;
    if (!lines_.next(line)) file_.fail(0, "no mesh in it");
    std::string_view after = line;
    std::string_view word = next_word(after);
    // The key word may be missing: then the file starts with its counts.
    if (!parse_integer<std::uint64_t>(word)) {
      const std::string_view whole = word;
      const auto take = [&](std::string_view prefix) {
        if (!word.starts_with(prefix)) return false;
        word.remove_prefix(prefix.size());
        return true;
      };
      texcoords_ = take("ST");
      colors_ = take("C");
      normals_ = take("N");
      homogeneous_ = take("4");
      const bool any_dimension = take("n");
      if (word != "OFF") fail("does not start as an OFF file");
      if (any_dimension)
        file_.unsupported(lines_.number(), quote(whole) + ": only three dimensions are read");
      line = trim(after);
      std::string_view rest = line;
      if (next_word(rest) == "BINARY") {
        binary_ = true;
        return;
      }
      if (line.empty() && !lines_.next(line)) fail("ends after its first line");
    }
    const auto points = parse_integer<std::uint64_t>(next_word(line));
    std::string_view second = next_word(line);
    if (second.empty() && points && lines_.next(line)) second = next_word(line);
    const auto faces = parse_integer<std::uint64_t>(second);
    if (!points || !faces) fail("expected the numbers of points and faces");
    points_ = *points;
    faces_ = *faces;
  }

  void text_body() {
    // Two bytes are the least that a number takes.
    const std::size_t room = lines_.rest().size() / 2 + 1;
    soup_.points.reserve(std::min<std::uint64_t>(points_, room / 3));
    soup_.point_lines.reserve(soup_.points.capacity());
    soup_.ends.reserve(std::min<std::uint64_t>(faces_, room / 4));
    soup_.lines.reserve(soup_.ends.capacity());
    soup_.corners.reserve(3 * soup_.ends.capacity());
    std::string_view line;
    for (std::uint64_t i = 0; i < points_; ++i) {
      if (!lines_.next(line)) cut_short();
      text_point(line);
    }
    for (std::uint64_t i = 0; i < faces_; ++i) {
      if (!lines_.next(line)) cut_short();
      text_face(line);
    }
  }

  double coordinate(std::string_view& line) const {
    const std::string_view word = next_word(line);
    if (word.empty())
      fail("a point needs " + std::string(homogeneous_ ? "four" : "three") +
           " coordinates, one point a line");
    const auto value = parse_double(word);
    if (!value || !std::isfinite(*value)) fail(quote(word) + " is not a finite coordinate");
    return *value;
  }

  /// Numbers after what every point or face has; a colour, if there is one, starts at position `color`.
  void trailing(std::string_view line, std::size_t color) {
    trailing_.clear();
    for (std::string_view word; !(word = next_word(line)).empty();) {
      const auto value = parse_double(word);
      if (!value) fail(quote(word) + " is not a number");
      const bool of_color = trailing_.size() >= color && trailing_.size() < color + 3;
      fractions_ = fractions_ || (of_color && word.find('.') != std::string_view::npos);
      trailing_.push_back(static_cast<float>(*value));
    }
  }

  void text_point(std::string_view line) {
    Point point{};
    for (double& x : point) x = coordinate(line);
    if (homogeneous_) {
      const double w = coordinate(line);
      for (double& x : point) x /= w;
    }
    soup_.points.push_back(point);
    soup_.point_lines.push_back(lines_.number());
    if (trim(line).empty() && !normals_ && !colors_ && !texcoords_) return;
    trailing(line, colors_ ? (normals_ ? 3u : 0u) : std::string_view::npos - 3);
    values_of_point();
  }

  /// Shares out `trailing_`: normal, colour and texture coordinates, in this order.
  void values_of_point() {
    const std::size_t fixed = (normals_ ? 3u : 0u) + (texcoords_ ? 2u : 0u);
    const std::size_t count = trailing_.size();
    const std::size_t color = colors_ && count > fixed ? std::min<std::size_t>(count - fixed, 4) : 0;
    if (count != fixed + color || (colors_ && color < 3)) {
      if (!warned_) {
        warnings_.add(binary_ ? 0 : lines_.number(),
                      std::to_string(count) +
                          " numbers after a point's coordinates are not what the key word "
                          "(COFF, NOFF, STOFF) says: skipped, here and wherever else");
        warned_ = true;
      }
      trailing_.assign(fixed + (colors_ ? 3 : 0), kNoValue);
    }
    const float* value = trailing_.data();
    if (normals_) {
      soup_.normals.rows.push_back({value[0], value[1], value[2]});
      value += 3;
    }
    if (colors_) {
      const bool alpha = trailing_.size() == fixed + 4;
      soup_.colors.rows.push_back({value[0], value[1], value[2], alpha ? value[3] : kNoAlpha});
      value += alpha ? 4 : 3;
    }
    if (texcoords_) soup_.texcoords.rows.push_back({value[0], value[1]});
  }

  void text_face(std::string_view line) {
    const auto count = parse_integer<std::uint64_t>(next_word(line));
    if (!count || *count > line.size() / 2)
      fail("expected the number of corners of a face, then its corners, one face a line");
    for (std::uint64_t k = 0; k < *count; ++k) {
      const std::string_view word = next_word(line);
      if (word.empty()) fail("expected the number of corners of a face, then its corners, one face a line");
      const auto corner = parse_integer<std::int64_t>(word);
      if (!corner) fail(quote(word) + " is not a point's number");
      add_corner(*corner);
    }
    soup_.ends.push_back(soup_.corners.size());
    soup_.lines.push_back(lines_.number());
    if (colors_ || (line = trim(line)).empty()) return;
    trailing(line, 0);
    color_of_face();
  }

  void add_corner(std::int64_t corner) {
    if (corner < 0 || static_cast<std::uint64_t>(corner) >= points_)
      file_.fail(binary_ ? 0 : lines_.number(),
                 "face " + std::to_string(soup_.ends.size()) + " refers to point " + std::to_string(corner) +
                     " (both counted from 0), but there are only " + std::to_string(points_));
    soup_.corners.push_back(static_cast<std::uint64_t>(corner));
  }

  /// `trailing_` holds three or four numbers, or one that stands for a row of a colour table elsewhere.
  void color_of_face() {
    if (trailing_.size() != 3 && trailing_.size() != 4) {
      if (!warned_faces_)
        warnings_.add(binary_ ? 0 : lines_.number(), std::to_string(trailing_.size()) +
                                                         " numbers after a face's corners are no colour: "
                                                         "skipped, here and wherever else");
      warned_faces_ = true;
      return;
    }
    Channel<std::array<float, 4>>& colors = soup_.colors;
    const std::size_t begin = soup_.ends.size() > 1 ? soup_.ends[soup_.ends.size() - 2] : 0;
    colors.of_corner.resize(begin, kNone);
    colors.of_corner.resize(soup_.corners.size(), static_cast<Index>(colors.rows.size()));
    colors.rows.push_back(
        {trailing_[0], trailing_[1], trailing_[2], trailing_.size() == 4 ? trailing_[3] : kNoAlpha});
  }

  /// Colours are written as 0 to 255, or as 0 to 1; the whole file tells which.
  void finish_colors() {
    Channel<std::array<float, 4>>& colors = soup_.colors;
    if (!colors.of_corner.empty()) colors.of_corner.resize(soup_.corners.size(), kNone);
    float most = 0;
    for (const auto& color : colors.rows)
      for (const float x : color) most = std::max(most, x);
    const float scale = !fractions_ && most > 1 ? 255 : 1;
    for (auto& color : colors.rows) {
      if (color[3] == kNoAlpha) color[3] = std::isnan(color[0]) ? kNoValue : scale;
      for (float& x : color) x /= scale;
    }
  }

  template <class T>
  T take() {
    static_assert(sizeof(T) == 4);
    if (rest_.size() < sizeof(T)) cut_short();
    std::uint32_t word = 0;
    std::memcpy(&word, rest_.data(), sizeof word);
    rest_.remove_prefix(sizeof word);
    word = __builtin_bswap32(word);  // the file is big-endian
    T value{};
    std::memcpy(&value, &word, sizeof value);
    return value;
  }

  void binary_body() {
    rest_ = lines_.rest();
    points_ = take<std::uint32_t>();
    faces_ = take<std::uint32_t>();
    take<std::uint32_t>();  // edges
    const std::size_t extras = (normals_ ? 3u : 0u) + (colors_ ? 4u : 0u) + (texcoords_ ? 2u : 0u);
    fractions_ = true;
    for (std::uint64_t i = 0; i < points_; ++i) {
      Point point{};
      for (double& x : point) x = static_cast<double>(take<float>());
      if (homogeneous_) {
        const double w = static_cast<double>(take<float>());
        for (double& x : point) x /= w;
      }
      soup_.points.push_back(point);
      trailing_.clear();
      for (std::size_t k = 0; k < extras; ++k) trailing_.push_back(take<float>());
      if (extras > 0) values_of_point();
    }
    for (std::uint64_t i = 0; i < faces_; ++i) {
      const auto count = take<std::uint32_t>();
      if (count > rest_.size() / 4) cut_short();
      for (std::uint32_t k = 0; k < count; ++k) add_corner(take<std::int32_t>());
      soup_.ends.push_back(soup_.corners.size());
      const auto numbers = take<std::uint32_t>();
      if (numbers > rest_.size() / 4) cut_short();
      trailing_.clear();
      for (std::uint32_t k = 0; k < numbers; ++k) trailing_.push_back(take<float>());
      if (!colors_ && numbers > 0) color_of_face();
    }
  }

  static constexpr float kNoAlpha = -1;
  const SourceFile& file_;
  PlainLines lines_;
  std::string_view rest_;  ///< of a binary file
  Warnings warnings_;
  PolygonSoup soup_;
  bool texcoords_ = false, colors_ = false, normals_ = false, homogeneous_ = false, binary_ = false;
  std::uint64_t points_ = 0, faces_ = 0;
  std::vector<float> trailing_;
  bool fractions_ = false;  ///< some colour has a decimal point
  bool warned_ = false, warned_faces_ = false;
};

}  // namespace

PolygonSoup read_off(const SourceFile& file) {
  return OffReader(file).read();
}

}  // namespace tetprep
