// SPDX-License-Identifier: AGPL-3.0-or-later
// The combinations of normal, texture coordinates, colour and properties that a file's corners have.
#pragma once

#include <optional>
#include <vector>

#include "prep/interner.hpp"
#include "prep/read_soup.hpp"

namespace tetprep {

/// Surface points (see Appearance) of a soup's corners, numbered as corners ask for them.
class SurfacePoints {
 public:
  /// `soup` must outlive it.
  explicit SurfacePoints(const PolygonSoup& soup);

  /// False: the file says nothing of its corners.
  bool any() const { return key_bytes_ > 0; }

  /// Of a corner that refers to an existing point; kNone: nothing is said of this one. O(1) on average.
  Index at(std::size_t corner);

  /// The values of the surface points that at() gave.
  void fill(Appearance& appearance) const;

 private:
  Index find(std::size_t corner, std::size_t point);
  template <class T>
  void append(const Channel<T>& channel, std::size_t corner, std::size_t point);

  const PolygonSoup& soup_;
  std::size_t key_bytes_ = 0;
  std::vector<const std::vector<Index>*> choices_;  ///< of_corner of those channels that do not go by points
  /// What each point was last asked for: rows of `choices_`, and the answer. Most corners at a point agree.
  std::vector<Index> last_rows_, last_;
  std::vector<bool> known_;
  std::vector<char> key_;
  bool says_something_ = false;
  std::optional<Interner> combinations_;
};

}  // namespace tetprep
