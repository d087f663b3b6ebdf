// SPDX-License-Identifier: AGPL-3.0-or-later
// An output file that is put together from many small pieces.
#pragma once

#include <array>
#include <bit>
#include <cstdint>
#include <cstring>
#include <string>
#include <string_view>

#include "common/atomic_file.hpp"
#include "common/parse.hpp"

namespace tetprep {

static_assert(std::endian::native == std::endian::little,
              "binary formats are written as the machine holds them");

/// Collects text or bytes and writes them in large pieces to an AtomicFile, whose promises hold.
class BufferedFile {
 public:
  explicit BufferedFile(const std::string& path) : file_(path) {}
  BufferedFile& text(std::string_view text) {
    buffer_ += text;
    if (buffer_.size() >= kPiece) flush();
    return *this;
  }
  /// A number as the shortest text that reads back as the same double, float or integer.
  BufferedFile& number(double value) {
    append_number(buffer_, value);
    return *this;
  }
  BufferedFile& number(float value) {
    append_number(buffer_, value);
    return *this;
  }
  BufferedFile& number(std::uint64_t value) {
    append_number(buffer_, static_cast<long long>(value));
    return *this;
  }
  /// Little-endian.
  template <class T>
  BufferedFile& raw(const T& value) {
    std::array<char, sizeof(T)> bytes;
    std::memcpy(bytes.data(), &value, sizeof value);
    return text({bytes.data(), bytes.size()});
  }
  void commit() {
    flush();
    file_.commit();
  }

 private:
  static constexpr std::size_t kPiece = 1 << 20;
  void flush() {
    file_.write(buffer_);
    buffer_.clear();
  }
  AtomicFile file_;
  std::string buffer_;
};

}  // namespace tetprep
