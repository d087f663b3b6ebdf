// SPDX-License-Identifier: AGPL-3.0-or-later
// A shear in whole numbers, there and back: turns a lattice, where everything is aligned with the axes, into
// one where nothing is.
#pragma once

#include <array>
#include <cstdint>

#include "tetfmt/mesh.hpp"

namespace tetfmt_test {

using Matrix = std::array<std::array<int, 3>, 3>;
inline constexpr Matrix kShear = {{{1, 2, 0}, {0, 1, -1}, {1, 2, 1}}};  // determinant 1
inline constexpr Matrix kInverse = {{{3, -2, -2}, {-1, 1, 1}, {-1, 0, 1}}};

using Fixed = std::array<std::int64_t, 3>;

template <class T>
std::array<T, 3> times(const Matrix& m, const std::array<T, 3>& p) {
  std::array<T, 3> q{};
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t k = 0; k < 3; ++k) q[i] += static_cast<T>(m[i][k]) * p[k];
  return q;
}

/// The mesh with every vertex sheared. Whole coordinates of up to 2^20 stay exact.
inline tetfmt::Mesh sheared(tetfmt::Mesh mesh) {
  for (tetfmt::Vec3f& v : mesh.vertices) {
    const auto q = times(kShear, std::array<float, 3>{v.x, v.y, v.z});
    v = {q[0], q[1], q[2]};
  }
  return mesh;
}

}  // namespace tetfmt_test
