// SPDX-License-Identifier: AGPL-3.0-or-later
// printf into a string.
#pragma once

#include <cstddef>
#include <cstdio>
#include <string>

namespace tetbench {

template <class... Values>
std::string format(const char* pattern, Values... values) {
  const int length = std::snprintf(nullptr, 0, pattern, values...);
  std::string text(length > 0 ? static_cast<std::size_t>(length) : 0, '\0');
  std::snprintf(text.data(), text.size() + 1, pattern, values...);
  return text;
}

}  // namespace tetbench
