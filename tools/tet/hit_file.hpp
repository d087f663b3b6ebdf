// SPDX-License-Identifier: AGPL-3.0-or-later
// Hits to a file: a structured .npy array, or CSV.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>

#include "common/atomic_file.hpp"
#include "common/output.hpp"
#include "tetfmt/traverse.hpp"

namespace tetprep {

/// Takes hits in order, in pieces. A miss is triangle -1 at t = inf; a ray that starts in space that the file
/// leaves out is triangle -2 at t = nan. Nothing is at the target before commit().
class HitFile {
 public:
  /// `path` ends in .npy or .csv, or is "-": CSV on standard output. Exactly `count` hits must be written.
  /// Throws Failure: usage for another ending, io where nothing can be written.
  HitFile(const std::string& path, std::uint64_t count);

  /// The bytes of some hits. Const and without side effects: call it from any thread, and write() the results
  /// in order.
  std::string format(std::span<const tetfmt::Hit> hits) const;
  void write(std::string_view formatted);
  void commit();

 private:
  bool npy_;
  std::optional<AtomicFile> file_;  ///< empty: standard output
};

}  // namespace tetprep
