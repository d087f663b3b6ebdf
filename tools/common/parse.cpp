// SPDX-License-Identifier: AGPL-3.0-or-later
#include "common/parse.hpp"

#include <charconv>
#include <cmath>

namespace tetprep {
namespace {

template <class T>
std::optional<T> parse_all(std::string_view text) {
  T value{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc{} || end != text.data() + text.size()) return std::nullopt;
  return value;
}

template <class T>
void append_shortest(std::string& text, T value) {
  std::array<char, 64> digits{};
  const auto [end, error] = std::to_chars(digits.data(), digits.data() + digits.size(), value);
  text.append(digits.data(), end);
}

}  // namespace

std::string_view trim(std::string_view text) {
  constexpr std::string_view kBlanks = " \t\r";
  const auto first = text.find_first_not_of(kBlanks);
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(kBlanks) - first + 1);
}

std::optional<double> parse_double(std::string_view text) {
  text = trim(text);
  if (text.size() > 1 && text[0] == '+' && text[1] != '-' && text[1] != '+') text.remove_prefix(1);
  return parse_all<double>(text);
}

std::optional<std::uint64_t> parse_whole(std::string_view text) {
  return parse_all<std::uint64_t>(text);
}

std::optional<std::array<double, 3>> parse_vector(std::string_view text) {
  std::array<double, 3> vector{};
  for (std::size_t i = 0; i < 3; ++i) {
    const auto comma = text.find(',');
    if ((comma == std::string_view::npos) != (i == 2)) return std::nullopt;
    const auto value = parse_double(text.substr(0, comma));
    if (!value || !std::isfinite(*value)) return std::nullopt;
    vector[i] = *value;
    if (i < 2) text.remove_prefix(comma + 1);
  }
  return vector;
}

std::optional<std::array<int, 2>> parse_size(std::string_view text) {
  const auto cross = text.find('x');
  if (cross == std::string_view::npos) return std::nullopt;
  const auto width = parse_all<int>(text.substr(0, cross));
  const auto height = parse_all<int>(text.substr(cross + 1));
  if (!width || !height || *width < 1 || *height < 1) return std::nullopt;
  return std::array<int, 2>{*width, *height};
}

void append_number(std::string& text, double value) {
  append_shortest(text, value);
}
void append_number(std::string& text, float value) {
  append_shortest(text, value);
}
void append_number(std::string& text, long long value) {
  append_shortest(text, value);
}

std::string number(double value) {
  std::string text;
  append_number(text, value);
  return text;
}

}  // namespace tetprep
