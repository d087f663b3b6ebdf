// SPDX-License-Identifier: AGPL-3.0-or-later
#include "prep/closure.hpp"

#include <algorithm>
#include <utility>

namespace tetprep {
namespace {

/// What is left of a gain counts only above this share of it: the rest is rounding.
constexpr double kRounding = 1e-9;
constexpr int kReverse = 3;  ///< slot that marks a step from a required item to one that requires it

}  // namespace

double Closure::solve() {
  for (Item& item : items_) item.taken = false;
  if (!some_gain_) return 0;
  const int count = static_cast<int>(items_.size());
  search_ = 0;
  for (Item& item : items_) {
    item.left = item.worth;
    item.last_requirer = -1;
    item.seen = 0;
  }
  for (int i = 0; i < count; ++i) {
    Item& item = items_[i];
    for (std::size_t k = 0; k < item.required_count; ++k) {
      Item& required = items_[item.required[k]];
      item.next_requirer[k] = required.last_requirer;
      required.last_requirer = 4 * i + static_cast<int>(k);
    }
  }
  // Gains pay for the costs that they depend on, along paths, until nobody can pay any more.
  for (int i = 0; i < count; ++i) {
    if (items_[i].worth <= 0) continue;
    while (items_[i].left > kRounding * items_[i].worth) {
      const int unpaid = find_unpaid(i);
      if (unpaid < 0) break;
      pay(i, unpaid);
    }
  }
  // Whoever has something left is in, with all that it depends on, and with those who paid for that.
  double worth = 0;
  queue_.clear();
  for (int i = 0; i < count; ++i) {
    Item& item = items_[i];
    if (item.worth <= 0 || item.left <= kRounding * item.worth) continue;
    worth += item.left;
    item.taken = true;
    queue_.push_back(i);
  }
  for (std::size_t q = 0; q < queue_.size(); ++q) {
    const Item& item = items_[queue_[q]];
    const auto take = [&](int other) {
      if (std::exchange(items_[other].taken, true)) return;
      queue_.push_back(other);
    };
    for (std::size_t k = 0; k < item.required_count; ++k) take(item.required[k]);
    for (int link = item.last_requirer; link >= 0; link = items_[link / 4].next_requirer[link % 4])
      if (items_[link / 4].paid[link % 4] > 0) take(link / 4);
  }
  return worth;
}

/// The nearest item with a cost that nobody has paid, on a way along which what `start` has left can go.
int Closure::find_unpaid(int start) {
  ++search_;
  queue_.assign(1, start);
  items_[start].seen = search_;
  for (std::size_t q = 0; q < queue_.size(); ++q) {
    const int at = queue_[q];
    for (std::size_t k = 0; k < items_[at].required_count; ++k) {
      const int to = items_[at].required[k];
      if (std::exchange(items_[to].seen, search_) == search_) continue;
      items_[to].came_from = 4 * at + static_cast<int>(k);
      if (items_[to].worth < 0 && items_[to].left < 0) return to;
      queue_.push_back(to);
    }
    for (int link = items_[at].last_requirer; link >= 0; link = items_[link / 4].next_requirer[link % 4]) {
      const int to = link / 4;
      if (items_[to].paid[link % 4] <= 0 || std::exchange(items_[to].seen, search_) == search_) continue;
      items_[to].came_from = 4 * at + kReverse;
      items_[to].reverse_slot = static_cast<std::size_t>(link % 4);
      if (items_[to].worth < 0 && items_[to].left < 0) return to;
      queue_.push_back(to);
    }
  }
  return -1;
}

/// Along the way that find_unpaid() came.
void Closure::pay(int start, int end) {
  double amount = std::min(items_[start].left, -items_[end].left);
  for (int at = end; at != start; at = items_[at].came_from / 4)
    if (items_[at].came_from % 4 == kReverse)
      amount = std::min(amount, items_[at].paid[items_[at].reverse_slot]);
  for (int at = end; at != start; at = items_[at].came_from / 4) {
    const int from = items_[at].came_from / 4, slot = items_[at].came_from % 4;
    if (slot == kReverse) {
      items_[at].paid[items_[at].reverse_slot] -= amount;
    } else {
      items_[from].paid[slot] += amount;
    }
  }
  items_[start].left -= amount;
  items_[end].left += amount;
}

}  // namespace tetprep
