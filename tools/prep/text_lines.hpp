// SPDX-License-Identifier: AGPL-3.0-or-later
// Lines and words of mesh files that are text.
#pragma once

#include <charconv>
#include <cstddef>
#include <optional>
#include <string>
#include <string_view>

#include "common/parse.hpp"

namespace tetprep {

/// Takes the next blank-separated word off the front; empty at the end.
inline std::string_view next_word(std::string_view& text) {
  const auto blank = [](char c) { return c == ' ' || (c >= '\t' && c <= '\r'); };
  std::size_t begin = 0, end = 0;
  while (begin < text.size() && blank(text[begin])) ++begin;
  for (end = begin; end < text.size() && !blank(text[end]);) ++end;
  const std::string_view word = text.substr(begin, end - begin);
  text.remove_prefix(end);
  return word;
}

/// The whole of `word` as a whole number.
template <class T>
std::optional<T> parse_integer(std::string_view word) {
  T value{};
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (error != std::errc{} || end != word.data() + word.size()) return std::nullopt;
  return value;
}

/// Lines that are not blank, without what follows a '#'.
class PlainLines {
 public:
  /// `comments`: whether '#' starts one.
  explicit PlainLines(std::string_view text, bool comments = true) : rest_(text), comments_(comments) {}

  bool next(std::string_view& line) {
    while (!rest_.empty()) {
      const auto end = rest_.find('\n');
      line = rest_.substr(0, end);
      rest_.remove_prefix(end == std::string_view::npos ? rest_.size() : end + 1);
      ++number_;
      if (comments_) line = line.substr(0, line.find('#'));
      line = trim(line);
      if (!line.empty()) return true;
    }
    line = {};
    return false;
  }

  std::size_t number() const { return number_; }  ///< of the line that next() gave, from 1
  std::string_view rest() const { return rest_; }

 private:
  std::string_view rest_;
  std::size_t number_ = 0;
  bool comments_;
};

/// Lines of OBJ and MTL files: a backslash at the end continues a line.
class LogicalLines {
 public:
  explicit LogicalLines(std::string_view text) : rest_(text) {}

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

  std::size_t number() const { return number_; }  ///< of the first line of what next() gave, from 1

 private:
  static bool continued(std::string_view line) {
    const auto first = line.find_first_not_of(" \t\r"), last = line.find_last_not_of(" \t\r");
    if (first != std::string_view::npos && line[first] == '#') return false;  // a comment ends with its line
    return last != std::string_view::npos && line[last] == '\\';
  }
  std::string_view take() {
    const auto end = rest_.find('\n');
    const std::string_view line = rest_.substr(0, end);
    rest_.remove_prefix(end == std::string_view::npos ? rest_.size() : end + 1);
    ++pending_;
    return line;
  }

  std::string_view rest_;
  std::string joined_;
  std::size_t number_ = 1;
  std::size_t pending_ = 0;  ///< physical lines in what next() gave
};

}  // namespace tetprep
