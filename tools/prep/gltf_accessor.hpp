// SPDX-License-Identifier: AGPL-3.0-or-later
// The numbers behind a glTF accessor.
#pragma once

#include <array>
#include <cstddef>
#include <map>
#include <span>
#include <string>

#include "prep/gltf_document.hpp"

namespace tetprep {

/// "Accessors" of a document, each checked once. Elements are read where they lie: nothing is allocated for a
/// count that a file claims.
class GltfAccessor {
 public:
  /// `number`: in range. Failure (invalid): it reaches beyond its buffer view, or its sparse part is unsound.
  GltfAccessor(const SourceFile& file, const GltfDocument& document, int number);

  std::size_t count() const { return count_; }
  std::size_t components() const { return components_; }
  bool is_float() const;
  const std::string& name() const { return name_; }  ///< "accessors[3]"

  /// Component `k` of an element; whole numbers as fractions if `normalized` says so. Both must be in range.
  double at(std::size_t element, std::size_t k) const;
  /// The same of whole numbers, as they are.
  std::uint32_t index_at(std::size_t element) const;

 private:
  std::span<const std::byte> view(int number, std::size_t offset, std::size_t stride, std::size_t size,
                                  std::size_t count, const char* what) const;
  const std::byte* place(std::size_t element) const;

  const SourceFile& file_;
  const GltfDocument& document_;
  std::string name_;
  std::size_t count_, components_ = 0, component_bytes_ = 0, stride_ = 0;
  int type_;
  bool normalized_;
  std::span<const std::byte> bytes_;  ///< empty: all 0
  std::map<std::size_t, const std::byte*> replaced_;
};

/// The accessors of a document, made when they are first asked for.
class GltfAccessors {
 public:
  GltfAccessors(const SourceFile& file, const GltfDocument& document) : file_(file), document_(document) {}
  const GltfAccessor& get(int number) {
    const auto known = made_.find(number);
    return known != made_.end() ? known->second
                                : made_.try_emplace(number, file_, document_, number).first->second;
  }

 private:
  const SourceFile& file_;
  const GltfDocument& document_;
  std::map<int, GltfAccessor> made_;
};

}  // namespace tetprep
