// SPDX-License-Identifier: MIT
// A read-only memory mapping of a whole file.
#pragma once

#include <cstddef>
#include <span>
#include <string>

#include "tetfmt/error.hpp"

namespace tetfmt {

/// Move-only owner of a mapping. Opening costs the same for any file size: pages are read when touched.
/// A file that another process truncates while mapped raises SIGBUS on access, as with every mapping.
class MappedFile {
 public:
  /// Errors: cannot_open (with the system's reason), not_a_file. An empty file maps to zero bytes.
  static Result<MappedFile> open(const std::string& path);

  MappedFile(MappedFile&& other) noexcept;
  MappedFile& operator=(MappedFile&& other) noexcept;
  ~MappedFile();

  std::span<const std::byte> bytes() const { return bytes_; }

 private:
  MappedFile() = default;
  std::span<const std::byte> bytes_;
};

}  // namespace tetfmt
