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

// Products of three differences of float32 values span at most 3 * 278 bits, so 1024 never overflow.
using Wide = boost::multiprecision::number<boost::multiprecision::cpp_int_backend<
    1024, 1024, boost::multiprecision::signed_magnitude, boost::multiprecision::unchecked, void>>;
// Enough where every entry stays below 2^40: on lattices, where ties are common.
__extension__ using Narrow = __int128;
constexpr int kNarrowBits = 40;

template <class Integer>
using Row = std::array<Integer, 3>;
template <class Integer>
using Matrix = std::array<Row<Integer>, 3>;

constexpr double kEpsilon = 0x1p-53;

/// value = mantissa * 2^exponent, mantissa odd and of at most 53 bits; {0, 0} for zero and for what is not
/// finite. Sums and differences of float32 values are never subnormal in double precision.
struct Decomposed {
  std::int64_t mantissa = 0;
  int exponent = 0;
};
Decomposed decompose(double value) {
  if (value == 0 || !std::isfinite(value)) return {};
  const auto bits = std::bit_cast<std::uint64_t>(value);
  const auto mantissa = static_cast<std::int64_t>((bits & 0xFFFFFFFFFFFFF) | 0x10000000000000);
  const int zeros = std::countr_zero(bits | 0x10000000000000);
  return {(value < 0 ? -mantissa : mantissa) >> zeros, static_cast<int>(bits >> 52 & 0x7FF) - 1075 + zeros};
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
int determinant_sign(const Matrix<Integer>& m) {
  const Integer value = m[0][0] * (m[1][1] * m[2][2] - m[1][2] * m[2][1]) +
                        m[0][1] * (m[1][2] * m[2][0] - m[1][0] * m[2][2]) +
                        m[0][2] * (m[1][0] * m[2][1] - m[1][1] * m[2][0]);
  return (value > 0) - (value < 0);
}

/// Sign of the determinant after perturbing row r as vertex ids[r] (kNone: this row stays). Expanded in
/// powers of e, a term takes the unit vector j for some of the perturbed rows; its power is the sum of
/// 2^(3i+j). Only the order of the ids matters for the order of the powers, so ranks stand in for them. Zero
/// only if no term is left, which needs equal ids or a zero direction.
template <class Integer>
int perturbed_sign(const Matrix<Integer>& matrix, const std::array<Index, 3>& ids) {
  if (const int sign = determinant_sign(matrix)) return sign;
  std::array<unsigned, 3> first_bit{};  // of each perturbed row: three bits a row, the smallest id lowest
  unsigned bit_count = 0;
  for (std::size_t r = 0; r < 3; ++r) {
    if (ids[r] == kNone) continue;
    bit_count += 3;
    for (const Index other : ids) first_bit[r] += other < ids[r] ? 3 : 0;
  }
  for (unsigned power = 1; power < 1u << bit_count; ++power) {
    Matrix<Integer> term = matrix;
    bool possible = true;
    for (std::size_t r = 0; r < 3 && possible; ++r) {
      const unsigned bits = ids[r] == kNone ? 0 : power >> first_bit[r] & 7u;
      if (bits == 0) continue;
      possible = std::has_single_bit(bits);
      term[r] = {Integer(bits & 1u), Integer(bits >> 1 & 1u), Integer(bits >> 2 & 1u)};
    }
    if (!possible) continue;
    if (const int sign = determinant_sign(term)) return sign;
  }
  return 0;
}

Vec3d to_double(const Vec3f& p) {
  return {p.x, p.y, p.z};
}

Vec3d minus(const Vec3d& a, const Vec3d& b) {
  return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
}

/// Sign of det[a, b, c] if double precision certifies it. The entries may carry one rounding each; the bound
/// is that of Shewchuk (1997), orient3d stage A.
std::optional<int> certified_sign(const Vec3d& a, const Vec3d& b, const Vec3d& c) {
  double value = 0, permanent = 0;
  for (std::size_t i = 0; i < 3; ++i) {
    const double p = b[(i + 1) % 3] * c[(i + 2) % 3], q = b[(i + 2) % 3] * c[(i + 1) % 3];
    value += a[i] * (p - q);
    permanent += std::abs(a[i]) * (std::abs(p) + std::abs(q));
  }
  const double bound = (7 + 56 * kEpsilon) * kEpsilon * permanent;
  if (value > bound) return 1;
  if (value < -bound) return -1;
  return std::nullopt;
}

}  // namespace

bool passes_left(const Line& line, const Corner& a, const Corner& b) {
  const Vec3d pa = to_double(a.point), pb = to_double(b.point);
  const Vec3d to_a = minus(pa, line.origin), to_b = minus(pb, line.origin);
  if (const auto sign = certified_sign(line.direction, to_a, to_b)) return *sign > 0;
  // The edge's own vector instead of b: the same determinant, and a much smaller permanent for a far origin.
  if (const auto sign = certified_sign(line.direction, to_a, minus(pb, pa))) return *sign > 0;

  const BitRange points = bit_range<3>({line.origin, pa, pb});
  const BitRange directions =
      line.through_point ? bit_range<2>({line.origin, line.toward}) : bit_range<1>({line.direction});
  const auto sign = [&]<class Integer>(Integer) {
    const Row<Integer> direction = line.through_point
                                       ? difference<Integer>(line.toward, line.origin, directions.lowest)
                                       : to_integers<Integer>(line.direction, directions.lowest);
    return perturbed_sign<Integer>({direction, difference<Integer>(pa, line.origin, points.lowest),
                                    difference<Integer>(pb, line.origin, points.lowest)},
                                   {kNone, a.id, b.id});
  };
  return (std::max(points.size(), directions.size()) < kNarrowBits ? sign(Narrow{}) : sign(Wide{})) > 0;
}

bool behind(const Corner& a, const Corner& b, const Corner& c, const Vec3d& point) {
  const Vec3d pa = to_double(a.point), pb = to_double(b.point), pc = to_double(c.point);
  if (const auto sign = certified_sign(minus(pa, point), minus(pb, point), minus(pc, point)))
    return *sign > 0;
  const BitRange range = bit_range<4>({pa, pb, pc, point});
  const auto sign = [&]<class Integer>(Integer) {
    return perturbed_sign<Integer>(
        {difference<Integer>(pa, point, range.lowest), difference<Integer>(pb, point, range.lowest),
         difference<Integer>(pc, point, range.lowest)},
        {a.id, b.id, c.id});
  };
  return (range.size() < kNarrowBits ? sign(Narrow{}) : sign(Wide{})) > 0;
}

}  // namespace tetfmt::detail
