// SPDX-License-Identifier: AGPL-3.0-or-later
// As much of NumPy's .npy format (version 1.0) as rays and hits need, written apart from the tool's own code,
// so that a mistake there is not repeated here.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "tetfmt/traverse.hpp"

namespace tetfmt_test {

/// Writes rays as a float32 array of shape (n, 6). Throws std::runtime_error.
void write_rays(const std::string& path, std::span<const tetfmt::Ray> rays);

/// A one-dimensional structured array.
class NpyTable {
 public:
  /// Throws std::runtime_error for anything that is not a little-endian structured array of numbers.
  static NpyTable read(const std::string& path);

  std::size_t size() const { return size_; }
  /// The field's value as a double: exact for float64 and for integers up to 2^53. Throws if there is none.
  std::vector<double> column(const std::string& name) const;
  const std::vector<char>& bytes() const { return bytes_; }

 private:
  struct Field {
    std::string name;
    char kind = 0;  ///< 'f', 'i' or 'u'
    std::size_t bytes = 0, offset = 0;
  };
  std::vector<Field> fields_;
  std::size_t size_ = 0, stride_ = 0;
  std::vector<char> bytes_;
};

}  // namespace tetfmt_test
