// SPDX-License-Identifier: MIT
// Every variant of one walk: the same source, chosen at compile time.
#include "tetfmt/kernels.hpp"

#include "follow.hpp"

namespace tetfmt {
namespace {

using namespace detail;

struct Query {
  const FileView& view;
  const Location& from;
  const Line& line;
};

template <template <class> class Projection, class Counts>
Hit walk_variant(const Query& query, Arithmetic arithmetic, const Counts& counts) {
  const FileView& view = query.view;
  const Location& from = query.from;
  const Line& line = query.line;  // no structured binding: clang 14 does not capture those
  return with_cells(view, [&](const auto& cells) {
    const ExactSigns<Projection, Counts> exact(line, view.bounds(), view.vertices(), counts);
    const auto go = [&](const auto& signs) {
      Hit hit;
      const Followed followed = follow<false>(
          view, cells, line, from, exact, signs, [](const Leaving&) { return false; },
          [&](const Leaving& leaving) {
            describe_hit(view, line, leaving, hit);
            return true;
          });
      if (followed.outcome != Outcome::hit) hit.outcome = followed.outcome;
      hit.steps = followed.steps;
      return hit;
    };
    switch (arithmetic) {
      case Arithmetic::float_only:
        return go(FloatSigns<Projection, Counts>(exact, view.bounds()));
      case Arithmetic::float_first:
        return go(FloatFirstSigns<Projection, Counts>(exact, view.bounds()));
      case Arithmetic::exact:
        break;
    }
    return go(exact);
  });
}

/// The instance of the specialised basis for the direction's axes and signs, found one property at a time.
template <std::size_t kSmallest, std::size_t kLargest, class Counts>
Hit with_turn(const Query& query, Arithmetic arithmetic, const Counts& counts) {
  if (Specialised<kSmallest, kLargest, 1>::template Projection<double>::turn(query.line.direction) > 0)
    return walk_variant<Specialised<kSmallest, kLargest, 1>::template Projection>(query, arithmetic, counts);
  return walk_variant<Specialised<kSmallest, kLargest, -1>::template Projection>(query, arithmetic, counts);
}

template <std::size_t kLargest, class Counts>
Hit with_smallest(std::size_t smallest, const Query& query, Arithmetic arithmetic, const Counts& counts) {
  constexpr std::size_t kNext = (kLargest + 1) % 3, kLast = (kLargest + 2) % 3;
  return smallest == kNext ? with_turn<kNext, kLargest>(query, arithmetic, counts)
                           : with_turn<kLast, kLargest>(query, arithmetic, counts);
}

template <class Counts>
Hit dispatch(const Query& query, const Variant& variant, const Counts& counts) {
  switch (variant.basis) {
    case Basis::orthonormal:
      return walk_variant<OrthonormalProjection>(query, variant.arithmetic, counts);
    case Basis::specialised: {
      const Axes axes(query.line.direction);
      if (axes.largest == 0) return with_smallest<0>(axes.smallest, query, variant.arithmetic, counts);
      if (axes.largest == 1) return with_smallest<1>(axes.smallest, query, variant.arithmetic, counts);
      return with_smallest<2>(axes.smallest, query, variant.arithmetic, counts);
    }
    case Basis::shear:
      break;
  }
  return walk_variant<ShearProjection>(query, variant.arithmetic, counts);
}

}  // namespace

Hit first_hit(const TrustedView& view, const Location& from, Vec3f direction, const Variant& variant,
              SignCounts* counts) {
  Hit hit;
  if (from.state == Location::State::corrupt) hit.outcome = Outcome::corrupt;
  if (from.state == Location::State::absent) hit.outcome = Outcome::absent;
  if (hit.outcome != Outcome::miss) return hit;
  const Line line = line_from(view.view(), from, direction);
  if (!can_be_followed(line)) return hit;
  const Query query{view.view(), from, line};
  return counts ? dispatch(query, variant, Counting(*counts)) : dispatch(query, variant, NoCounts{});
}

}  // namespace tetfmt
