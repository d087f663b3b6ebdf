// SPDX-License-Identifier: AGPL-3.0-or-later
// NumPy's .npy files: reading matrices of floats, writing headers. Format: numpy.lib.format, versions 1.0
// to 3.0.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace tetprep {

/// What a .npy header says.
struct NpyHeader {
  std::string descr;  ///< dtype, as Python source without quotes: "<f4"; of a structured array "[('x', ...)]"
  bool fortran_order = false;
  std::vector<std::uint64_t> shape;
  std::size_t data_offset = 0;  ///< where the elements begin
};

/// Throws Failure (invalid) naming `path`. Looks at the header only: the shape may claim more than `bytes`
/// holds.
NpyHeader parse_npy_header(const std::string& path, std::span<const std::byte> bytes);

/// A matrix of little-endian float32 or float64, in place in the file's bytes, which must outlive it.
class NpyMatrix {
 public:
  /// Throws Failure (invalid), saying what was found, unless `bytes` is exactly a matrix with one of these
  /// numbers of columns. Allocates nothing that the header's shape could blow up.
  NpyMatrix(const std::string& path, std::span<const std::byte> bytes, std::span<const std::size_t> columns);

  std::size_t rows() const { return rows_; }
  std::size_t columns() const { return columns_; }
  double at(std::size_t row, std::size_t column) const;

 private:
  const std::byte* data_ = nullptr;
  std::size_t rows_ = 0, columns_ = 0;
  bool wide_ = false, fortran_ = false;
};

/// The magic, version and header of a one-dimensional array of `rows` elements, padded to 64 bytes, and to
/// `size` if that is more (and a multiple of 64). `descr` is Python source, with quotes where it needs them.
std::string npy_header(std::string_view descr, std::uint64_t rows, std::size_t size = 0);

}  // namespace tetprep
