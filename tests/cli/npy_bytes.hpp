// SPDX-License-Identifier: AGPL-3.0-or-later
// .npy files as NumPy writes them, and as it never would.
#pragma once

#include <array>
#include <cstring>
#include <string>
#include <vector>

namespace tetfmt_test {

/// Magic, version and length around any header text, padded as NumPy does.
inline std::string npy_with_header(std::string header, int version = 1) {
  const std::size_t prefix = version == 1 ? 10 : 12;
  header.append(63 - (prefix + header.size()) % 64, ' ');
  header += '\n';
  std::string bytes = "\x93NUMPY";
  bytes += {static_cast<char>(version), '\0', static_cast<char>(header.size() & 0xFF),
            static_cast<char>(header.size() >> 8)};
  if (version > 1) bytes += {'\0', '\0'};
  return bytes + header;
}

struct NpyForm {
  int version = 1;
  bool fortran = false;
};

/// An (n, kColumns) array of T.
template <class T, std::size_t kColumns = 6>
std::string npy_bytes(const std::vector<std::array<double, kColumns>>& rows, NpyForm form = {}) {
  std::string bytes =
      npy_with_header("{'descr': '<f" + std::to_string(sizeof(T)) +
                          "', 'fortran_order': " + (form.fortran ? "True" : "False") + ", 'shape': (" +
                          std::to_string(rows.size()) + ", " + std::to_string(kColumns) + "), }",
                      form.version);
  const auto put = [&bytes](double value) {
    const T narrow = static_cast<T>(value);
    std::array<char, sizeof(T)> raw;
    std::memcpy(raw.data(), &narrow, sizeof narrow);
    bytes.append(raw.data(), raw.size());
  };
  if (form.fortran) {
    for (std::size_t i = 0; i < kColumns; ++i) {
      for (const auto& row : rows) put(row[i]);
    }
  } else {
    for (const auto& row : rows) {
      for (const double value : row) put(value);
    }
  }
  return bytes;
}

}  // namespace tetfmt_test
