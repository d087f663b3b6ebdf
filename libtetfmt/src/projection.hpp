// SPDX-License-Identifier: MIT
// Along a line, onto a plane: where the walk looks at edges as points see them that fly along the line. With
// p = (x, y) for each vertex, x_a y_b - y_a x_b has the sign of det[d, a - o, b - o]. Three bases, with one
// interface:
//
//   Point2<Real> operator()(const Vec3f&)   the projected vertex
//   kErrorBound                                 a bound, see ExactSigns
//
// A Projection<double> is made of a line, a Projection<float> of one in double.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

#include "predicates.hpp"

namespace tetfmt::detail {

template <class Real>
struct Point2 {
  Real x = 0, y = 0;
};

/// Shear along the line onto the plane orthogonal to its largest component k (Woop, Benthin and Wald 2013):
/// x = A_i - A_k d_i/d_k, y = A_j - A_k d_j/d_k with A = point - origin; i and j are swapped where d_k is
/// negative. The two ratios are at most 1.
template <class Real>
class ShearProjection {
 public:
  /// With u = 2^-53 and all |A| at most L in each coordinate: x carries a rounding of A_i (u L), those of A_k
  /// (u L) and of the slope (u L; of a line through a point, 3 u L), one of their product (u L) and one of
  /// the difference (2 u L): 8 u L to first order, and is at most 2 L. A cross product then is off by at most
  /// 4 * 8 u L * 2 L for its inputs and 2 * u * 8 L^2 for its own roundings: 80 u L^2; the rest is room for
  /// terms of second order.
  static constexpr double kErrorBound = 128;

  explicit ShearProjection(const Line& line) {
    const Vec3d& d = line.direction;
    k_ = Axes(d).largest;
    i_ = (k_ + 1) % 3;
    j_ = (k_ + 2) % 3;
    if (d[k_] < 0) std::swap(i_, j_);
    origin_i_ = static_cast<Real>(line.origin.point[i_]);
    origin_j_ = static_cast<Real>(line.origin.point[j_]);
    origin_k_ = static_cast<Real>(line.origin.point[k_]);
    slope_i_ = static_cast<Real>(d[i_] / d[k_]);
    slope_j_ = static_cast<Real>(d[j_] / d[k_]);
  }
  template <class Other>
  explicit ShearProjection(const ShearProjection<Other>& other)
      : i_(other.i_),
        j_(other.j_),
        k_(other.k_),
        origin_i_(static_cast<Real>(other.origin_i_)),
        origin_j_(static_cast<Real>(other.origin_j_)),
        origin_k_(static_cast<Real>(other.origin_k_)),
        slope_i_(static_cast<Real>(other.slope_i_)),
        slope_j_(static_cast<Real>(other.slope_j_)) {}

  Point2<Real> operator()(const Vec3f& point) const {
    const Real depth = static_cast<Real>(coordinate(point, k_)) - origin_k_;
    return {static_cast<Real>(coordinate(point, i_)) - origin_i_ - depth * slope_i_,
            static_cast<Real>(coordinate(point, j_)) - origin_j_ - depth * slope_j_};
  }

 private:
  template <class>
  friend class ShearProjection;
  std::size_t i_ = 0, j_ = 0, k_ = 0;
  Real origin_i_ = 0, origin_j_ = 0, origin_k_ = 0, slope_i_ = 0, slope_j_ = 0;
};

/// x and y by two unit vectors that are orthogonal to the direction and to each other (Duff and others 2017).
template <class Real>
class OrthonormalProjection {
 public:
  /// A basis vector is off by at most 20 u and the products and sums of its dot product by 5 u more, times
  /// |A| <= sqrt(3) L; coordinates are at most sqrt(3) L: 4 * 25 * 3 u L^2 for the inputs of a cross product
  /// and 12 u L^2 for its own roundings.
  static constexpr double kErrorBound = 512;

  explicit OrthonormalProjection(const Line& line) {
    const Vec3d& d = line.direction;
    const double length = std::hypot(d[0], d[1], d[2]);
    const Vec3d n = {d[0] / length, d[1] / length, d[2] / length};
    const double sign = std::copysign(1.0, n[2]), a = -1 / (sign + n[2]), b = n[0] * n[1] * a;
    const Vec3d u = {1 + sign * n[0] * n[0] * a, sign * b, -sign * n[0]},
                v = {b, sign + n[1] * n[1] * a, -n[1]};
    for (std::size_t axis = 0; axis < 3; ++axis) {
      origin_[axis] = static_cast<Real>(line.origin.point[axis]);
      u_[axis] = static_cast<Real>(u[axis]);
      v_[axis] = static_cast<Real>(v[axis]);
    }
  }
  template <class Other>
  explicit OrthonormalProjection(const OrthonormalProjection<Other>& other) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      origin_[axis] = static_cast<Real>(other.origin_[axis]);
      u_[axis] = static_cast<Real>(other.u_[axis]);
      v_[axis] = static_cast<Real>(other.v_[axis]);
    }
  }

  Point2<Real> operator()(const Vec3f& point) const {
    const Real x = static_cast<Real>(point.x) - origin_[0], y = static_cast<Real>(point.y) - origin_[1],
               z = static_cast<Real>(point.z) - origin_[2];
    return {u_[0] * x + u_[1] * y + u_[2] * z, v_[0] * x + v_[1] * y + v_[2] * z};
  }

 private:
  template <class>
  friend class OrthonormalProjection;
  std::array<Real, 3> origin_{}, u_{}, v_{};
};

/// The specialised basis of appendix C for directions whose smallest, largest and other component lie on
/// these axes: x = A_other + u A_largest, y = v A_largest + w A_other + s A_smallest. kTurn is s, which makes
/// the pair turn about the direction the right way; it is set by the direction's signs. (Equation 3 of the
/// paper has its indices mixed up; this follows from its equations 1 and 2, with the second vector scaled by
/// its largest component, the smallest axis's.)
template <std::size_t kSmallest, std::size_t kLargest, int kTurn>
struct Specialised {
  static_assert(kSmallest < 3 && kLargest < 3 && kSmallest != kLargest);
  static constexpr std::size_t kOther = 3 - kSmallest - kLargest;

  template <class Real>
  class Projection {
   public:
    /// No component exceeds 1 nor carries more than 6 roundings. x is off by at most 8 u L and at most 2 L, y
    /// by 20 u L and 2.5 L: 2 * (8 * 2.5 + 20 * 2) u L^2 for the inputs and 20 u L^2 for a cross product's
    /// roundings.
    static constexpr double kErrorBound = 256;

    explicit Projection(const Line& line) {
      const Vec3d& d = line.direction;
      const double largest = d[kLargest], other = d[kOther], smallest = d[kSmallest];
      for (std::size_t axis = 0; axis < 3; ++axis) origin_[axis] = static_cast<Real>(line.origin.point[axis]);
      // First vector: 1 on the other axis, -other / largest on the largest, so that d . first = 0. Second:
      // d x first, whose components are, up to the sign of the axes' permutation, these.
      const double on_smallest = -(other * (other / largest) + largest);
      const double on_other = smallest * (other / largest), on_largest = smallest;
      constexpr double kPermutation = (kSmallest + 1) % 3 == kOther ? 1 : -1;
      const double scale = 1 / std::abs(on_smallest);
      u_ = static_cast<Real>(-other / largest);
      v_ = static_cast<Real>(kPermutation * on_largest * scale);
      w_ = static_cast<Real>(kPermutation * on_other * scale);
    }
    template <class Other>
    explicit Projection(const Other& o)
        : u_(static_cast<Real>(o.u_)), v_(static_cast<Real>(o.v_)), w_(static_cast<Real>(o.w_)) {
      for (std::size_t axis = 0; axis < 3; ++axis) origin_[axis] = static_cast<Real>(o.origin_[axis]);
    }

    /// Which kTurn suits the direction.
    static int turn(const Vec3d& d) { return ((kSmallest + 1) % 3 == kOther) == (d[kLargest] < 0) ? 1 : -1; }

    Point2<Real> operator()(const Vec3f& point) const {
      const Real smallest = static_cast<Real>(coordinate(point, kSmallest)) - origin_[kSmallest],
                 other = static_cast<Real>(coordinate(point, kOther)) - origin_[kOther],
                 largest = static_cast<Real>(coordinate(point, kLargest)) - origin_[kLargest];
      const Real flat = v_ * largest + w_ * other;
      return {other + u_ * largest, kTurn > 0 ? flat + smallest : flat - smallest};
    }

   private:
    template <class>
    friend class Projection;
    std::array<Real, 3> origin_{};
    Real u_ = 0, v_ = 0, w_ = 0;
  };
};

}  // namespace tetfmt::detail
