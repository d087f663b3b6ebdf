// SPDX-License-Identifier: AGPL-3.0-or-later
#include "common/npy.hpp"

#include <algorithm>
#include <charconv>
#include <cstring>

#include "common/failure.hpp"

namespace tetprep {
namespace {

constexpr std::string_view kMagic = "\x93NUMPY";

/// The header is the source of a Python dictionary with the keys descr, fortran_order and shape. Only what
/// NumPy itself writes is understood. No recursion: brackets of a structured dtype are counted.
class HeaderParser {
 public:
  HeaderParser(const std::string& path, std::string_view text) : path_(path), text_(text) {}

  NpyHeader parse() {
    NpyHeader header;
    bool descr = false, order = false, shape = false;
    expect('{');
    while (!accept('}')) {
      const std::string key = quoted();
      expect(':');
      if (key == "descr" && !descr) {
        header.descr = dtype();
        descr = true;
      } else if (key == "fortran_order" && !order) {
        header.fortran_order = boolean();
        order = true;
      } else if (key == "shape" && !shape) {
        header.shape = tuple();
        shape = true;
      } else {
        fail("key '" + key + "' is unknown or repeated");
      }
      if (!accept(',')) {
        expect('}');
        break;
      }
    }
    if (!descr || !order || !shape) fail("descr, fortran_order or shape is missing");
    return header;
  }

 private:
  [[noreturn]] void fail(const std::string& what) const {
    throw Failure(ExitCode::invalid, path_ + ": malformed .npy header: " + what + "; write it by numpy.save");
  }
  void skip_blanks() {
    while (!text_.empty() && (text_[0] == ' ' || text_[0] == '\n')) text_.remove_prefix(1);
  }
  bool accept(char c) {
    skip_blanks();
    if (text_.empty() || text_[0] != c) return false;
    text_.remove_prefix(1);
    return true;
  }
  void expect(char c) {
    if (!accept(c)) fail(std::string("expected '") + c + "'");
  }
  std::string quoted() {
    skip_blanks();
    if (text_.empty() || (text_[0] != '\'' && text_[0] != '"')) fail("expected a string");
    const auto end = text_.find(text_[0], 1);
    if (end == std::string_view::npos) fail("a string does not end");
    std::string value(text_.substr(1, end - 1));
    text_.remove_prefix(end + 1);
    return value;
  }
  std::string dtype() {
    skip_blanks();
    if (text_.empty() || text_[0] != '[') return quoted();
    std::size_t depth = 0, end = 0;
    do {
      if (end == text_.size()) fail("the dtype does not end");
      depth += text_[end] == '[' || text_[end] == '(';
      depth -= text_[end] == ']' || text_[end] == ')';
    } while (++end, depth > 0);
    std::string value(text_.substr(0, end));
    text_.remove_prefix(end);
    return value;
  }
  bool boolean() {
    skip_blanks();
    for (const bool value : {false, true}) {
      const std::string_view word = value ? "True" : "False";
      if (!text_.starts_with(word)) continue;
      text_.remove_prefix(word.size());
      return value;
    }
    fail("fortran_order is neither True nor False");
  }
  std::vector<std::uint64_t> tuple() {
    std::vector<std::uint64_t> values;
    expect('(');
    while (!accept(')')) {
      skip_blanks();
      std::uint64_t value = 0;
      const auto [end, error] = std::from_chars(text_.data(), text_.data() + text_.size(), value);
      if (error != std::errc{}) fail("a number of the shape is no whole number below 2^64");
      text_.remove_prefix(static_cast<std::size_t>(end - text_.data()));
      values.push_back(value);
      if (!accept(',')) {
        expect(')');
        break;
      }
    }
    return values;
  }

  const std::string& path_;
  std::string_view text_;
};

std::string shape_text(const std::vector<std::uint64_t>& shape) {
  std::string text = "(";
  for (std::size_t i = 0; i < shape.size() && i < 8; ++i)
    text += (i > 0 ? ", " : "") + std::to_string(shape[i]);
  return text + (shape.size() == 1 ? ",)" : shape.size() > 8 ? ", ...)" : ")");
}

}  // namespace

NpyHeader parse_npy_header(const std::string& path, std::span<const std::byte> bytes) {
  const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  if (!text.starts_with(kMagic)) {
    throw Failure(ExitCode::invalid, path + ": not a .npy file (no NUMPY magic); write it by numpy.save");
  }
  const auto byte = [&](std::size_t i) { return std::to_integer<std::uint32_t>(bytes[i]); };
  const auto cut = [&] {
    return Failure(ExitCode::invalid, path + ": cut inside the .npy header; copy it again");
  };
  if (bytes.size() < 10) throw cut();
  const std::uint32_t major = byte(6);
  if (major < 1 || major > 3) {
    throw Failure(ExitCode::unsupported, path + ": .npy version " + std::to_string(major) + "." +
                                             std::to_string(byte(7)) + "; versions 1.0 to 3.0 are known");
  }
  const std::size_t begin = major == 1 ? 10 : 12;
  if (bytes.size() < begin) throw cut();
  std::size_t length = byte(8) | byte(9) << 8;
  if (major > 1) length |= byte(10) << 16 | byte(11) << 24;
  if (length > bytes.size() - begin) throw cut();
  NpyHeader header = HeaderParser(path, text.substr(begin, length)).parse();
  header.data_offset = begin + length;
  return header;
}

NpyMatrix::NpyMatrix(const std::string& path, std::span<const std::byte> bytes,
                     std::span<const std::size_t> columns) {
  const NpyHeader header = parse_npy_header(path, bytes);
  wide_ = header.descr == "<f8";
  fortran_ = header.fortran_order;
  const bool fits =
      header.shape.size() == 2 && std::find(columns.begin(), columns.end(), header.shape[1]) != columns.end();
  if ((!wide_ && header.descr != "<f4") || !fits) {
    std::string shapes;
    for (const std::size_t count : columns)
      shapes += (shapes.empty() ? "(n, " : " or (n, ") + std::to_string(count) + ")";
    throw Failure(ExitCode::invalid, path + ": found dtype " + header.descr.substr(0, 80) + " of shape " +
                                         shape_text(header.shape) +
                                         ", expected <f4 (float32) or <f8 of shape " + shapes +
                                         "; convert by numpy.astype and reshape");
  }
  columns_ = header.shape[1];
  const std::uint64_t row_bytes = columns_ * (wide_ ? 8 : 4);
  const std::uint64_t held = bytes.size() - header.data_offset;
  if (header.shape[0] > held / row_bytes || header.shape[0] * row_bytes != held) {
    throw Failure(ExitCode::invalid, path + ": the header says " + std::to_string(header.shape[0]) +
                                         " rows of " + std::to_string(row_bytes) + " bytes, but " +
                                         std::to_string(held) +
                                         " bytes follow; the file was cut or extended, write it again");
  }
  rows_ = header.shape[0];
  data_ = bytes.data() + header.data_offset;
}

double NpyMatrix::at(std::size_t row, std::size_t column) const {
  const std::size_t element = fortran_ ? column * rows_ + row : row * columns_ + column;
  if (wide_) {
    double value = 0;
    std::memcpy(&value, data_ + element * sizeof value, sizeof value);  // headers need not align the data
    return value;
  }
  float value = 0;
  std::memcpy(&value, data_ + element * sizeof value, sizeof value);
  return static_cast<double>(value);
}

std::string npy_header(std::string_view descr, std::uint64_t rows, std::size_t size) {
  std::string dictionary = "{'descr': " + std::string(descr) + ", 'fortran_order': False, 'shape': (" +
                           std::to_string(rows) + ",), }";
  constexpr std::size_t kPrefix = 10;
  dictionary.append(63 - (kPrefix + dictionary.size()) % 64, ' ');
  if (kPrefix + dictionary.size() + 1 < size) dictionary.append(size - kPrefix - dictionary.size() - 1, ' ');
  dictionary += '\n';
  std::string header(kMagic);
  header += {1, 0, static_cast<char>(dictionary.size() & 0xFF), static_cast<char>(dictionary.size() >> 8)};
  return header + dictionary;
}

}  // namespace tetprep
