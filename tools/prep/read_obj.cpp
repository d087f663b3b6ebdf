// SPDX-License-Identifier: AGPL-3.0-or-later
// Wavefront OBJ: vertices and faces. Everything else (normals, texture coordinates, groups, materials, lines,
// curves) is skipped.
//
// Not by tinyobjloader: its own number parser misses the nearest double for two of three 17-digit numbers,
// which would move coordinates that lie on a grid; it reads "nan", "x" and a missing coordinate as 0 without
// a word, takes 4294967297 for 1, and reports no line for an index that is out of range.
#include <algorithm>
#include <charconv>
#include <cmath>

#include "common/parse.hpp"
#include "prep/read_soup.hpp"

namespace tetprep {
namespace {

constexpr std::string_view kBlanks = " \t\r\v\f";

/// Takes the next blank-separated word off the front; empty at the end.
std::string_view next_word(std::string_view& text) {
  const auto first = text.find_first_not_of(kBlanks);
  if (first == std::string_view::npos) return text = {};
  text.remove_prefix(first);
  const std::string_view word = text.substr(0, text.find_first_of(kBlanks));
  text.remove_prefix(word.size());
  return word;
}

/// Logical lines: a backslash at the end continues a line.
class Lines {
 public:
  explicit Lines(std::string_view text) : rest_(text) {}

  bool next(std::string_view& line) {
    if (rest_.empty()) return false;
    number_ += pending_;
    pending_ = 0;
    line = take();
    if (!continued(line)) return true;
    joined_.clear();
    while (continued(line)) {
      joined_ += trim(line);
      joined_.back() = ' ';
      if (rest_.empty())
        line = {};
      else
        line = take();
    }
    joined_ += line;
    line = joined_;
    return true;
  }

  std::size_t number() const { return number_; }

 private:
  static bool continued(std::string_view line) {
    line = trim(line);
    return !line.empty() && line.back() == '\\';
  }
  std::string_view take() {
    const auto end = rest_.find('\n');
    const std::string_view line = rest_.substr(0, end);
    rest_.remove_prefix(std::min(rest_.size(), line.size() + 1));
    ++pending_;
    return line;
  }

  std::string_view rest_;
  std::string joined_;
  std::size_t number_ = 1;   ///< of the line that next() gave
  std::size_t pending_ = 0;  ///< physical lines in it
};

}  // namespace

PolygonSoup read_obj(const SourceFile& file) {
  PolygonSoup soup;
  Lines lines(file.text);
  std::string_view line;
  while (lines.next(line)) {
    line = line.substr(0, line.find('#'));
    const std::string_view keyword = next_word(line);
    if (keyword == "v") {
      Point point{};
      for (double& coordinate : point) {
        const std::string_view word = next_word(line);
        if (word.empty()) file.fail(lines.number(), "a vertex needs three coordinates");
        const auto value = parse_double(word);
        if (!value) file.fail(lines.number(), quoted(word) + " is not a coordinate");
        coordinate = *value;
      }
      soup.points.push_back(point);
      soup.point_lines.push_back(lines.number());
    } else if (keyword == "f" || keyword == "fo") {
      for (std::string_view word; !(word = next_word(line)).empty();) {
        const std::string_view digits = word.substr(0, word.find('/'));
        std::int64_t index = 0;
        const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), index);
        if (error != std::errc{} || end != digits.data() + digits.size())
          file.fail(lines.number(), quoted(word) + " is not a face corner");
        const auto known = static_cast<std::int64_t>(soup.points.size());
        if (index == 0) file.fail(lines.number(), "vertex index 0: OBJ counts from 1");
        if (index < -known)
          file.fail(lines.number(), "vertex index " + std::to_string(index) + ", but only " +
                                        std::to_string(known) + " vertices precede this line");
        // A positive index may refer to a vertex further down: triangulate() checks it at the end.
        soup.corners.push_back(static_cast<std::uint64_t>(index > 0 ? index - 1 : known + index));
      }
      soup.ends.push_back(soup.corners.size());
      soup.lines.push_back(lines.number());
    }
  }
  return soup;
}

}  // namespace tetprep
