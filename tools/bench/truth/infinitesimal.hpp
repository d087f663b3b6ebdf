// SPDX-License-Identifier: AGPL-3.0-or-later
// Polynomials in the infinitesimals by which ties are broken, with whole coefficients: the sign of one is the
// sign of its leading term, so that every question that a tie leaves open has one answer.
//
// Simulation of simplicity (Edelsbrunner and Muecke 1990): coordinate k of vertex i is moved by e^(2^(3i+k)).
// A place on a side of a face is moved off the face by d, an infinitesimal that exceeds every power of e.
#pragma once

#include <algorithm>
#include <boost/multiprecision/cpp_int.hpp>
#include <cassert>
#include <cstdint>
#include <span>
#include <vector>

#include "tetfmt/types.hpp"

namespace tetbench {

using Integer = boost::multiprecision::cpp_int;

inline int sign_of(const Integer& value) {
  return value.sign();
}

/// Powers of e above and of d in the lowest three bits; products add, and more is smaller.
using Power = std::uint64_t;
inline constexpr Power kOff = 1;  ///< d; no product here has more than six of it

/// The powers of e that belong to a few vertices. Vertex ids are up to 2^31, but only their order matters and
/// whether they are neighbours (e_i,2 squared is e_(i+1),0): larger gaps are closed to one unused id.
class PowersOf {
 public:
  /// At most six ids; may repeat.
  explicit PowersOf(std::vector<tetfmt::Index> ids) : ids_(std::move(ids)) {
    std::sort(ids_.begin(), ids_.end());
    ids_.erase(std::unique(ids_.begin(), ids_.end()), ids_.end());
    assert(ids_.size() <= 6);  // 11 slots of 3 bits, a carry, and 3 bits of d
    for (std::size_t i = 0; i < ids_.size(); ++i)
      slots_.push_back(i == 0 ? 0 : slots_.back() + (ids_[i] - ids_[i - 1] == 1 ? 1U : 2U));
  }
  Power operator()(tetfmt::Index id, std::size_t k) const {
    const auto at = std::lower_bound(ids_.begin(), ids_.end(), id) - ids_.begin();
    return Power{8} << (3 * slots_[static_cast<std::size_t>(at)] + k);
  }

 private:
  std::vector<tetfmt::Index> ids_;
  std::vector<unsigned> slots_;
};

class Polynomial {
 public:
  struct Term {
    Power power = 0;
    Integer factor;
  };
  Polynomial() = default;
  explicit Polynomial(const Integer& constant) { add(0, constant); }
  /// Only in ascending order of powers.
  void add(Power power, const Integer& factor) {
    if (factor != 0) terms_.push_back({power, factor});
  }

  /// The largest term; null for zero.
  const Term* leading() const { return terms_.empty() ? nullptr : &terms_.front(); }
  int sign() const { return terms_.empty() ? 0 : sign_of(terms_.front().factor); }
  std::span<const Term> terms() const { return terms_; }

  friend Polynomial operator-(const Polynomial& a, const Polynomial& b) {
    std::vector<Term> terms = a.terms_;
    for (const Term& term : b.terms_) terms.push_back({term.power, -term.factor});
    return collected(std::move(terms));
  }
  friend Polynomial operator+(const Polynomial& a, const Polynomial& b) {
    std::vector<Term> terms = a.terms_;
    terms.insert(terms.end(), b.terms_.begin(), b.terms_.end());
    return collected(std::move(terms));
  }
  friend Polynomial operator*(const Polynomial& a, const Polynomial& b) {
    std::vector<Term> terms;
    terms.reserve(a.terms_.size() * b.terms_.size());
    for (const Term& x : a.terms_)
      for (const Term& y : b.terms_) terms.push_back({x.power + y.power, x.factor * y.factor});
    return collected(std::move(terms));
  }
  /// Sign of a b - c d. Mostly the largest few terms decide it.
  friend int sign_of_difference(const Polynomial& a, const Polynomial& b, const Polynomial& c,
                                const Polynomial& d) {
    for (std::size_t count = 4;; count *= 4) {
      // Terms that are left out are no larger than this.
      Power rest =
          std::min({a.left_out(count, b), b.left_out(count, a), c.left_out(count, d), d.left_out(count, c)});
      const Polynomial part = a.largest(count) * b.largest(count) - c.largest(count) * d.largest(count);
      if (const Term* const term = part.leading(); term && term->power < rest) return sign_of(term->factor);
      if (rest == kNothing) return 0;
    }
  }

 private:
  static constexpr Power kNothing = ~Power{0};
  Power left_out(std::size_t count, const Polynomial& times) const {
    return count < terms_.size() && !times.terms_.empty() ? terms_[count].power + times.terms_[0].power
                                                          : kNothing;
  }
  Polynomial largest(std::size_t count) const {
    Polynomial result;
    result.terms_.assign(terms_.begin(),
                         terms_.begin() + static_cast<std::ptrdiff_t>(std::min(count, terms_.size())));
    return result;
  }
  static Polynomial collected(std::vector<Term>&& terms) {
    std::sort(terms.begin(), terms.end(), [](const Term& a, const Term& b) { return a.power < b.power; });
    Polynomial result;
    for (Term& term : terms) {
      if (!result.terms_.empty() && result.terms_.back().power == term.power) {
        result.terms_.back().factor += term.factor;
        if (result.terms_.back().factor == 0) result.terms_.pop_back();
      } else if (term.factor != 0) {
        result.terms_.push_back(std::move(term));
      }
    }
    return result;
  }
  std::vector<Term> terms_;  ///< ascending powers, no zero factors
};

}  // namespace tetbench
