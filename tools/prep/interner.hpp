// SPDX-License-Identifier: AGPL-3.0-or-later
// Numbers for distinct byte strings of one length.
#pragma once

#include <cstddef>
#include <cstring>
#include <functional>
#include <string_view>
#include <vector>

#include "tetfmt/types.hpp"

namespace tetprep {

/// Numbers keys from 0 in the order in which they are first met. Equal means equal bit by bit: 0 and -0
/// differ.
class Interner {
 public:
  /// `key_bytes`: of every key, at least 1.
  explicit Interner(std::size_t key_bytes) : key_bytes_(key_bytes), table_(64, tetfmt::kNone) {}

  /// O(1) on average.
  tetfmt::Index add(const char* key) {
    if (2 * (count_ + 1) > table_.size()) grow();
    std::size_t slot = hash(key) & (table_.size() - 1);
    for (; table_[slot] != tetfmt::kNone; slot = (slot + 1) & (table_.size() - 1))
      if (std::memcmp(this->key(table_[slot]), key, key_bytes_) == 0) return table_[slot];
    table_[slot] = static_cast<tetfmt::Index>(count_);
    keys_.insert(keys_.end(), key, key + key_bytes_);
    return static_cast<tetfmt::Index>(count_++);
  }

  std::size_t size() const { return count_; }
  const char* key(std::size_t number) const { return keys_.data() + number * key_bytes_; }

 private:
  std::size_t hash(const char* key) const {
    return std::hash<std::string_view>()(std::string_view(key, key_bytes_));
  }
  void grow() {
    table_.assign(2 * table_.size(), tetfmt::kNone);
    for (std::size_t i = 0; i < count_; ++i) {
      std::size_t slot = hash(key(i)) & (table_.size() - 1);
      while (table_[slot] != tetfmt::kNone) slot = (slot + 1) & (table_.size() - 1);
      table_[slot] = static_cast<tetfmt::Index>(i);
    }
  }

  std::size_t key_bytes_, count_ = 0;
  std::vector<tetfmt::Index> table_;  ///< open addressing, at most half full
  std::vector<char> keys_;
};

}  // namespace tetprep
