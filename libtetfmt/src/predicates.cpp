// SPDX-License-Identifier: MIT
#include "predicates.hpp"

#include <algorithm>
#include <boost/multiprecision/cpp_int.hpp>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

namespace tetfmt::detail {
namespace {

// Products of three differences of float32 values span at most 3 * 278 bits, so 1024 never overflow.
using Integer = boost::multiprecision::number<boost::multiprecision::cpp_int_backend<
    1024, 1024, boost::multiprecision::signed_magnitude, boost::multiprecision::unchecked, void>>;
using Row = std::array<Integer, 3>;
using Matrix = std::array<Row, 3>;

constexpr double kEpsilon = 0x1p-53;

/// value = mantissa * 2^exponent, mantissa of at most 53 bits, odd unless zero.
std::pair<std::int64_t, int> decompose(double value) {
  if (value == 0 || !std::isfinite(value)) return {0, std::numeric_limits<int>::max()};
  int exponent = 0;
  auto mantissa = static_cast<std::int64_t>(std::ldexp(std::frexp(value, &exponent), 53));
  const int zeros = std::countr_zero(static_cast<std::uint64_t>(mantissa));
  return {mantissa >> zeros, exponent - 53 + zeros};
}

/// The largest power of two of which all values are multiples.
template <std::size_t N>
int common_exponent(const std::array<Vec3d, N>& points) {
  int exponent = std::numeric_limits<int>::max();
  for (const Vec3d& point : points)
    for (const double value : point) exponent = std::min(exponent, decompose(value).second);
  return exponent;
}

Row to_integers(const Vec3d& point, int scale) {
  Row row;
  for (std::size_t i = 0; i < 3; ++i) {
    const auto [mantissa, exponent] = decompose(point[i]);
    row[i] = mantissa;
    if (mantissa != 0) row[i] <<= static_cast<unsigned>(exponent - scale);
  }
  return row;
}

Row operator-(const Row& a, const Row& b) {
  return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
}

int determinant_sign(const Matrix& m) {
  const Integer value = m[0][0] * (m[1][1] * m[2][2] - m[1][2] * m[2][1]) +
                        m[0][1] * (m[1][2] * m[2][0] - m[1][0] * m[2][2]) +
                        m[0][2] * (m[1][0] * m[2][1] - m[1][1] * m[2][0]);
  return value.sign();
}

/// Sign of the determinant after perturbing row r as vertex ids[r] (kNone: this row stays). Expanded in
/// powers of e, a term takes the unit vector j for some of the perturbed rows; its power is the sum of
/// 2^(3i+j). Only the order of the ids matters for the order of the powers, so ranks stand in for them. Zero
/// only if no term is left, which needs equal ids or a zero direction.
int perturbed_sign(const Matrix& matrix, const std::array<Index, 3>& ids) {
  if (const int sign = determinant_sign(matrix)) return sign;
  std::array<unsigned, 3> first_bit{};  // of each perturbed row: three bits a row, the smallest id lowest
  unsigned bit_count = 0;
  for (std::size_t r = 0; r < 3; ++r) {
    if (ids[r] == kNone) continue;
    bit_count += 3;
    for (const Index other : ids) first_bit[r] += other < ids[r] ? 3 : 0;
  }
  for (unsigned power = 1; power < 1u << bit_count; ++power) {
    Matrix term = matrix;
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

  const int scale = common_exponent<3>({line.origin, pa, pb});
  const Row origin = to_integers(line.origin, scale);
  Row direction;
  if (line.through_point) {
    const int own = common_exponent<2>({line.origin, line.toward});
    direction = to_integers(line.toward, own) - to_integers(line.origin, own);
  } else {
    direction = to_integers(line.direction, common_exponent<1>({line.direction}));
  }
  return perturbed_sign({direction, to_integers(pa, scale) - origin, to_integers(pb, scale) - origin},
                        {kNone, a.id, b.id}) > 0;
}

bool behind(const Corner& a, const Corner& b, const Corner& c, const Vec3d& point) {
  const Vec3d pa = to_double(a.point), pb = to_double(b.point), pc = to_double(c.point);
  if (const auto sign = certified_sign(minus(pa, point), minus(pb, point), minus(pc, point)))
    return *sign > 0;
  const int scale = common_exponent<4>({pa, pb, pc, point});
  const Row p = to_integers(point, scale);
  return perturbed_sign({to_integers(pa, scale) - p, to_integers(pb, scale) - p, to_integers(pc, scale) - p},
                        {a.id, b.id, c.id}) > 0;
}

}  // namespace tetfmt::detail
