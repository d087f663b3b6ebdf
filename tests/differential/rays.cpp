// SPDX-License-Identifier: AGPL-3.0-or-later
#include "differential/rays.hpp"

#include <array>
#include <cmath>
#include <functional>
#include <random>
#include <stdexcept>

namespace tetfmt_test {

using tetfmt::Index;
using tetfmt::Ray;
using tetfmt::Vec3f;

namespace {

/// A point of the file's grid in grid steps: sums and differences of these are exact, unlike those of floats.
using Lattice = std::array<std::int64_t, 3>;

/// The standard library's distributions differ between implementations; these do not.
class Dice {
 public:
  explicit Dice(std::uint64_t seed) : bits_(seed) {}
  std::uint64_t below(std::uint64_t n) { return bits_() % n; }
  double unit() { return static_cast<double>(bits_() >> 11) * 0x1p-53; }
  double between(double low, double high) { return low + (high - low) * unit(); }
  /// Uniform on the unit sphere.
  std::array<double, 3> direction() {
    for (;;) {
      const std::array<double, 3> d = {between(-1, 1), between(-1, 1), between(-1, 1)};
      const double length = std::hypot(d[0], d[1], d[2]);
      if (length > 0.1 && length <= 1) return {d[0] / length, d[1] / length, d[2] / length};
    }
  }

 private:
  std::mt19937_64 bits_;
};

Vec3f rounded(const std::array<double, 3>& p) {
  return {static_cast<float>(p[0]), static_cast<float>(p[1]), static_cast<float>(p[2])};
}

class Maker {
 public:
  Maker(const tetfmt::FileView& view, std::uint64_t seed) : view_(view), dice_(seed) {
    const auto& [low, high] = view.bounds();
    low_ = {low.x, low.y, low.z};
    high_ = {high.x, high.y, high.z};
    size_ = std::hypot(high_[0] - low_[0], high_[1] - low_[1], high_[2] - low_[2]);
    for (const auto& triangle : view.triangles()) {
      if (!triangle.dropped()) triangles_.push_back(triangle.vertices);
    }
    if (triangles_.empty()) throw std::invalid_argument("make_rays: the file has no triangles");
  }

  /// From a sphere around the box, as wide as three boxes, towards a point in the box.
  Ray outside() {
    const auto d = dice_.direction();
    std::array<double, 3> from{}, towards{};
    for (std::size_t k = 0; k < 3; ++k) {
      from[k] = (low_[k] + high_[k]) / 2 + 1.5 * size_ * d[k];
      towards[k] = dice_.between(low_[k], high_[k]) - from[k];
    }
    return {rounded(from), rounded(towards)};
  }

  /// From a point in the box, in any direction, of any length between 2^-4 and 2^4.
  Ray inside() {
    std::array<double, 3> from{}, d = dice_.direction();
    const double length = std::exp2(dice_.between(-4, 4));
    for (std::size_t k = 0; k < 3; ++k) {
      from[k] = dice_.between(low_[k], high_[k]);
      d[k] *= length;
    }
    return {rounded(from), rounded(d)};
  }

  /// Along an axis, from outside, through the box at random; one coordinate or both may be a vertex's own, so
  /// that the ray meets edges and vertices of axis-aligned parts.
  Ray axis() {
    const std::size_t axis = dice_.below(3);
    const std::uint64_t aligned = dice_.below(4);
    const Vec3f& vertex = corner();
    const std::array<double, 3> at = {vertex.x, vertex.y, vertex.z};
    std::array<double, 3> from{}, d{};
    for (std::size_t k = 0; k < 3; ++k) {
      const bool exact = (aligned >> (k == (axis + 1) % 3 ? 0 : 1) & 1u) != 0;
      from[k] = exact ? at[k] : dice_.between(low_[k], high_[k]);
    }
    const bool upwards = dice_.below(2) == 0;
    from[axis] = upwards ? low_[axis] - size_ : high_[axis] + size_;
    d[axis] = upwards ? 1 : -1;
    return {rounded(from), rounded(d)};
  }

  /// From a grid point in or around the box exactly through a vertex of the surface.
  Ray at_vertex() {
    const Lattice from = near_point();
    return through(from, 1, lattice(corner()));
  }

  /// From a grid point in or around the box exactly through the midpoint of an edge.
  Ray at_edge() {
    const auto& triangle = triangles_[dice_.below(triangles_.size())];
    const std::size_t k = dice_.below(3);
    const Lattice a = lattice(view_.vertices()[triangle[k]]);
    const Lattice b = lattice(view_.vertices()[triangle[(k + 1) % 3]]);
    return through(near_point(), 2, {a[0] + b[0], a[1] + b[1], a[2] + b[2]});
  }

  /// Along the line of an edge of the surface, from before it, from its end or from inside of it.
  Ray along_edge() {
    const auto& triangle = triangles_[dice_.below(triangles_.size())];
    const std::size_t k = dice_.below(3);
    const Lattice a = lattice(view_.vertices()[triangle[k]]);
    const Lattice b = lattice(view_.vertices()[triangle[(k + 1) % 3]]);
    const auto steps = static_cast<std::int64_t>(dice_.below(4));
    Lattice from{}, d{};
    for (std::size_t i = 0; i < 3; ++i) {
      d[i] = b[i] - a[i];
      from[i] = a[i] - steps * d[i];
    }
    return {point(from), point(d)};
  }

  /// From any vertex of the file (surface, box or Steiner point) exactly through any other vertex.
  Ray between_vertices() {
    const auto vertices = view_.vertices();
    for (;;) {
      const Lattice from = lattice(vertices[dice_.below(vertices.size())]);
      const Lattice to = lattice(vertices[dice_.below(vertices.size())]);
      if (from != to) return through(from, 1, to);
    }
  }

 private:
  const Vec3f& corner() {
    return view_.vertices()[triangles_[dice_.below(triangles_.size())][dice_.below(3)]];
  }

  double step() const { return std::exp2(view_.header().grid_exponent); }

  Lattice lattice(const Vec3f& v) const {
    return {std::llround(double{v.x} / step()), std::llround(double{v.y} / step()),
            std::llround(double{v.z} / step())};
  }

  /// Up to 2^24 grid steps are a float32. A converted file spans 2^22 or so, and the differences made here at
  /// most three times as much. Where that does not hold there is no exact ray, and the caller must know.
  Vec3f point(const Lattice& p) const {
    std::array<double, 3> values{};
    for (std::size_t k = 0; k < 3; ++k) {
      values[k] = static_cast<double>(p[k]) * step();
      if (static_cast<double>(static_cast<float>(values[k])) != values[k]) {
        throw std::logic_error("make_rays: a point that float32 does not hold");
      }
    }
    return rounded(values);
  }

  /// A grid point, half of the time in the box and half within a box's size of it.
  Lattice near_point() {
    const double margin = dice_.below(2) == 0 ? 0 : 0.5;
    std::array<double, 3> p{};
    for (std::size_t k = 0; k < 3; ++k) {
      const double wide = margin * (high_[k] - low_[k]);
      p[k] = dice_.between(low_[k] - wide, high_[k] + wide) / step();
    }
    return {std::llround(p[0]), std::llround(p[1]), std::llround(p[2])};
  }

  /// The ray from `from` whose direction is `parts` times (target / parts - from).
  Ray through(const Lattice& from, std::int64_t parts, const Lattice& target) const {
    const Lattice d = {target[0] - parts * from[0], target[1] - parts * from[1], target[2] - parts * from[2]};
    if (d == Lattice{0, 0, 0}) return {point(from), {1, 0, 0}};
    return {point(from), point(d)};
  }

  const tetfmt::FileView& view_;
  Dice dice_;
  std::array<double, 3> low_{}, high_{};
  double size_ = 0;
  std::vector<std::array<Index, 3>> triangles_;
};

}  // namespace

std::vector<RayFamily> make_rays(const tetfmt::FileView& view, std::size_t count, std::uint64_t seed) {
  Maker maker(view, seed);
  std::vector<RayFamily> families;
  std::size_t left = count;
  const auto family = [&](const char* name, std::size_t percent, Ray (Maker::*make)()) {
    RayFamily made{name, {}};
    const std::size_t n = percent == 0 ? left : count * percent / 100;
    left -= n;
    for (std::size_t i = 0; i < n; ++i) made.rays.push_back((maker.*make)());
    families.push_back(std::move(made));
  };
  family("from outside", 25, &Maker::outside);
  family("from inside", 25, &Maker::inside);
  family("along an axis", 15, &Maker::axis);
  family("at vertices", 10, &Maker::at_vertex);
  family("at edge midpoints", 10, &Maker::at_edge);
  family("along edges", 5, &Maker::along_edge);
  family("between vertices", 0, &Maker::between_vertices);  // the rest
  return families;
}

}  // namespace tetfmt_test
