// SPDX-License-Identifier: MIT
// The signs that steer a walk: on which side of the line an edge passes. Three arithmetics, with one
// interface:
//
//   Point project(const Vec3f&)                        what a walk keeps of a vertex
//   bool left(const Point&, Index, const Point&, Index)   whether the edge passes the line on the left
//
// and each for every projection (projection.hpp), with or without counting.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <span>

#include "projection.hpp"
#include "tetfmt/kernels.hpp"

namespace tetfmt::detail {

struct NoCounts {
  void in_float() const {}
  void in_double() const {}
  void decided(Decided) const {}
};

class Counting {
 public:
  explicit Counting(SignCounts& counts) : counts_(&counts) {}
  void in_float() const { ++counts_->in_float; }
  void in_double() const { ++counts_->in_double; }
  void decided(Decided how) const {
    ++(how == Decided::in_double     ? counts_->in_double2
       : how == Decided::by_integers ? counts_->exact
                                     : counts_->tied);
  }

 private:
  SignCounts* counts_;
};

/// How far the mesh reaches from the line's origin, along any axis. (Bounds that are no numbers, as only an
/// invalid file has, count as nothing.)
inline double reach(const Line& line, const Bounds& bounds) {
  const Vec3d lower = to_vec3d(bounds.lower), upper = to_vec3d(bounds.upper);
  double most = 0;
  for (std::size_t i = 0; i < 3; ++i)
    most = std::max(
        {most, std::abs(lower[i] - line.origin.point[i]), std::abs(upper[i] - line.origin.point[i])});
  return most;
}

/// Double precision, certified by one constant a line: Projection::kErrorBound roundings of reach^2. The rest
/// by predicates.hpp.
template <template <class> class Projection, class Counts>
class ExactSigns {
 public:
  using Point = Point2<double>;

  ExactSigns(const Line& line, const Bounds& bounds, std::span<const Vec3f> vertices, const Counts& counts)
      : project_(line), line_(line), vertices_(vertices), counts_(counts) {
    const double most = reach(line, bounds);
    threshold_ = Projection<double>::kErrorBound * 0x1p-53 * most * most;
  }
  Point project(const Vec3f& point) const { return project_(point); }
  bool left(const Point& a, Index a_id, const Point& b, Index b_id) const {
    const double cross = a.x * b.y - a.y * b.x;
    if (cross > threshold_) {
      counts_.in_double();
      return true;
    }
    if (cross < -threshold_) {
      counts_.in_double();
      return false;
    }
    return left_exactly(a_id, b_id);
  }
  const Projection<double>& projection() const { return project_; }
  const Line& line() const { return line_; }
  std::span<const Vec3f> vertices() const { return vertices_; }
  const Counts& counts() const { return counts_; }

 private:
  [[gnu::noinline, gnu::cold]] bool left_exactly(Index a, Index b) const {
    const Passing passing = passes_left(line_, {vertices_[a], a}, {vertices_[b], b});
    counts_.decided(passing.how);
    return passing.left;
  }

  Projection<double> project_;
  const Line& line_;
  std::span<const Vec3f> vertices_;
  double threshold_ = 0;
  [[no_unique_address]] Counts counts_;
};

/// Signs as single precision gives them. A walk by these can go wrong where the line meets edges and
/// vertices.
template <template <class> class Projection, class Counts>
class FloatSigns {
 public:
  using Point = Point2<float>;
  using Exact = ExactSigns<Projection, Counts>;

  FloatSigns(const Exact& exact, const Bounds&) : project_(exact.projection()), counts_(exact.counts()) {}
  Point project(const Vec3f& point) const { return project_(point); }
  bool left(const Point& a, Index, const Point& b, Index) const {
    counts_.in_float();
    return a.x * b.y - a.y * b.x > 0;
  }

 private:
  Projection<float> project_;
  [[no_unique_address]] Counts counts_;
};

/// Single precision where a bound certifies it, then as ExactSigns.
///
/// With u = 2^-24 and L the reach: A carries a rounding of L and one of the origin, a slope two of L, the
/// product and the difference one and two: a projected coordinate is off by at most e = (8 L + 2 |o|) u
/// (shear). With m = |x| + |y|, a cross product is off by e (m_a + m_b) + 2 e^2 for its inputs and by 2 u m_a
/// m_b, of which a factor is at most 4 L, for its own roundings: (16 L + 2 |o|) u (m_a + m_b) covers all but
/// the square. Twice as much leaves room for roundings of the bound itself.
template <template <class> class Projection, class Counts>
class FloatFirstSigns {
 public:
  struct Point {
    float x = 0, y = 0, size = 0;
  };
  using Exact = ExactSigns<Projection, Counts>;

  FloatFirstSigns(const Exact& exact, const Bounds& bounds) : exact_(exact), project_(exact.projection()) {
    const Vec3d& o = exact.line().origin.point;
    const double from_zero = std::max({std::abs(o[0]), std::abs(o[1]), std::abs(o[2])});
    const double error =
        0x1p-24 * (Projection<double>::kErrorBound / 4 * reach(exact.line(), bounds) + 8 * from_zero);
    error_ = static_cast<float>(error);
    const double most = reach(exact.line(), bounds);  // where products overflow, nothing is certain
    if (!(16 * most * most < double{std::numeric_limits<float>::max()}))
      error_ = std::numeric_limits<float>::infinity();
    square_ =
        static_cast<float>(4 * error * error) + std::numeric_limits<float>::min();  // products may underflow
  }
  Point project(const Vec3f& point) const {
    const Point2<float> p = project_(point);
    return {p.x, p.y, std::abs(p.x) + std::abs(p.y)};
  }
  bool left(const Point& a, Index a_id, const Point& b, Index b_id) const {
    const float cross = a.x * b.y - a.y * b.x, bound = error_ * (a.size + b.size) + square_;
    if (cross > bound || cross < -bound) {
      exact_.counts().in_float();
      return cross > 0;
    }
    return left_in_double(a_id, b_id);
  }

 private:
  [[gnu::noinline]] bool left_in_double(Index a, Index b) const {
    const auto vertices = exact_.vertices();
    return exact_.left(exact_.project(vertices[a]), a, exact_.project(vertices[b]), b);
  }

  const Exact& exact_;
  Projection<float> project_;
  float error_ = 0, square_ = 0;
};

/// What everything but kernels.cpp walks by.
using Signs = ExactSigns<ShearProjection, NoCounts>;

}  // namespace tetfmt::detail
