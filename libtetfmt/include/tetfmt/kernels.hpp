// SPDX-License-Identifier: MIT
// The walk's variants, for measuring one against another: arithmetic, basis of the projection, and counts of
// how its signs were decided. Renderers want traverse.hpp, whose kernels are the first of each.
#pragma once

#include <cstdint>

#include "tetfmt/traverse.hpp"

namespace tetfmt {

enum class Arithmetic : std::uint8_t {
  exact,        ///< double, certified by one constant a ray; exact where that does not hold
  float_first,  ///< float, certified by a bound on each vertex; then as `exact`
  float_only,   ///< float as it comes
};

/// How points are projected along the ray (appendix C). All exact arithmetics give the same answers with
/// each.
enum class Basis : std::uint8_t {
  shear,        ///< onto a coordinate plane, along the ray (Woop, Benthin and Wald 2013): 2 products a point
  orthonormal,  ///< two orthogonal unit vectors: 6 products
  specialised,  ///< two orthogonal vectors, scaled so that one component is 0 and two are 1: 3 products; one
                ///< instance of the code for each smallest axis, largest axis and sign
};

struct Variant {
  Arithmetic arithmetic = Arithmetic::exact;
  Basis basis = Basis::shear;
};

/// How many signs each stage decided.
struct SignCounts {
  std::uint64_t in_float = 0;    ///< certified in float, or taken as they came (float_only)
  std::uint64_t in_double = 0;   ///< certified in double, by the constant of the ray
  std::uint64_t in_double2 = 0;  ///< certified in double by the bound of Shewchuk (1997)
  std::uint64_t exact = 0;       ///< by integers
  std::uint64_t tied = 0;        ///< by integers and the tie rule: the line meets an edge or a vertex
};

/// first_hit by another variant. Adds to `counts`, unless it is null.
Hit first_hit(const TrustedView& view, const Location& from, Vec3f direction, const Variant& variant,
              SignCounts* counts = nullptr);

}  // namespace tetfmt
