// SPDX-License-Identifier: AGPL-3.0-or-later
// Answers to rays as a table: a structured .npy array, or CSV.
#pragma once

#include <array>
#include <cstdint>
#include <cstring>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>

#include "common/atomic_file.hpp"
#include "common/parse.hpp"

namespace tetprep {

/// "<i4", "<i8" or "<f8".
struct Column {
  const char* name;
  const char* type;
};

/// Rows in the form that they are written in, apart from any file: made in any thread.
class Rows {
 public:
  explicit Rows(bool binary = false) : binary_(binary) {}

  /// Appends a row. The values' types are those of the columns: int32, int64 and double.
  template <class... Values>
  void add(Values... values) {
    (put(values), ...);
    if (!binary_) bytes_.back() = '\n';
    ++count_;
  }
  const std::string& bytes() const { return bytes_; }
  std::uint64_t count() const { return count_; }

 private:
  template <class Value>
  void put(Value value) {
    if (binary_) {
      std::array<char, sizeof(Value)> raw;
      std::memcpy(raw.data(), &value, sizeof value);  // little-endian, as tetfmt/layout.hpp asserts
      bytes_.append(raw.data(), raw.size());
      return;
    }
    if constexpr (std::is_same_v<Value, double>) {
      append_number(bytes_, value);
    } else {
      append_number(bytes_, static_cast<long long>(value));
    }
    bytes_ += ',';
  }

  bool binary_;
  std::string bytes_;
  std::uint64_t count_ = 0;
};

/// Takes rows in order, in pieces. Nothing is at the target before commit().
class AnswerFile {
 public:
  /// `path` ends in .npy or .csv, or is "-": CSV on standard output. `count`: exactly so many rows will be
  /// written; without it, any number. Throws Failure: usage for another ending, io where nothing can be
  /// written, or where an .npy header cannot be completed at the end (a pipe, without `count`).
  AnswerFile(const std::string& path, std::span<const Column> columns, std::optional<std::uint64_t> count);

  Rows rows() const { return Rows(binary_); }
  void write(const Rows& rows);
  void commit();

 private:
  void write(std::string_view bytes);

  bool binary_, counted_;
  std::string descr_;               ///< of an .npy file
  std::size_t header_size_ = 0;     ///< likewise
  std::uint64_t count_ = 0;         ///< rows written
  std::optional<AtomicFile> file_;  ///< empty: standard output
};

}  // namespace tetprep
