// SPDX-License-Identifier: MIT
#include "predicates.hpp"

#include <algorithm>
#include <bit>
#include <boost/multiprecision/cpp_int.hpp>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

namespace tetfmt::detail {
namespace {

template <unsigned kBits>
using Integers = boost::multiprecision::number<boost::multiprecision::cpp_int_backend<
    kBits, kBits, boost::multiprecision::signed_magnitude, boost::multiprecision::unchecked, void>>;
// Products of three differences of float32 values span at most 3 * 278 bits, of points on sides of faces 81
// more: 1024 never overflow.
using Wide = Integers<1024>;
// The same for origin + t * direction, t any double: 3 * 2400 bits.
using Widest = Integers<8192>;
// Enough where every entry stays below 2^40: on lattices, where ties are common.
__extension__ using Narrow = __int128;
constexpr int kNarrowBits = 40;

template <class Integer>
using Row = std::array<Integer, 3>;
template <class Integer>
using Matrix = std::array<Row<Integer>, 3>;

constexpr double kEpsilon = 0x1p-53;

/// value = mantissa * 2^exponent, mantissa odd and of at most 53 bits; {0, 0} for zero and for what is not
/// finite.
struct Decomposed {
  std::int64_t mantissa = 0;
  int exponent = 0;
};
Decomposed decompose(double value) {
  if (value == 0 || !std::isfinite(value)) return {};
  const auto bits = std::bit_cast<std::uint64_t>(value);
  const int biased = static_cast<int>(bits >> 52 & 0x7FF);
  const std::uint64_t leading = biased == 0 ? 0 : 0x10000000000000;  // subnormal numbers have none
  const auto mantissa = static_cast<std::int64_t>((bits & 0xFFFFFFFFFFFFF) | leading);
  const int zeros = std::countr_zero(static_cast<std::uint64_t>(mantissa));
  return {(value < 0 ? -mantissa : mantissa) >> zeros, std::max(biased, 1) - 1075 + zeros};
}

/// The powers of two between which all bits of some numbers lie: lowest <= bits < highest.
struct BitRange {
  int lowest = std::numeric_limits<int>::max(), highest = std::numeric_limits<int>::min();
  int size() const { return highest < lowest ? 0 : highest - lowest; }
};

template <std::size_t N>
BitRange bit_range(const std::array<Vec3d, N>& points) {
  BitRange range;
  for (const Vec3d& point : points) {
    for (const double value : point) {
      const auto [mantissa, exponent] = decompose(value);
      if (mantissa == 0) continue;
      range.lowest = std::min(range.lowest, exponent);
      range.highest = std::max(
          range.highest,
          exponent + static_cast<int>(std::bit_width(static_cast<std::uint64_t>(std::abs(mantissa)))));
    }
  }
  return range;
}

/// The point in units of 2^scale, of which every coordinate must be a multiple.
template <class Integer>
Row<Integer> to_integers(const Vec3d& point, int scale) {
  Row<Integer> row;
  for (std::size_t i = 0; i < 3; ++i) {
    const auto [mantissa, exponent] = decompose(point[i]);
    row[i] = mantissa;
    if (mantissa != 0) row[i] *= Integer(1) << static_cast<unsigned>(exponent - scale);
  }
  return row;
}

template <class Integer>
Row<Integer> difference(const Vec3d& a, const Vec3d& b, int scale) {
  const Row<Integer> p = to_integers<Integer>(a, scale), q = to_integers<Integer>(b, scale);
  return {p[0] - q[0], p[1] - q[1], p[2] - q[2]};
}

template <class Integer>
Integer determinant(const Matrix<Integer>& m) {
  return m[0][0] * (m[1][1] * m[2][2] - m[1][2] * m[2][1]) +
         m[0][1] * (m[1][2] * m[2][0] - m[1][0] * m[2][2]) +
         m[0][2] * (m[1][0] * m[2][1] - m[1][1] * m[2][0]);
}

/// How a determinant's rows move.
struct Motion {
  std::array<Index, 3> ids;    ///< the vertex whose motion by the tie rule row r follows; kNone: none
  std::array<Vec3d, 3> rates;  ///< per unit of the larger infinitesimal, by which places are lifted; integers
};

/// Sign of the determinant after the lifts: of the first coefficient in powers of their infinitesimal that is
/// not 0. The one of power n is the sum over all ways to put n rows' rates in the place of the rows.
template <class Integer>
int lifted_sign(const Matrix<Integer>& m, const std::array<Vec3d, 3>& rates) {
  for (int power = 0; power <= 3; ++power) {
    Integer coefficient = 0;
    for (unsigned rows = 0; rows < 8; ++rows) {
      if (std::popcount(rows) != power) continue;
      Matrix<Integer> term = m;
      for (std::size_t r = 0; r < 3; ++r)
        if (rows >> r & 1u)
          for (std::size_t i = 0; i < 3; ++i) term[r][i] = static_cast<int>(rates[r][i]);
      coefficient += determinant(term);
    }
    if (coefficient != 0) return coefficient > 0 ? 1 : -1;
    if (rates == std::array<Vec3d, 3>{}) return 0;
  }
  return 0;
}

/// Sign of the determinant after the motions. Expanded in powers of e, a term takes the unit vector j for
/// some of the moving rows; its power is the sum of 2^(3i+j). Only the order of the ids matters for the order
/// of the powers, so ranks stand in for them. Zero only if no term is left, which needs equal ids or a zero
/// direction.
template <class Integer>
int perturbed_sign(const Matrix<Integer>& matrix, const Motion& motion, Decided& how) {
  how = Decided::by_integers;
  if (const int sign = lifted_sign(matrix, motion.rates)) return sign;
  how = Decided::by_tie_rule;
  std::array<unsigned, 3> first_bit{};  // of each moving row: three bits a row, the smallest id lowest
  unsigned bit_count = 0;
  for (std::size_t r = 0; r < 3; ++r) {
    if (motion.ids[r] == kNone) continue;
    bit_count += 3;
    for (const Index other : motion.ids) first_bit[r] += other < motion.ids[r] ? 3 : 0;
  }
  for (unsigned power = 1; power < 1u << bit_count; ++power) {
    Matrix<Integer> term = matrix;
    std::array<Vec3d, 3> rates = motion.rates;
    bool possible = true;
    for (std::size_t r = 0; r < 3 && possible; ++r) {
      const unsigned bits = motion.ids[r] == kNone ? 0 : power >> first_bit[r] & 7u;
      if (bits == 0) continue;
      possible = std::has_single_bit(bits);
      term[r] = {Integer(bits & 1u), Integer(bits >> 1 & 1u), Integer(bits >> 2 & 1u)};
      rates[r] = {};
    }
    if (!possible) continue;
    if (const int sign = lifted_sign(term, rates)) return sign;
  }
  return 0;
}

}  // namespace

int certified_sign(const Vec3d& a, const Vec3d& b, const Vec3d& c) {
  double value = 0, permanent = 0;
  for (std::size_t i = 0; i < 3; ++i) {
    const double p = b[(i + 1) % 3] * c[(i + 2) % 3], q = b[(i + 2) % 3] * c[(i + 1) % 3];
    value += a[i] * (p - q);
    permanent += std::abs(a[i]) * (std::abs(p) + std::abs(q));
  }
  const double bound = (7 + 56 * kEpsilon) * kEpsilon * permanent;
  return (value > bound) - (value < -bound);
}

Passing passes_left(const Line& line, const Corner& a, const Corner& b) {
  const Vec3d pa = to_vec3d(a.point), pb = to_vec3d(b.point), &o = line.origin.point;
  const Vec3d to_a = minus(pa, o), to_b = minus(pb, o);
  if (const int sign = certified_sign(line.direction, to_a, to_b)) return {sign > 0, Decided::in_double};
  // The edge's own vector instead of b: the same determinant, and a much smaller permanent for a far origin.
  if (const int sign = certified_sign(line.direction, to_a, minus(pb, pa)))
    return {sign > 0, Decided::in_double};

  const Vec3d still{}, &lift = line.origin.lift, away = minus(still, lift);
  BitRange points = bit_range<3>({o, pa, pb}), directions = bit_range<1>({line.direction});
  if (line.through_point)
    points = directions = bit_range<4>({o, pa, pb, line.toward.point});  // lifts in one unit
  const Motion motion = {{kNone, a.id, b.id},
                         {line.through_point ? minus(line.toward.lift, lift) : still, away, away}};
  Passing passing;
  const auto sign = [&]<class Integer>(Integer) {
    const Row<Integer> direction = line.through_point
                                       ? difference<Integer>(line.toward.point, o, directions.lowest)
                                       : to_integers<Integer>(line.direction, directions.lowest);
    return perturbed_sign<Integer>(
        {direction, difference<Integer>(pa, o, points.lowest), difference<Integer>(pb, o, points.lowest)},
        motion, passing.how);
  };
  passing.left =
      (std::max(points.size(), directions.size()) < kNarrowBits ? sign(Narrow{}) : sign(Wide{})) > 0;
  return passing;
}

bool behind(const Corner& a, const Corner& b, const Corner& c, const Place& place) {
  const Vec3d pa = to_vec3d(a.point), pb = to_vec3d(b.point), pc = to_vec3d(c.point), &p = place.point;
  if (const int sign = certified_sign(minus(pa, p), minus(pb, p), minus(pc, p))) return sign > 0;
  const BitRange range = bit_range<4>({pa, pb, pc, p});
  const Vec3d away = minus({}, place.lift);
  const auto sign = [&]<class Integer>(Integer) {
    Decided how;
    return perturbed_sign<Integer>(
        {difference<Integer>(pa, p, range.lowest), difference<Integer>(pb, p, range.lowest),
         difference<Integer>(pc, p, range.lowest)},
        {{a.id, b.id, c.id}, {away, away, away}}, how);
  };
  return (range.size() < kNarrowBits ? sign(Narrow{}) : sign(Wide{})) > 0;
}

bool behind(const Corner& a, const Corner& b, const Corner& c, const Line& line, double t) {
  const Vec3d pa = to_vec3d(a.point), pb = to_vec3d(b.point), pc = to_vec3d(c.point), &o = line.origin.point;
  // (a - o - t d) . n: the first factor is off by at most two roundings of |a - o| + |t d|, n by those that
  // certified_sign allows for; products and sums add five. 16 covers them all, unless t d underflows.
  {
    const Vec3d ab = minus(pb, pa), ac = minus(pc, pa);
    double value = 0, permanent = 0;
    bool normal = true;
    for (std::size_t i = 0; i < 3; ++i) {
      const double p = ab[(i + 1) % 3] * ac[(i + 2) % 3], q = ab[(i + 2) % 3] * ac[(i + 1) % 3];
      const double to_a = pa[i] - o[i], along = t * line.direction[i];
      normal = normal && (std::abs(along) > 0x1p-700 || t == 0 || line.direction[i] == 0);
      value += (to_a - along) * (p - q);
      permanent += (std::abs(to_a) + std::abs(along)) * (std::abs(p) + std::abs(q));
    }
    const double bound = 16 * kEpsilon * permanent;
    if (normal && value > bound) return true;
    if (normal && value < -bound) return false;
  }
  const BitRange points = bit_range<4>({pa, pb, pc, o}), directions = bit_range<1>({line.direction});
  const Decomposed time = decompose(t);
  const int scale = std::min(points.lowest, time.mantissa == 0 || directions.size() == 0
                                                ? points.lowest
                                                : directions.lowest + time.exponent);
  Row<Widest> along{};
  for (std::size_t i = 0; i < 3; ++i) {
    const auto [mantissa, exponent] = decompose(line.direction[i]);
    along[i] = Widest(mantissa) * time.mantissa;
    if (along[i] != 0) along[i] <<= static_cast<unsigned>(exponent + time.exponent - scale);
  }
  Matrix<Widest> rows = {difference<Widest>(pa, o, scale), difference<Widest>(pb, o, scale),
                         difference<Widest>(pc, o, scale)};
  for (Row<Widest>& row : rows)
    for (std::size_t i = 0; i < 3; ++i) row[i] -= along[i];
  const Vec3d away = minus({}, line.origin.lift);
  Decided how;
  return perturbed_sign<Widest>(rows, {{a.id, b.id, c.id}, {away, away, away}}, how) > 0;
}

double plane_height(const Vec3d& origin, const Vec3f& a, const Vec3f& b, const Vec3f& c) {
  const Vec3d pa = to_vec3d(a), pb = to_vec3d(b), pc = to_vec3d(c);
  const int scale = bit_range<4>({pa, pb, pc, origin}).lowest;
  Wide value = determinant<Wide>({difference<Wide>(pa, origin, scale), difference<Wide>(pb, pa, scale),
                                  difference<Wide>(pc, pa, scale)});
  if (value == 0) return 0;
  const bool negative = value < 0;
  if (negative) value = -value;
  // To 64 bits, the last of which stands for all below: then one rounding is the rounding of the whole.
  const auto excess = static_cast<int>(msb(value)) - 63;
  if (excess > 0) {
    const bool inexact = static_cast<int>(lsb(value)) < excess;
    value >>= static_cast<unsigned>(excess);
    if (inexact) value |= 1;
  }
  const double size =
      std::ldexp(static_cast<double>(static_cast<std::uint64_t>(value)), 3 * scale + std::max(excess, 0));
  return negative ? -size : size;
}

}  // namespace tetfmt::detail
