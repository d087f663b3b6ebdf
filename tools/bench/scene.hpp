// SPDX-License-Identifier: AGPL-3.0-or-later
// One tet file, made ready to be tested: in both layouts, in full, and as its exact surface.
#pragma once

#include <cstddef>
#include <memory>
#include <string>
#include <vector>

#include "bench/truth/exact_reference.hpp"
#include "tetfmt/mapped_file.hpp"
#include "tetfmt/mesh.hpp"
#include "tetfmt/validate.hpp"

namespace tetbench {

class Scene {
 public:
  /// Validates the file at Level::geometry. Throws Failure: io, invalid; unsupported for a file that leaves
  /// space out, or has no surface.
  explicit Scene(const std::string& path);

  /// Throws what the constructor would, without keeping anything: for files whose turn comes after long work.
  static void check(const std::string& path);

  const std::string& path() const { return path_; }
  /// 0: as it is in the file; 1: the same mesh in the other layout.
  const tetfmt::TrustedView& view(std::size_t which) const { return *views_[which]; }
  const tetfmt::Mesh& mesh() const { return mesh_; }
  const ExactReference& reference() const { return *reference_; }
  const Surface& surface() const { return reference_->surface(); }

 private:
  std::string path_;
  tetfmt::MappedFile file_;
  std::vector<std::byte> other_;
  std::unique_ptr<tetfmt::TrustedView> views_[2];
  tetfmt::Mesh mesh_;
  std::unique_ptr<ExactReference> reference_;
};

}  // namespace tetbench
