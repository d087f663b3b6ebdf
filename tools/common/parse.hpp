// SPDX-License-Identifier: AGPL-3.0-or-later
// Text to numbers and back, strictly and without a locale.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace tetprep {

/// The whole of `text` as a number (blanks around it allowed, a leading + too); "inf" and "nan" are numbers
/// here.
std::optional<double> parse_double(std::string_view text);

/// The whole of `text` as decimal digits, nothing around them, below 2^64.
std::optional<std::uint64_t> parse_whole(std::string_view text);

/// "X,Y,Z", all finite.
std::optional<std::array<double, 3>> parse_vector(std::string_view text);

/// "WxH", both at least 1.
std::optional<std::array<int, 2>> parse_size(std::string_view text);

/// `text` without blanks, tabs and carriage returns at both ends.
std::string_view trim(std::string_view text);

/// Appends the shortest text that reads back as the same number.
void append_number(std::string& text, double value);
void append_number(std::string& text, float value);
void append_number(std::string& text, long long value);

/// The shortest text that reads back as the same number.
std::string number(double value);

}  // namespace tetprep
