// SPDX-License-Identifier: AGPL-3.0-or-later
// The predicates against the same determinants in integers of any length, with the perturbation really
// carried out for one very small e.
#include "predicates.hpp"

#include <gtest/gtest.h>

#include <boost/multiprecision/cpp_int.hpp>
#include <cmath>
#include <random>

namespace {

using namespace tetfmt;
using namespace tetfmt::detail;
using Integer = boost::multiprecision::cpp_int;
using Vector = std::array<Integer, 3>;

/// Everything in units of e^512, for e = 2^-64: the coordinates below are -1, 0, 1 or quarters of them, so no
/// coefficient comes near 1 / e. The ids below are at most 2, the powers of e at most 256.
constexpr unsigned kUnit = 64 * 512;
Vector vector(const Vec3d& a) {
  Vector v;
  for (std::size_t j = 0; j < 3; ++j) v[j] = Integer(static_cast<int>(4 * a[j])) << (kUnit - 2);
  return v;
}
Vector vector(const Vec3f& a) {
  return vector(Vec3d{a.x, a.y, a.z});
}
Vector perturbed(const Corner& corner) {
  Vector v = vector(corner.point);
  for (unsigned j = 0; j < 3; ++j) v[j] += Integer(1) << (kUnit - 64 * (1u << (3 * corner.id + j)));
  return v;
}

/// The infinitesimal of a lift is 2^-16: its third power is far larger than e, and no power meets a
/// coefficient.
Vector lifted(const Place& place) {
  Vector v = vector(place.point);
  for (std::size_t j = 0; j < 3; ++j) v[j] += Integer(static_cast<int>(place.lift[j])) << (kUnit - 16);
  return v;
}

Vector minus(const Vector& a, const Vector& b) {
  return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
}
template <class T>
T determinant(const std::array<T, 3>& a, const std::array<T, 3>& b, const std::array<T, 3>& c) {
  return a[0] * (b[1] * c[2] - b[2] * c[1]) + a[1] * (b[2] * c[0] - b[0] * c[2]) +
         a[2] * (b[0] * c[1] - b[1] * c[0]);
}

class Predicates : public testing::Test {
 protected:
  /// Small integers: half of all determinants are zero. With `scale`, also at the ends of float32's range.
  Vec3f point(float scale = 1) {
    std::uniform_int_distribution<int> coordinate(-1, 1);
    const auto one = [&] { return static_cast<float>(coordinate(random_)) * scale; };
    return {one(), one(), one()};
  }
  /// None, or along an axis.
  Vec3d lift() {
    Vec3d result{};
    const auto choice = random_() % 8;
    if (choice < 6) result[choice / 2] = choice % 2 == 0 ? 1 : -1;
    return result;
  }
  std::mt19937 random_{7};
};

TEST_F(Predicates, PassesLeftEqualsTheDeterminantAfterPerturbation) {
  int ties = 0;
  for (int i = 0; i < 3000; ++i) {
    Line line;
    const Vec3f o = point(), d = point();
    line.origin.point = {o.x, o.y, o.z};
    line.direction = {d.x, d.y, d.z};
    if (line.direction == Vec3d{}) continue;
    const Corner a = {point(), static_cast<Index>(i % 2)}, b = {point(), static_cast<Index>(1 - i % 2)};
    line.origin.lift = lift();
    const Vector origin = lifted(line.origin);
    const Integer exact =
        determinant(vector(line.direction), minus(perturbed(a), origin), minus(perturbed(b), origin));
    ASSERT_NE(exact, 0);
    ASSERT_EQ(passes_left(line, a, b).left, exact > 0);
    ASSERT_EQ(passes_left(line, b, a).left, exact < 0);
    ties += determinant(vector(line.direction), minus(vector(a.point), origin),
                        minus(vector(b.point), origin)) == 0;
  }
  EXPECT_GT(ties, 500);
}

TEST_F(Predicates, ALineThroughAPointIsTheLineOfThatDirection) {
  for (int i = 0; i < 3000; ++i) {
    const Vec3f o = point(), q = point();
    Line line;
    line.origin.point = {o.x, o.y, o.z};
    for (std::size_t k = 0; k < 3; ++k) line.origin.point[k] /= 4;
    line.toward.point = {q.x, q.y, q.z};
    for (std::size_t k = 0; k < 3; ++k) line.direction[k] = line.toward.point[k] - line.origin.point[k];
    if (line.direction == Vec3d{}) continue;
    Line through = line;
    through.through_point = true;
    through.direction = {line.direction[0] * (1 + 0x1p-53), line.direction[1], line.direction[2]};
    const Corner a = {point(), 4}, b = {point(), 2};
    ASSERT_EQ(passes_left(through, a, b).left, passes_left(line, a, b).left);
  }
}

/// A line from one lifted place to another turns with both of them.
TEST_F(Predicates, ALineBetweenPlacesFollowsTheirLifts) {
  int ties = 0;
  for (int i = 0; i < 3000; ++i) {
    const Vec3f o = point(), q = point();
    Line line;
    line.origin = {{o.x / 4, o.y / 4, o.z / 4}, lift()};
    line.toward = {{q.x, q.y, q.z}, lift()};
    line.through_point = true;
    for (std::size_t k = 0; k < 3; ++k) line.direction[k] = line.toward.point[k] - line.origin.point[k];
    if (line.direction == Vec3d{}) continue;
    const Corner a = {point(), static_cast<Index>(i % 2)}, b = {point(), static_cast<Index>(1 - i % 2)};
    const Vector origin = lifted(line.origin);
    const Integer exact = determinant(minus(lifted(line.toward), origin), minus(perturbed(a), origin),
                                      minus(perturbed(b), origin));
    ASSERT_NE(exact, 0);
    ASSERT_EQ(passes_left(line, a, b).left, exact > 0);
    ASSERT_EQ(passes_left(line, b, a).left, exact < 0);
    ties += determinant(minus(vector(line.toward.point), vector(line.origin.point)),
                        minus(vector(a.point), vector(line.origin.point)),
                        minus(vector(b.point), vector(line.origin.point))) == 0;
  }
  EXPECT_GT(ties, 300);
}

/// The direction (2^-60 - 1, 1, 0) rounds to (-1, 1, 0), in whose plane with the edge everything would tie.
TEST_F(Predicates, ALineThroughAPointKeepsWhatItsRoundedDirectionLoses) {
  for (const double bit : {0x1p-60, -0x1p-60}) {
    Line line;
    line.origin.point = {1, 0, 0};
    line.toward.point = {bit, 1, 0};
    line.direction = {-1, 1, 0};
    line.through_point = true;
    for (const Index first : {1u, 9u}) {
      const Corner a = {{0, 1, 0}, first}, b = {{0, 1, 1}, 5};
      EXPECT_EQ(passes_left(line, a, b).left, bit > 0);
      EXPECT_EQ(passes_left(line, b, a).left, bit < 0);
    }
  }
}

TEST_F(Predicates, BehindEqualsTheDeterminantAfterPerturbation) {
  for (int i = 0; i < 1500; ++i) {
    std::array<Index, 3> id = {0, 1, 2};
    std::shuffle(id.begin(), id.end(), random_);
    const Corner a = {point(), id[0]}, b = {point(), id[1]}, c = {point(), id[2]};
    const Vec3f q = point();
    const Place p = {{q.x, q.y, q.z}, lift()};
    const Vector moved = lifted(p);
    const Integer exact =
        determinant(minus(perturbed(a), moved), minus(perturbed(b), moved), minus(perturbed(c), moved));
    ASSERT_NE(exact, 0);
    ASSERT_EQ(behind(a, b, c, p), exact > 0);
    ASSERT_EQ(behind(b, a, c, p), exact < 0);
  }
}

/// The point at t of a line: where it is a point of the lattice, and where no double holds it.
TEST_F(Predicates, BehindAlongALineEqualsTheDeterminantAfterPerturbation) {
  std::uniform_int_distribution<int> quarters(-8, 8);
  int ties = 0;
  for (int i = 0; i < 1000; ++i) {
    std::array<Index, 3> id = {0, 1, 2};
    std::shuffle(id.begin(), id.end(), random_);
    const Corner a = {point(), id[0]}, b = {point(), id[1]}, c = {point(), id[2]};
    const Vec3f o = point(), d = point();
    Line line;
    line.origin = {{o.x, o.y, o.z}, lift()};
    line.direction = {d.x, d.y, d.z};
    if (line.direction == Vec3d{}) continue;
    const int t = quarters(random_);
    Vector at = lifted(line.origin);
    for (std::size_t k = 0; k < 3; ++k) at[k] += vector(line.direction)[k] * t / 4;
    const Integer exact =
        determinant(minus(perturbed(a), at), minus(perturbed(b), at), minus(perturbed(c), at));
    ASSERT_NE(exact, 0);
    ASSERT_EQ(behind(a, b, c, line, t / 4.0), exact > 0);
    const Vector plain_a = vector(a.point), plain_b = vector(b.point), plain_c = vector(c.point);
    Vector plain = vector(line.origin.point);
    for (std::size_t k = 0; k < 3; ++k) plain[k] += vector(line.direction)[k] * t / 4;
    ties += determinant(minus(plain_a, plain), minus(plain_b, plain), minus(plain_c, plain)) == 0;
  }
  EXPECT_GT(ties, 100);
}

/// The products of t and d lie below the smallest double: what rounding makes of them has another sign.
TEST_F(Predicates, BehindAlongALineKnowsWhatUnderflows) {
  Line line;
  line.direction = {0.5, 0.75, 0};
  // The normal is (1000, -800, 0): -100 along the direction.
  const Corner a = {{0, 0, 0}, 0}, b = {{800, 1000, 0}, 1}, c = {{0, 0, 1}, 2};
  for (const double t : {3 * 0x1p-1074, 0x1p-1022, 1e-300, 1e-30})
    for (const double sign : {1.0, -1.0}) EXPECT_EQ(behind(a, b, c, line, sign * t), sign > 0) << t;
}

TEST_F(Predicates, BehindAlongALineForAnyDoubles) {
  using Rational = boost::multiprecision::cpp_rational;
  std::uniform_real_distribution<float> coordinate(-1, 1);
  std::uniform_int_distribution<int> far(-1070, 1000), near(-30, 3);
  int decided = 0;
  for (int i = 0; i < 2000; ++i) {
    const auto any = [&] { return std::ldexp(coordinate(random_), near(random_)); };
    const Corner a = {{any(), any(), any()}, 0}, b = {{any(), any(), any()}, 1},
                 c = {{any(), any(), any()}, 2};
    Line line;
    for (std::size_t k = 0; k < 3; ++k) {
      line.origin.point[k] = static_cast<double>(any());
      line.direction[k] = static_cast<double>(any());
    }
    // The plane's own t, to the last bit or one beside it; or anything.
    std::array<Rational, 3> ab, ac, ao, d;
    for (std::size_t k = 0; k < 3; ++k) {
      ab[k] = Rational((&b.point.x)[k]) - Rational((&a.point.x)[k]);
      ac[k] = Rational((&c.point.x)[k]) - Rational((&a.point.x)[k]);
      ao[k] = Rational((&a.point.x)[k]) - Rational(line.origin.point[k]);
      d[k] = Rational(line.direction[k]);
    }
    const Rational height = determinant(ao, ab, ac), along = determinant(d, ab, ac);
    if (along == 0) continue;
    double t = static_cast<double>(Rational(height / along));
    if (i % 3 == 1) t = std::nextafter(t, i % 2 == 0 ? -9.0 : 9.0);
    if (i % 3 == 2) t = std::ldexp(1.0, far(random_)) * (i % 2 == 0 ? 1 : -1);
    const Rational exact = height - Rational(t) * along;
    if (exact == 0) continue;
    ASSERT_EQ(behind(a, b, c, line, t), exact > 0) << t;
    ++decided;
  }
  EXPECT_GT(decided, 1500);
}

TEST_F(Predicates, ScaleDoesNotMatter) {
  for (const float scale : {0x1p-149f, 0x1p-100f, 0x1p60f, 0x1p126f}) {
    for (int i = 0; i < 500; ++i) {
      const Vec3f o = point(), d = point(), p = point(), q = point();
      const auto big = [&](const Vec3f& v) { return Vec3f{v.x * scale, v.y * scale, v.z * scale}; };
      const auto line = [](const Vec3f& origin, const Vec3f& direction) {
        Line result;
        result.origin.point = {origin.x, origin.y, origin.z};
        result.direction = {direction.x, direction.y, direction.z};
        return result;
      };
      if (d == Vec3f{}) continue;
      ASSERT_EQ(passes_left(line(big(o), d), {big(p), 3}, {big(q), 9}).left,
                passes_left(line(o, big(d)), {p, 3}, {q, 9}).left);
    }
  }
}

/// One step of the last bit decides, far from the origin and with numbers of very different size.
TEST_F(Predicates, NearTiesAreExact) {
  std::uniform_real_distribution<float> coordinate(-1, 1);
  int decided = 0;
  // From differences that fit 128-bit products to those that do not, with all in between.
  for (int i = 0; i < 4000; ++i) {
    std::uniform_int_distribution<int> exponent(-(i % 21), i % 21);
    Line line;
    for (std::size_t k = 0; k < 3; ++k) {
      line.origin.point[k] = static_cast<double>(std::ldexp(coordinate(random_), exponent(random_)));
      line.direction[k] = static_cast<double>(std::ldexp(coordinate(random_), exponent(random_)));
    }
    // Two points next to the line, as near as float32 allows.
    const auto near = [&](double t) {
      Vec3d p;
      for (std::size_t k = 0; k < 3; ++k) p[k] = line.origin.point[k] + t * line.direction[k];
      return Vec3f{static_cast<float>(p[0]), static_cast<float>(p[1]), static_cast<float>(p[2])};
    };
    const Corner a = {near(1), 0}, b = {near(coordinate(random_)), 1};
    using Rational = boost::multiprecision::cpp_rational;
    std::array<Rational, 3> direction, to_a, to_b;
    for (std::size_t k = 0; k < 3; ++k) {
      direction[k] = line.direction[k];
      to_a[k] = Rational((&a.point.x)[k]) - Rational(line.origin.point[k]);
      to_b[k] = Rational((&b.point.x)[k]) - Rational(line.origin.point[k]);
    }
    const Rational exact = determinant(direction, to_a, to_b);
    if (exact != 0) {
      ASSERT_EQ(passes_left(line, a, b).left, exact > 0);
    }
    ASSERT_NE(passes_left(line, a, b).left, passes_left(line, b, a).left);
    decided += exact != 0;
  }
  EXPECT_GT(decided, 3500);
}

}  // namespace
