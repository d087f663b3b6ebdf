// SPDX-License-Identifier: AGPL-3.0-or-later
// The lattice around its inner box, as it stands or sheared so that no wall is aligned with an axis, and
// where lines meet the box in exact fractions. Shearing changes no t: expectations are computed in lattice
// coordinates for both.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <stdexcept>

#include "support/scene.hpp"
#include "support/shear.hpp"

namespace tetfmt_test {

/// A number, exactly; bottom > 0. Parts below 2^31 leave comparisons in 64 bits.
struct Fraction {
  std::int64_t top = 0, bottom = 1;
  static Fraction of(std::int64_t top, std::int64_t bottom) {
    return bottom < 0 ? Fraction{-top, -bottom} : Fraction{top, bottom};
  }
  double value() const { return static_cast<double>(top) / static_cast<double>(bottom); }
  friend bool operator<(Fraction a, Fraction b) { return a.top * b.bottom < b.top * a.bottom; }
  friend bool operator==(Fraction a, Fraction b) { return a.top * b.bottom == b.top * a.bottom; }
};

/// Fixed: a point or direction in lattice coordinates, exactly: whole numbers times 2^-26.
inline constexpr std::int64_t kOne = std::int64_t{1} << 26;

inline Fixed whole(const std::array<int, 3>& p) {
  return {p[0] * kOne, p[1] * kOne, p[2] * kOne};
}

class BoxScene : public Scene {
 public:
  /// The inner box is [1, n - 1]^3. Regions 0 (around it) and 1 (in it), or only one of them.
  BoxScene(int n, bool sheared, LatticeOptions options = {}, const std::vector<tetfmt::Index>& kept = {0, 1})
      : Scene(make(n, sheared, options, kept)), low(1), high(n - 1), sheared_(sheared) {}

  const int low, high;

  /// To the scene's own coordinates. Throws unless float32 holds the result exactly.
  tetfmt::Vec3f fixed_to_scene(const Fixed& p) const {
    const Fixed q = sheared_ ? times(kShear, p) : p;
    const auto narrow = [](std::int64_t value) {
      const auto result = static_cast<float>(value);
      if (static_cast<std::int64_t>(result) != value) throw std::logic_error("fixed_to_scene: not exact");
      return std::ldexp(result, -26);
    };
    return {narrow(q[0]), narrow(q[1]), narrow(q[2])};
  }
  tetfmt::Vec3f to_scene(const std::array<int, 3>& p) const { return fixed_to_scene(whole(p)); }

  /// The same, rounded to float32: for places in general position.
  tetfmt::Vec3f near(const std::array<float, 3>& p) const {
    if (!sheared_) return {p[0], p[1], p[2]};
    const auto q = times(kShear, p);
    return {q[0], q[1], q[2]};
  }

  /// Where the location is. Fails the test unless 2^-26 divides its coordinates.
  Fixed to_lattice(const tetfmt::Location& location) const {
    Fixed p{};
    for (std::size_t i = 0; i < 3; ++i) {
      const double scaled = std::ldexp(location.position[i], 26);
      EXPECT_EQ(scaled, std::floor(scaled));
      p[i] = static_cast<std::int64_t>(scaled);
    }
    return sheared_ ? times(kInverse, p) : p;
  }

  /// The wall that a triangle lies on: 2 * axis + (1 if high).
  static std::size_t wall_of(tetfmt::Index triangle) { return triangle / 2; }

 private:
  static tetfmt::Mesh make(int n, bool sheared, const LatticeOptions& options,
                           const std::vector<tetfmt::Index>& kept) {
    tetfmt::Mesh mesh = lattice_mesh(n, options);
    return with_regions(sheared ? tetfmt_test::sheared(mesh) : mesh, kept);
  }

  const bool sheared_;
};

/// True if the double nearest to `exact` is at most four steps away.
inline bool within_four_ulp(double found, Fraction exact) {
  double low = exact.value(), high = low;
  for (int i = 0; i < 4; ++i) {
    low = std::nextafter(low, -INFINITY);
    high = std::nextafter(high, INFINITY);
  }
  return low <= found && found <= high;
}

}  // namespace tetfmt_test
