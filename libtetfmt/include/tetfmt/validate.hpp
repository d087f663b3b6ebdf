// SPDX-License-Identifier: MIT
// Proof that a file is what it claims to be, and the only way to a TrustedView.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "tetfmt/error.hpp"
#include "tetfmt/view.hpp"

namespace tetfmt {

/// All problems of one code: how many, and the first few.
struct IssueGroup {
  std::uint64_t count = 0;
  std::vector<Error> examples;  ///< at most Report::kExamples, in the order in which they were found
};

/// The outcome of a validation. Empty when all is well.
struct Report {
  static constexpr std::size_t kExamples = 8;
  Level level = Level::structure;     ///< the level that was reached; deeper ones need sound shallower ones
  std::map<Code, IssueGroup> issues;  ///< ascending by code; the counts are complete, the examples are not
  bool valid() const { return issues.empty(); }
};

/// Examines `bytes` up to `level`. Works on any bytes, never throws for data, and allocates at most about
/// 60 bytes a tet and 8 a triangle that the bytes really hold. A broken level ends the examination: what
/// follows would stand on it. (A wrong hash does not: structure, checksum and topology problems are reported
/// together.) Levels are exact: geometry is decided by integer arithmetic, no tolerance anywhere.
Report validate(std::span<const std::byte> bytes, Level level = Level::geometry, const Limits& limits = {});

/// A view of a file that passed Level::topology or deeper: unchecked traversal is safe on it.
/// The bytes must outlive it and must not change.
class TrustedView {
 public:
  /// `bytes` must be aligned to 8 bytes, as for FileView::open. Validates at `level` (topology or geometry)
  /// and returns the first problem, if any.
  static Result<TrustedView> validated(std::span<const std::byte> bytes, Level level = Level::geometry,
                                       const Limits& limits = {});
  const FileView& view() const { return view_; }

 private:
  explicit TrustedView(const FileView& view) : view_(view) {}
  FileView view_;
};

}  // namespace tetfmt
