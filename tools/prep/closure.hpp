// SPDX-License-Identifier: AGPL-3.0-or-later
// What to take from a set of items, each of which has a worth and requires others.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

namespace tetprep {

/// Finds the closure of maximum weight (Picard 1976, "Maximal closure of a graph and applications to
/// combinatorial problems"): of all sets that hold with an item whatever it requires, one that is worth most.
/// By augmenting paths, which is fast where few items have a positive worth. Keeps its memory between uses.
class Closure {
 public:
  static constexpr std::size_t kMostRequired = 3;

  void clear() {
    items_.clear();
    some_gain_ = false;
  }
  std::size_t size() const { return items_.size(); }

  /// Adds item number size(). `required` must be smaller numbers. Below zero, `worth` is a cost.
  void add(double worth, const std::array<int, kMostRequired>& required, std::size_t required_count) {
    items_.push_back({worth, required, required_count});
    some_gain_ |= worth > 0;
  }

  /// What the best set is worth; 0 and the empty set if none is worth more.
  double solve();
  /// Whether an item is in the best set, after solve().
  bool taken(std::size_t item) const { return items_[item].taken; }

 private:
  struct Item {
    double worth;
    std::array<int, kMostRequired> required;
    std::size_t required_count;
    std::array<double, kMostRequired> paid{};  ///< of each required one's cost
    double left = 0;                           ///< of a gain: not spent yet; of a cost: not paid yet, below 0
    int last_requirer = -1;                    ///< chains all (item, slot) that require this one...
    std::array<int, kMostRequired> next_requirer{};  ///< ...as 4 * item + slot
    int seen = 0;
    int came_from = -1;  ///< on a path: 4 * item + slot; slot 3 for the reverse of `reverse_slot`
    std::size_t reverse_slot = 0;
    bool taken = false;
  };

  int find_unpaid(int start);
  void pay(int start, int end);

  std::vector<Item> items_;
  std::vector<int> queue_;
  int search_ = 0;
  bool some_gain_ = false;
};

}  // namespace tetprep
