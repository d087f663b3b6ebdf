// SPDX-License-Identifier: AGPL-3.0-or-later
// Rays from a file: .npy in place, CSV parsed.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "common/npy.hpp"
#include "tetfmt/mapped_file.hpp"
#include "tetfmt/traverse.hpp"

namespace tetprep {

/// A ray as it was given. Every number is finite, but t_max may be infinity.
struct GivenRay {
  std::array<double, 3> origin{}, direction{};
  tetfmt::Interval interval;
};

/// Rows of six numbers: origin x, y, z and direction x, y, z; or of eight, with t_min and t_max.
class RayFile {
 public:
  /// `path` ends in .npy or .csv, or is "-": CSV on standard input. Throws Failure with file and line or row:
  /// usage for another ending, io, or invalid.
  explicit RayFile(const std::string& path);

  std::size_t size() const { return matrix_ ? matrix_->rows() : rows_.size(); }
  GivenRay operator[](std::size_t ray) const;
  /// Where a ray stands, for messages: "rays.npy: ray 17" or "rays.csv:19".
  std::string place(std::size_t ray) const;

 private:
  void parse_csv(std::string_view text);
  void check_matrix() const;

  std::string name_;
  std::optional<tetfmt::MappedFile> file_;
  std::optional<NpyMatrix> matrix_;  ///< of a .npy file
  std::vector<GivenRay> rows_;       ///< of a CSV file
  std::vector<std::size_t> lines_;
};

/// "npy" or "csv" by the name's ending, whatever its case; "csv" for "-". Throws Failure (usage) for others;
/// `option` is named in the message.
std::string table_format(const std::string& path, const char* option);

}  // namespace tetprep
