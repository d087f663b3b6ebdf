// SPDX-License-Identifier: MIT
// Bad data is a value, not an exception: every function that reads bytes returns Result<T>.
#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <variant>

namespace tetfmt {

/// How much of a file is examined; each level includes the ones before it.
enum class Level : std::uint8_t {
  structure,  ///< header, table of contents, lengths, padding: O(sections)
  checksum,   ///< every stored byte against its hash
  topology,   ///< every tetrahedron, reference and side
  geometry,   ///< exact orientation, convexity, covering: the file is what it claims to be
};
inline constexpr int kLevelCount = 4;
const char* level_name(Level level);

/// Stable numbers, listed in issues.def and explained in spec/issues.md.
enum class Code : std::uint16_t {
#define TETFMT_ISSUE(number, name, level, meaning) name = number,
#include "tetfmt/issues.def"
#undef TETFMT_ISSUE
};

/// The table behind issues.def. `name` is the code's snake_case name.
const char* code_name(Code code);
const char* code_meaning(Code code);
Level code_level(Code code);

/// One problem: what (code), where, and a sentence with the values found.
struct Error {
  Code code{};
  std::uint64_t where = 0;  ///< byte offset (2xxx) or element index (4xxx to 6xxx)
  std::string text;
};

/// "code name at where: text", on one line.
std::string to_string(const Error& error);

/// A value or the reason why there is none. `value()` on an error is a broken contract (assertion).
template <class T>
class [[nodiscard]] Result {
 public:
  Result(T value) : state_(std::in_place_index<0>, std::move(value)) {}
  Result(Error error) : state_(std::in_place_index<1>, std::move(error)) {}

  explicit operator bool() const { return state_.index() == 0; }
  T& value() & { return std::get<0>(state_); }
  const T& value() const& { return std::get<0>(state_); }
  T&& value() && { return std::get<0>(std::move(state_)); }
  T& operator*() & { return value(); }
  const T& operator*() const& { return value(); }
  T* operator->() { return &value(); }
  const T* operator->() const { return &value(); }
  const Error& error() const { return std::get<1>(state_); }

 private:
  std::variant<T, Error> state_;
};

}  // namespace tetfmt
