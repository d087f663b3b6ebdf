// SPDX-License-Identifier: AGPL-3.0-or-later
// Any bytes through everything that promises to survive any bytes: open, validate, reconstruct, locate,
// first_hit on a checked view. Then once more with the hashes made to match, so that mutations get past the
// checksums to the levels behind them. A file that validates is traced without checks as well, and must
// agree.
#include <array>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <span>
#include <vector>

#include "tetfmt/encode.hpp"
#include "tetfmt/reconstruct.hpp"
#include "tetfmt/traverse.hpp"
#include "tetfmt/validate.hpp"
#include "tetfmt/view.hpp"

namespace {

void require(bool condition) {
  if (!condition) std::abort();
}

/// A few rays around the file's own bounds, whatever those are, and one made of the input's last bytes.
std::vector<tetfmt::Ray> rays_for(const tetfmt::FileView& view) {
  const auto& [low, high] = view.bounds();
  std::vector<tetfmt::Ray> rays = {
      {low, {1, 1, 1}},
      {high, {-1, -1, -1}},
      {{low.x - 1, low.y, low.z}, {1, 0, 0}},
      {{low.x / 2 + high.x / 2, low.y / 2 + high.y / 2, low.z / 2 + high.z / 2}, {0.25F, -0.5F, 0.125F}},
      {{0, 0, 0}, {0, 0, 0}},
  };
  tetfmt::Ray from_bytes;
  static_assert(sizeof(from_bytes) == 24);
  const auto bytes = view.bytes();
  std::memcpy(&from_bytes, bytes.data() + bytes.size() - sizeof(from_bytes), sizeof(from_bytes));
  rays.push_back(from_bytes);
  return rays;
}

void examine(std::span<const std::byte> bytes) {
  const tetfmt::Limits limits;
  const tetfmt::Report report = tetfmt::validate(bytes, tetfmt::Level::geometry, limits);
  const auto opened = tetfmt::FileView::open(bytes, limits);
  if (!opened) {
    require(!report.valid());
    return;
  }
  const tetfmt::FileView& view = *opened;
  const auto mesh = tetfmt::reconstruct(view);
  require(static_cast<bool>(mesh) || !report.valid());

  const auto trusted = tetfmt::TrustedView::validated(bytes, tetfmt::Level::geometry, limits);
  require(static_cast<bool>(trusted) == report.valid());
  for (const tetfmt::Ray& ray : rays_for(view)) {
    const tetfmt::Location start = tetfmt::locate(view, ray.origin);
    for (const auto kernel : {tetfmt::Kernel::exact, tetfmt::Kernel::float_only}) {
      const tetfmt::Hit hit = tetfmt::first_hit(view, start, ray.direction, {}, kernel);
      require(hit.steps <= view.tet_count() + 1);
      if (!trusted) continue;
      const tetfmt::Hit same = tetfmt::first_hit(*trusted, start, ray.direction, {}, kernel);
      require(same.outcome == hit.outcome && same.triangle == hit.triangle && same.tet == hit.tet);
      if (kernel == tetfmt::Kernel::exact) require(hit.outcome != tetfmt::Outcome::corrupt);
    }
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  // A copy, because a view wants 8-byte alignment and the fuzzer's buffer promises none.
  std::vector<std::byte> bytes(size);
  if (size != 0) std::memcpy(bytes.data(), data, size);
  examine(bytes);
  tetfmt::rehash(bytes);
  examine(bytes);
  return 0;
}
