// SPDX-License-Identifier: AGPL-3.0-or-later
#include "bench/truth/exact_line.hpp"

#include <bit>
#include <cmath>
#include <limits>

namespace tetbench {
namespace {

using tetfmt::Index;

constexpr double kUnit = 0x1p-53;

template <class N>
using Row = std::array<N, 3>;

template <class N>
Row<N> cross(const Row<N>& a, const Row<N>& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
template <class N>
N dot(const Row<N>& a, const Row<N>& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}
template <class N>
Row<N> minus(const Row<N>& a, const Row<N>& b) {
  return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
}
template <class N>
int sign(const N& value) {
  return (value > 0) - (value < 0);
}

Vec3d wide(const tetfmt::Vec3f& v) {
  return {static_cast<double>(v.x), static_cast<double>(v.y), static_cast<double>(v.z)};
}

/// value = mantissa * 2^exponent; mantissa odd, or zero. Finite values only.
struct Binary {
  std::int64_t mantissa = 0;
  int exponent = 0;
};
Binary binary(double value) {
  if (value == 0) return {};
  int exponent = 0;
  auto mantissa = static_cast<std::int64_t>(std::ldexp(std::frexp(value, &exponent), 53));
  const int zeros = std::countr_zero(static_cast<std::uint64_t>(mantissa));
  return {mantissa >> zeros, exponent - 53 + zeros};
}

/// The exponent of the lowest bit of three numbers; `none` if all are zero.
int lowest_bit(const Vec3d& values, int none) {
  int lowest = std::numeric_limits<int>::max();
  for (const double value : values)
    if (value != 0) lowest = std::min(lowest, binary(value).exponent);
  return lowest == std::numeric_limits<int>::max() ? none : lowest;
}

Integer in_units(double value, int unit) {
  const auto [mantissa, exponent] = binary(value);
  return mantissa == 0 ? Integer(0) : Integer(mantissa) << static_cast<unsigned>(exponent - unit);
}

/// a / b to about 60 bits.
double ratio(const Integer& a, const Integer& b) {
  if (a == 0) return 0;
  const Integer over = abs(a), under = abs(b);
  const int shift = 64 + static_cast<int>(msb(under)) - static_cast<int>(msb(over));
  const Integer quotient = shift >= 0 ? Integer((over << static_cast<unsigned>(shift)) / under)
                                      : Integer(over / (under << static_cast<unsigned>(-shift)));
  const double value = std::ldexp(quotient.convert_to<double>(), -shift);
  return (a < 0) != (b < 0) ? -value : value;
}

/// det[e_j, e_k, r]: plus or minus the component that is neither, or 0.
template <class N>
N beside(std::size_t j, std::size_t k, const Row<N>& r) {
  if (j == k) return N(0);
  return k == (j + 1) % 3 ? N(r[3 - j - k]) : N(-r[3 - j - k]);
}

/// Which axis a row is moved along in a term, if it is.
constexpr std::size_t kStays = 3;

/// Calls take(b's axis, a's axis, factor) for the terms of det[d, a, b] in descending size, until it returns
/// true; a is relative to the line's origin and of the smaller id.
template <class N, class Take>
void edge_terms(const Row<N>& d, const Row<N>& a, const Row<N>& b, const Take& take) {
  if (take(kStays, kStays, dot(d, cross(a, b)))) return;
  const Row<N> of_a = cross(b, d), of_b = cross(d, a);
  for (std::size_t j = 0; j < 3; ++j)
    if (take(kStays, j, of_a[j])) return;
  for (std::size_t k = 0; k < 3; ++k) {
    if (take(k, kStays, of_b[k])) return;
    for (std::size_t j = 0; j < 3; ++j)
      if (take(k, j, beside(j, k, d))) return;
  }
}

/// The same for det[a, b, c] with ids that ascend: take(c's, b's, a's axis, factor).
template <class N, class Take>
void height_terms(const Row<N>& a, const Row<N>& b, const Row<N>& c, const Take& take) {
  const Row<N> bc = cross(b, c), ca = cross(c, a), ab = cross(a, b);
  const auto axes = {kStays, std::size_t{0}, std::size_t{1}, std::size_t{2}};
  for (const std::size_t l : axes)
    for (const std::size_t k : axes)
      for (const std::size_t j : axes) {
        N factor(0);
        if (l == kStays && k == kStays)
          factor = j == kStays ? dot(a, bc) : bc[j];
        else if (l == kStays)
          factor = j == kStays ? ca[k] : beside(j, k, c);
        else if (k == kStays)
          factor = j == kStays ? ab[l] : beside(l, j, b);
        else if (j == kStays)
          factor = beside(k, l, a);
        else if (j != k)
          factor = beside(j, k, Row<N>{N(l == 0 ? 1 : 0), N(l == 1 ? 1 : 0), N(l == 2 ? 1 : 0)});
        if (take(l, k, j, factor)) return;
      }
}

template <class N>
int perturbed_edge(const Row<N>& d, const Row<N>& a, const Row<N>& b) {
  int result = 0;
  edge_terms(d, a, b,
             [&](std::size_t, std::size_t, const N& factor) { return (result = sign(factor)) != 0; });
  return result;
}
template <class N>
int perturbed_height(const Row<N>& a, const Row<N>& b, const Row<N>& c) {
  int result = 0;
  height_terms(a, b, c, [&](std::size_t, std::size_t, std::size_t, const N& factor) {
    return (result = sign(factor)) != 0;
  });
  return result;
}

/// The three corners by ascending id, and whether that turned the face over.
struct Ascending {
  Face ids;
  bool odd = false;
  explicit Ascending(const Face& face) : ids(face) {
    for (const auto& [i, j] : {std::pair{0, 1}, std::pair{1, 2}, std::pair{0, 1}})
      if (ids[static_cast<std::size_t>(i)] > ids[static_cast<std::size_t>(j)]) {
        std::swap(ids[static_cast<std::size_t>(i)], ids[static_cast<std::size_t>(j)]);
        odd = !odd;
      }
  }
};

Polynomial determinant(const Row<Polynomial>& a, const Row<Polynomial>& b, const Row<Polynomial>& c) {
  return dot(a, cross(b, c));
}

/// The unevaluated sum high + low.
struct Double2 {
  double high = 0, low = 0;
};
Double2 two_sum(double a, double b) {
  const double sum = a + b, part = sum - a;
  return {sum, (a - (sum - part)) + (b - part)};
}
Double2 operator+(const Double2& a, const Double2& b) {
  const Double2 high = two_sum(a.high, b.high), low = two_sum(a.low, b.low);
  const Double2 first = two_sum(high.high, high.low + low.high);
  return two_sum(first.high, first.low + low.low);
}
Double2 times(const Double2& a, double b) {
  const double product = a.high * b;
  return two_sum(product, std::fma(a.high, b, -product) + a.low * b);
}

}  // namespace

ExactLine::ExactLine(const Surface& surface, const Place& from, const Vec3d& direction)
    : surface_(surface), from_(from), origin_(from.position), direction_(direction) {}

ExactLine::ExactLine(const Surface& surface, const Place& from, const Place& to)
    : ExactLine(surface, from, minus(to.position, from.position)) {
  to_ = to;
}

const WholeLine& ExactLine::whole() const {
  if (whole_) return *whole_;
  WholeLine& w = whole_.emplace();
  // At most 0, so that a power of e, which moves vertices by local units, is a whole number of them.
  w.unit = std::min({0, surface_.grid_exponent, lowest_bit(origin_, 0)});
  if (to_) w.unit = std::min(w.unit, lowest_bit(to_->position, 0));
  w.direction_unit = to_ ? w.unit : lowest_bit(direction_, 0);
  w.vertex_shift = static_cast<unsigned>(surface_.grid_exponent - w.unit);
  for (std::size_t k = 0; k < 3; ++k) {
    w.origin[k] = in_units(origin_[k], w.unit);
    w.direction[k] =
        to_ ? in_units(to_->position[k], w.unit) - w.origin[k] : in_units(direction_[k], w.direction_unit);
    w.origin_off[k] = from_.off[k];
    if (to_) w.direction_off[k] = Integer(to_->off[k]) - from_.off[k];
    w.off = w.off || w.origin_off[k] != 0 || w.direction_off[k] != 0;
  }
  const Integer limit = Integer(1) << 39;
  w.narrow = !w.off && w.vertex_shift < 15;
  for (std::size_t k = 0; k < 3; ++k)
    w.narrow = w.narrow && abs(w.origin[k]) < limit && abs(w.direction[k]) < limit;
  for (std::size_t k = 0; k < 3 && w.narrow; ++k) {
    w.narrow_origin[k] = w.origin[k].convert_to<std::int64_t>();
    w.narrow_direction[k] = w.direction[k].convert_to<std::int64_t>();
  }
  return w;
}

std::array<Integer, 3> ExactLine::from_origin(Index vertex) const {
  const WholeLine& w = whole();
  const GridPoint& p = surface_.grid[vertex];
  return {(Integer(p[0]) << w.vertex_shift) - w.origin[0], (Integer(p[1]) << w.vertex_shift) - w.origin[1],
          (Integer(p[2]) << w.vertex_shift) - w.origin[2]};
}

std::array<Wide, 3> ExactLine::narrow_from_origin(Index vertex) const {
  const WholeLine& w = whole();
  const GridPoint& p = surface_.grid[vertex];
  const Wide step = Wide{1} << w.vertex_shift;
  return {p[0] * step - w.narrow_origin[0], p[1] * step - w.narrow_origin[1],
          p[2] * step - w.narrow_origin[2]};
}

std::array<Polynomial, 3> ExactLine::perturbed(Index vertex, const PowersOf& powers) const {
  const WholeLine& w = whole();
  const auto point = from_origin(vertex);
  std::array<Polynomial, 3> row;
  for (std::size_t k = 0; k < 3; ++k) {
    row[k].add(0, point[k]);
    row[k].add(kOff, -w.origin_off[k]);
    row[k].add(powers(vertex, k), Integer(1) << static_cast<unsigned>(-w.unit));
  }
  return row;
}

std::array<Polynomial, 3> ExactLine::perturbed_direction() const {
  const WholeLine& w = whole();
  std::array<Polynomial, 3> row;
  for (std::size_t k = 0; k < 3; ++k) {
    row[k].add(0, w.direction[k]);
    row[k].add(kOff, w.direction_off[k]);
  }
  return row;
}

int ExactLine::edge(Index a, Index b) const {
  if (a > b) return -edge(b, a);
  const WholeLine& w = whole();
  if (w.narrow) {
    const Row<Wide> d = {w.narrow_direction[0], w.narrow_direction[1], w.narrow_direction[2]};
    return perturbed_edge(d, narrow_from_origin(a), narrow_from_origin(b));
  }
  const auto p = from_origin(a), q = from_origin(b);
  if (!w.off) return perturbed_edge(w.direction, p, q);
  if (const int constant = sign(dot(w.direction, cross(p, q)))) return constant;
  const PowersOf powers({a, b});
  return determinant(perturbed_direction(), perturbed(a, powers), perturbed(b, powers)).sign();
}

int ExactLine::edge_as_it_is(Index a, Index b) const {
  return sign(dot(whole().direction, cross(from_origin(a), from_origin(b))));
}

int ExactLine::crosses(const Face& face) const {
  // Differences, and a direction between two places, have one rounding a component; then a product of three
  // has two more and three sums: eight in all, below 9 * 2^-53 of the sum of absolute values, in whose own
  // computation as many are lost. 2^-49 = 16 * 2^-53.
  const Vec3d a = minus(wide(surface_.vertices[face[0]]), origin_);
  const Vec3d b = minus(wide(surface_.vertices[face[1]]), origin_);
  const Vec3d c = minus(wide(surface_.vertices[face[2]]), origin_);
  const Vec3d& d = direction_;
  const Vec3d size = {std::abs(d[0]), std::abs(d[1]), std::abs(d[2])};
  const auto estimate = [&](const Vec3d& p, const Vec3d& q) {
    const double x = p[1] * q[2], x2 = p[2] * q[1], y = p[2] * q[0], y2 = p[0] * q[2], z = p[0] * q[1],
                 z2 = p[1] * q[0];
    const double value = d[0] * (x - x2) + d[1] * (y - y2) + d[2] * (z - z2);
    const double bound =
        0x1p-49 * (size[0] * (std::abs(x) + std::abs(x2)) + size[1] * (std::abs(y) + std::abs(y2)) +
                   size[2] * (std::abs(z) + std::abs(z2)));
    return value > bound ? 1 : value < -bound ? -1 : 0;
  };
  std::array<int, 3> signs = {estimate(a, b), estimate(b, c), estimate(c, a)};
  const auto parted = [&] {
    const auto [low, high] = std::minmax({signs[0], signs[1], signs[2]});
    return low < 0 && high > 0;
  };
  for (std::size_t k = 0; k < 3; ++k) {
    if (parted()) return 0;
    if (signs[k] == 0) signs[k] = edge(face[k], face[(k + 1) % 3]);
  }
  return parted() ? 0 : signs[0];
}

bool ExactLine::touches(const Face& face) const {
  std::array<int, 3> signs{};
  for (std::size_t k = 0; k < 3; ++k) signs[k] = edge_as_it_is(face[k], face[(k + 1) % 3]);
  const auto [low, high] = std::minmax({signs[0], signs[1], signs[2]});
  if (low == 0 && high == 0) return exact_over(face) == 0;
  return low == 0 || high == 0 || low == high;
}

bool ExactLine::crosses_inside(const Face& face) const {
  const int first = edge_as_it_is(face[0], face[1]);
  return first != 0 && edge_as_it_is(face[1], face[2]) == first && edge_as_it_is(face[2], face[0]) == first;
}

// The normal is exact in double. Each product loses what its other factor and the multiplication lose, each
// of two sums one more: 4 roundings; 2^-50 is 8.
ExactLine::Estimate ExactLine::estimated_over(const Face& face) const {
  const GridPoint n = surface_.normal(face);
  const Vec3d a = minus(wide(surface_.vertices[face[0]]), origin_);
  const double x = static_cast<double>(n[0]) * a[0], y = static_cast<double>(n[1]) * a[1],
               z = static_cast<double>(n[2]) * a[2];
  return {x + y + z, 0x1p-50 * (std::abs(x) + std::abs(y) + std::abs(z))};
}
ExactLine::Estimate ExactLine::estimated_under(const Face& face) const {
  const GridPoint n = surface_.normal(face);
  const double x = static_cast<double>(n[0]) * direction_[0], y = static_cast<double>(n[1]) * direction_[1],
               z = static_cast<double>(n[2]) * direction_[2];
  return {x + y + z, 0x1p-50 * (std::abs(x) + std::abs(y) + std::abs(z))};
}

Integer ExactLine::exact_over(const Face& face) const {
  const GridPoint n = surface_.normal(face);
  const auto a = from_origin(face[0]);
  return a[0] * n[0] + a[1] * n[1] + a[2] * n[2];
}
Integer ExactLine::exact_under(const Face& face) const {
  const GridPoint n = surface_.normal(face);
  const WholeLine& w = whole();
  return w.direction[0] * n[0] + w.direction[1] * n[1] + w.direction[2] * n[2];
}

Polynomial ExactLine::under_of_edge(Index a, Index b, const PowersOf& powers) const {
  const auto step = static_cast<unsigned>(-whole().unit);
  const auto power = [&](Index id, std::size_t axis) { return axis == kStays ? Power{0} : powers(id, axis); };
  const bool swapped = a > b;
  if (swapped) std::swap(a, b);
  Polynomial result;
  edge_terms(whole().direction, from_origin(a), from_origin(b),
             [&](std::size_t k, std::size_t j, const Integer& factor) {
               const unsigned moves = (j == kStays ? 0U : 1U) + (k == kStays ? 0U : 1U);
               result.add(power(b, k) + power(a, j), (swapped ? Integer(-factor) : factor) << (moves * step));
               return false;
             });
  return result;
}

ExactLine::Fraction ExactLine::fraction(const Face& face, const PowersOf& powers) const {
  if (whole().off) {
    const auto a = perturbed(face[0], powers), b = perturbed(face[1], powers), c = perturbed(face[2], powers);
    return {determinant(a, b, c), determinant(perturbed_direction(), minus(b, a), minus(c, a))};
  }
  const auto step = static_cast<unsigned>(-whole().unit);
  const Ascending sorted(face);
  const auto& ids = sorted.ids;
  Fraction result;
  height_terms(from_origin(ids[0]), from_origin(ids[1]), from_origin(ids[2]),
               [&](std::size_t l, std::size_t k, std::size_t j, const Integer& factor) {
                 Power power = 0;
                 unsigned moves = 0;
                 const std::array<std::size_t, 3> axes = {j, k, l};
                 for (std::size_t i = 0; i < 3; ++i) {
                   if (axes[i] == kStays) continue;
                   power += powers(ids[i], axes[i]);
                   ++moves;
                 }
                 result.over.add(power, (sorted.odd ? Integer(-factor) : factor) << (moves * step));
                 return false;
               });
  result.under = under_of_edge(face[0], face[1], powers) + under_of_edge(face[1], face[2], powers) +
                 under_of_edge(face[2], face[0], powers);
  return result;
}

ExactLine::Range ExactLine::parameter(const Face& face) const {
  const Estimate over = estimated_over(face), under = estimated_under(face);
  if (std::abs(under.value) > 0x1p20 * under.error) {
    const double t = over.value / under.value;
    const double error =
        1.001 * (over.error + std::abs(t) * under.error) / std::abs(under.value) + 4 * kUnit * std::abs(t);
    return {t - error, t + error};
  }
  const WholeLine& w = whole();
  double t = 0;
  if (const Integer exact = exact_under(face); exact != 0) {
    t = ratio(exact_over(face), exact);
  } else {
    const Fraction f = fraction(face, PowersOf({face[0], face[1], face[2]}));
    const auto *n = f.over.leading(), *d = f.under.leading();
    if (n && d && n->power == d->power) t = ratio(n->factor, d->factor);  // else infinitely small: 0
  }
  t = std::ldexp(t, w.unit - w.direction_unit);
  const double error = 0x1p-50 * std::abs(t);
  return {t - error, t + error};
}

int ExactLine::compare(const Face& a, const Face& b) const {
  const Range p = parameter(a), q = parameter(b);
  if (p.high < q.low) return -1;
  if (q.high < p.low) return 1;
  const Integer under_a = exact_under(a), under_b = exact_under(b);
  if (under_a != 0 && under_b != 0) {
    const int order = sign(Integer(exact_over(a) * under_b - exact_over(b) * under_a));
    if (order != 0) return order * sign(under_a) * sign(under_b);
  }
  const PowersOf powers({a[0], a[1], a[2], b[0], b[1], b[2]});
  const Fraction x = fraction(a, powers), y = fraction(b, powers);
  return sign_of_difference(x.over, y.under, y.over, x.under) * x.under.sign() * y.under.sign();
}

int ExactLine::compare(const Face& face, double t) const {
  const Range range = parameter(face);
  if (range.high < t) return -1;
  if (range.low > t) return 1;
  // over - t * under is the determinant seen from origin + t * direction.
  const int under = crosses(face);
  if (t == 0) return height(face) * under;
  const WholeLine& w = whole();
  const auto [mantissa, exponent] = binary(t);
  const int moved = w.direction_unit + exponent, unit = std::min(w.unit, moved);
  std::array<Integer, 3> origin, off;
  for (std::size_t k = 0; k < 3; ++k) {
    origin[k] = (w.origin[k] << static_cast<unsigned>(w.unit - unit)) +
                (w.direction[k] * mantissa << static_cast<unsigned>(moved - unit));
    // Directions differ by d between two places only, and then t is 0 or 1.
    off[k] = w.origin_off[k] + (t == 1 ? w.direction_off[k] : Integer(0));
  }
  return height_from(face, origin, off, unit) * under;
}

int ExactLine::height(const Face& face) const {
  const Estimate estimate = estimated_over(face);
  if (std::abs(estimate.value) > estimate.error) return sign(estimate.value);
  const WholeLine& w = whole();
  if (w.narrow) {
    const Ascending sorted(face);
    std::array<Row<Wide>, 3> rows;
    for (std::size_t i = 0; i < 3; ++i) rows[i] = narrow_from_origin(sorted.ids[i]);
    const int result = perturbed_height(rows[0], rows[1], rows[2]);
    return sorted.odd ? -result : result;
  }
  return height_from(face, w.origin, w.origin_off, w.unit);
}

int ExactLine::height_from(const Face& face, const std::array<Integer, 3>& origin,
                           const std::array<Integer, 3>& off, int unit) const {
  const Ascending sorted(face);
  std::array<Row<Integer>, 3> rows;
  const auto shift = static_cast<unsigned>(surface_.grid_exponent - unit);
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t k = 0; k < 3; ++k)
      rows[i][k] = (Integer(surface_.grid[sorted.ids[i]][k]) << shift) - origin[k];
  int result = 0;
  if (off == std::array<Integer, 3>{}) {
    result = perturbed_height(rows[0], rows[1], rows[2]);
  } else {
    result = sign(dot(rows[0], cross(rows[1], rows[2])));
    if (result == 0)
      result = -sign(Integer(dot(off, cross(rows[1], rows[2])) + dot(off, cross(rows[2], rows[0])) +
                             dot(off, cross(rows[0], rows[1]))));
    if (result == 0) {
      // As far as needed: off has one more term than the others.
      const PowersOf powers({face[0], face[1], face[2]});
      std::array<Row<Polynomial>, 3> moved;
      for (std::size_t i = 0; i < 3; ++i)
        for (std::size_t k = 0; k < 3; ++k) {
          moved[i][k].add(0, rows[i][k]);
          moved[i][k].add(kOff, -off[k]);
          moved[i][k].add(powers(sorted.ids[i], k), Integer(1) << static_cast<unsigned>(-unit));
        }
      result = determinant(moved[0], moved[1], moved[2]).sign();
    }
  }
  return sorted.odd ? -result : result;
}

bool ExactLine::starts_in(const std::array<Index, 4>& tet) const {
  // The tetrahedron's own orientation; replacing any vertex by the origin must not change it.
  const Place apex{wide(surface_.vertices[tet[3]]), {}};
  const int positive = sign(ExactLine(surface_, apex, Vec3d{}).exact_over({tet[0], tet[1], tet[2]}));
  return positive != 0 && height({tet[0], tet[1], tet[2]}) == positive &&
         height({tet[0], tet[1], tet[3]}) == -positive && height({tet[0], tet[2], tet[3]}) == positive &&
         height({tet[1], tet[2], tet[3]}) == -positive;
}

double ExactLine::ulps_off(const Face& face, double t) const {
  const GridPoint n = surface_.normal(face);
  const Vec3d vertex = wide(surface_.vertices[face[0]]);
  Double2 over, under;
  double over_size = 0, under_size = 0;
  for (std::size_t k = 0; k < 3; ++k) {
    const auto nk = static_cast<double>(n[k]);
    over = over + times(two_sum(vertex[k], -origin_[k]), nk);
    under = under + times({direction_[k], 0}, nk);
    over_size += std::abs(over.high);
    under_size += std::abs(under.high);
  }
  double error = 0, exact = 0;
  // The sums are good to 2^-100 of their terms: enough unless all but 2^-40 of them cancelled.
  if (!to_ && std::abs(over.high) > 0x1p-40 * over_size && std::abs(under.high) > 0x1p-40 * under_size) {
    const Double2 left = over + times({-under.high, -under.low}, t);
    error = std::abs(left.high / under.high);
    exact = over.high / under.high;
  } else {
    const WholeLine& w = whole();
    const Integer exact_n = exact_over(face), exact_d = exact_under(face);
    const auto [mantissa, exponent] = binary(t);
    const int left = w.unit - w.direction_unit, lowest = std::min(left, exponent);
    const Integer residual = (exact_n << static_cast<unsigned>(left - lowest)) -
                             exact_d * (Integer(mantissa) << static_cast<unsigned>(exponent - lowest));
    error = std::abs(std::ldexp(ratio(residual, exact_d), lowest));
    exact = std::ldexp(ratio(exact_n, exact_d), left);
  }
  if (error == 0) return 0;
  if (exact == 0) return std::numeric_limits<double>::infinity();
  return error / std::ldexp(1.0, std::max(std::ilogb(exact), -1022) - 52);
}

double ExactLine::sine(const Face& face) const {
  const GridPoint n = surface_.normal(face);
  const Estimate under = estimated_under(face);
  if (std::abs(under.value) <= under.error && exact_under(face) == 0) return 0;
  const double length =
      std::hypot(static_cast<double>(n[0]), static_cast<double>(n[1]), static_cast<double>(n[2])) *
      std::hypot(direction_[0], direction_[1], direction_[2]);
  return std::abs(under.value) / length;
}

}  // namespace tetbench
