// SPDX-License-Identifier: AGPL-3.0-or-later
// Every variant of the walk: each arithmetic with each basis of the projection gives one and the same answer,
// every sign that an arithmetic certifies is the exact one, and each sign is counted once.
#include "tetfmt/kernels.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <random>
#include <set>
#include <tuple>

#include "projection.hpp"
#include "signs.hpp"
#include "support/box_scene.hpp"

namespace tetfmt_test {
namespace {

using namespace tetfmt;

constexpr Basis kBases[] = {Basis::shear, Basis::orthonormal, Basis::specialised};
constexpr Arithmetic kArithmetics[] = {Arithmetic::exact, Arithmetic::float_first, Arithmetic::float_only};

std::uint64_t total(const SignCounts& counts) {
  return counts.in_float + counts.in_double + counts.in_double2 + counts.exact + counts.tied;
}

/// The instance of the specialised basis that suits a direction: smallest axis, largest axis, turn.
using Instance = std::tuple<std::size_t, std::size_t, int>;
template <std::size_t kSmallest, std::size_t kLargest>
int turn_of(const detail::Vec3d& d) {
  return detail::Specialised<kSmallest, kLargest, 1>::template Projection<double>::turn(d);
}
Instance instance_of(const Vec3f& direction) {
  const detail::Vec3d d = detail::to_vec3d(direction);
  const detail::Axes axes(d);
  const std::map<std::pair<std::size_t, std::size_t>, int (*)(const detail::Vec3d&)> turns = {
      {{0, 1}, turn_of<0, 1>}, {{0, 2}, turn_of<0, 2>}, {{1, 0}, turn_of<1, 0>},
      {{1, 2}, turn_of<1, 2>}, {{2, 0}, turn_of<2, 0>}, {{2, 1}, turn_of<2, 1>}};
  return {axes.smallest, axes.largest, turns.at({axes.smallest, axes.largest})(d)};
}

class Kernels : public ::testing::TestWithParam<bool> {
 protected:
  /// All variants of both layouts give the plain first_hit, bit for bit. `float_too`: float_only as well.
  void expect_one_answer(const Location& from, const Vec3f& direction, bool float_too) {
    const Hit expected = scene_.first_hit(from, direction);
    std::optional<std::uint64_t> signs;
    for (const TrustedView* view : {&scene_.trusted20, &scene_.trusted16}) {
      for (const Basis basis : kBases) {
        for (const Arithmetic arithmetic : kArithmetics) {
          SignCounts counts;
          const Hit plain = first_hit(*view, from, direction, Variant{arithmetic, basis}),
                    counted = first_hit(*view, from, direction, Variant{arithmetic, basis}, &counts);
          ASSERT_TRUE(same(plain, counted));
          ASSERT_LE(plain.steps, view->view().tet_count() + 1);
          if (arithmetic == Arithmetic::float_only && !float_too) continue;
          ASSERT_TRUE(same(plain, expected)) << static_cast<int>(basis) << ' ' << static_cast<int>(arithmetic)
                                             << " met " << plain.triangle << ", not " << expected.triangle;
          // The same walk asks for the same signs, however they are decided.
          if (!signs) signs = total(counts);
          ASSERT_EQ(total(counts), *signs);
          if (from.state == Location::State::inside && from.face == Location::kNoFace) {
            ASSERT_EQ(*signs,
                      6 + 2 * (std::uint64_t{plain.steps} - 1));  // six edges at first, then two a step
          }
          if (arithmetic == Arithmetic::exact) {
            ASSERT_EQ(counts.in_float, 0u);
          }
          if (arithmetic == Arithmetic::float_only && from.state == Location::State::inside &&
              from.face == Location::kNoFace) {
            ASSERT_EQ(counts.in_float, 2 * (std::uint64_t{plain.steps} - 1));  // but the first step is exact
          }
          all_.in_float += counts.in_float;
          all_.in_double += counts.in_double;
          all_.in_double2 += counts.in_double2;
          all_.exact += counts.exact;
          all_.tied += counts.tied;
        }
      }
    }
    reached_.insert(instance_of(direction));
  }

  const BoxScene scene_{6, GetParam()};
  std::mt19937 random_{1};
  std::set<Instance> reached_;
  SignCounts all_;
};
INSTANTIATE_TEST_SUITE_P(, Kernels, ::testing::Bool(),
                         [](const auto& given) { return given.param ? "Sheared" : "Straight"; });

TEST_P(Kernels, AllGiveOneAnswerOnGenericRays) {
  std::uniform_real_distribution<float> any(-2, 8), toward(-1, 1);
  for (int i = 0; i < 3000; ++i) {
    const Location from = scene_.locate(scene_.near({any(random_), any(random_), any(random_)}));
    expect_one_answer(from, {toward(random_), toward(random_), toward(random_)}, true);
    if (HasFatalFailure()) return;
  }
  EXPECT_EQ(reached_.size(), 12u);
  EXPECT_GT(all_.in_float, 100000u);
  EXPECT_GT(all_.in_double, 100000u);
}

// Rays of whole numbers, where a third of all signs are ties, and rays that start on sides of faces.
TEST_P(Kernels, AllExactOnesGiveOneAnswerOnTies) {
  const auto between = [&](int low, int high) {
    return low + static_cast<int>(random_() % static_cast<unsigned>(high - low + 1));
  };
  for (int i = 0; i < 3000; ++i) {
    const std::array<int, 3> o = {between(-2, 8), between(-2, 8), between(-2, 8)},
                             d = {between(-2, 2), between(-2, 2), between(-2, 2)};
    if (d == std::array<int, 3>{}) continue;
    const Location from = scene_.locate(scene_.to_scene(o));
    expect_one_answer(from, scene_.to_scene(d), false);
    if (HasFatalFailure()) return;
    const Hit hit = scene_.first_hit(from, scene_.to_scene(d));
    if (hit.outcome != Outcome::hit) continue;
    const std::array<int, 3> onwards = {between(-2, 2), between(-2, 2), between(-2, 2)};
    if (onwards == std::array<int, 3>{}) continue;
    expect_one_answer(scene_.side_of(hit, i % 2 == 0), scene_.to_scene(onwards), false);
    if (HasFatalFailure()) return;
  }
  EXPECT_EQ(reached_.size(), 12u);
  EXPECT_GT(all_.tied, 10000u);
}

TEST_P(Kernels, StartsThatLeadNowhere) {
  for (const Basis basis : kBases) {
    for (const Arithmetic arithmetic : kArithmetics) {
      const Variant variant{arithmetic, basis};
      SignCounts counts;
      const auto outcome = [&](const Location& from, const Vec3f& d) {
        return first_hit(scene_.trusted16, from, d, variant, &counts).outcome;
      };
      EXPECT_EQ(outcome({}, {1, 0, 0}), Outcome::corrupt);
      EXPECT_EQ(outcome(scene_.locate({0, 0, 0}), {0, 0, 0}), Outcome::miss);
      EXPECT_EQ(outcome(scene_.locate({0, 0, 0}), {0, NAN, 0}), Outcome::miss);
      EXPECT_EQ(outcome(scene_.locate({INFINITY, 0, 0}), {0, 1, 0}), Outcome::miss);
      EXPECT_EQ(total(counts), 0u);
    }
  }
}

/// Vertices and a line, chosen so that many cross products are next to nothing: what certificates are for.
struct Nearly {
  detail::Line line;
  std::vector<Vec3f> vertices;
  Bounds bounds;
};
Nearly some_vertices(std::mt19937& random) {
  std::uniform_real_distribution<float> any(-1, 1);
  std::uniform_int_distribution<int> power(-24, 0);
  Nearly nearly;
  const float scale = std::ldexp(1.0f, static_cast<int>(random() % 40) - 20);
  const auto vector = [&](float size) {
    return Vec3f{size * any(random), size * any(random), size * any(random)};
  };
  const Vec3f o = vector(scale * (random() % 4 == 0 ? 1000.0f : 1.0f));
  Vec3f d = vector(1);
  if (random() % 3 == 0) d.x = 0;
  if (random() % 3 == 0) d.y = random() % 2 == 0 ? d.z : -0.0f;
  if (d == Vec3f{}) d.z = 1;
  nearly.line = {{detail::to_vec3d(o), {}}, detail::to_vec3d(d), {}, false};
  for (int i = 0; i < 12; ++i) {
    const float t = scale * any(random), off = scale * std::ldexp(1.0f, power(random));
    const Vec3f aside = vector(i % 3 == 0 ? scale : off);
    nearly.vertices.push_back({o.x + t * d.x + aside.x, o.y + t * d.y + aside.y, o.z + t * d.z + aside.z});
    nearly.bounds.add(nearly.vertices.back());
  }
  return nearly;
}

/// Whether all signs of an arithmetic with this projection are the exact ones; tells how many came from
/// where.
template <template <class> class Projection>
void expect_exact_signs(const Nearly& nearly, SignCounts& in_double, SignCounts& in_float) {
  using Exact = detail::ExactSigns<Projection, detail::Counting>;
  const Exact exact(nearly.line, nearly.bounds, nearly.vertices, detail::Counting(in_double));
  const Exact below(nearly.line, nearly.bounds, nearly.vertices, detail::Counting(in_float));
  const detail::FloatFirstSigns<Projection, detail::Counting> first(below, nearly.bounds);
  for (Index a = 0; a < nearly.vertices.size(); ++a) {
    for (Index b = 0; b < nearly.vertices.size(); ++b) {
      if (a == b) continue;
      const Vec3f &pa = nearly.vertices[a], &pb = nearly.vertices[b];
      const bool left = detail::passes_left(nearly.line, {pa, a}, {pb, b}).left;
      ASSERT_EQ(exact.left(exact.project(pa), a, exact.project(pb), b), left);
      ASSERT_EQ(first.left(first.project(pa), a, first.project(pb), b), left);
    }
  }
}

/// The same for the instance of the specialised basis that suits the line.
template <std::size_t kSmallest, std::size_t kLargest>
void expect_exact_signs_if_it_suits(const Nearly& nearly, SignCounts& in_double, SignCounts& in_float,
                                    int& instances) {
  const detail::Axes axes(nearly.line.direction);
  if (axes.smallest != kSmallest || axes.largest != kLargest) return;
  ++instances;
  if (turn_of<kSmallest, kLargest>(nearly.line.direction) > 0) {
    expect_exact_signs<detail::Specialised<kSmallest, kLargest, 1>::template Projection>(nearly, in_double,
                                                                                         in_float);
  } else {
    expect_exact_signs<detail::Specialised<kSmallest, kLargest, -1>::template Projection>(nearly, in_double,
                                                                                          in_float);
  }
}

TEST(Certificates, NoneIsGivenToAWrongSign) {
  std::mt19937 random(2);
  SignCounts in_double, in_float;
  int instances = 0;
  constexpr int kLines = 1500;
  for (int i = 0; i < kLines; ++i) {
    const Nearly nearly = some_vertices(random);
    expect_exact_signs<detail::ShearProjection>(nearly, in_double, in_float);
    expect_exact_signs<detail::OrthonormalProjection>(nearly, in_double, in_float);
    expect_exact_signs_if_it_suits<0, 1>(nearly, in_double, in_float, instances);
    expect_exact_signs_if_it_suits<0, 2>(nearly, in_double, in_float, instances);
    expect_exact_signs_if_it_suits<1, 0>(nearly, in_double, in_float, instances);
    expect_exact_signs_if_it_suits<1, 2>(nearly, in_double, in_float, instances);
    expect_exact_signs_if_it_suits<2, 0>(nearly, in_double, in_float, instances);
    expect_exact_signs_if_it_suits<2, 1>(nearly, in_double, in_float, instances);
    if (HasFatalFailure()) return;
  }
  constexpr std::uint64_t kSigns = std::uint64_t{3} * kLines * 12 * 11;
  EXPECT_EQ(instances, kLines);
  EXPECT_EQ(total(in_double), kSigns);
  EXPECT_EQ(total(in_float), kSigns);
  // Every stage had something to do.
  EXPECT_GT(in_float.in_float, kSigns / 10);
  EXPECT_GT(in_float.in_double, kSigns / 10);
  EXPECT_GT(in_double.in_double, kSigns / 2);
  EXPECT_GT(in_double.in_double2 + in_double.exact + in_double.tied, 0u);
}

}  // namespace
}  // namespace tetfmt_test
