// SPDX-License-Identifier: AGPL-3.0-or-later
#include "allocation_count.hpp"

#include <atomic>
#include <cstdlib>
#include <new>

namespace {
std::atomic<std::size_t> total{0};
}

namespace tetfmt_test {

std::size_t allocated_bytes() {
  return total;
}
void reset_allocated_bytes() {
  total = 0;
}

}  // namespace tetfmt_test

// The other forms of new and delete call these.
void* operator new(std::size_t size) {
  total += size;
  if (void* memory = std::malloc(size != 0 ? size : 1)) return memory;
  throw std::bad_alloc();
}
void operator delete(void* memory) noexcept {
  std::free(memory);
}
void operator delete(void* memory, std::size_t) noexcept {
  std::free(memory);
}
