// SPDX-License-Identifier: AGPL-3.0-or-later
// Batches of rays that have nothing in common against the same rays walked alone, for every kind of processor
// that this one can stand for.
#include "batch.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <random>

#include "support/lattice_mesh.hpp"
#include "support/region_mesh.hpp"
#include "support/same.hpp"
#include "support/shear.hpp"
#include "tetfmt/encode.hpp"

namespace {

using namespace tetfmt;
using tetfmt::detail::batch_targets;
using tetfmt::detail::kLanes;

constexpr float kInfinity = std::numeric_limits<float>::infinity(),
                kNaN = std::numeric_limits<float>::quiet_NaN();

struct Scene {
  Scene(const Mesh& mesh, Layout layout)
      : bytes(encode(mesh, layout)), view(*FileView::open(bytes)), trusted(*TrustedView::validated(bytes)) {}
  std::vector<std::byte> bytes;
  FileView view;
  TrustedView trusted;
};

/// Everything a batch can ask, of one list of places.
struct Batch {
  std::vector<Location> places;
  std::vector<BatchRay> rays;
  std::vector<BatchSegment> segments;

  std::uint32_t add(const Location& place) {
    places.push_back(place);
    return static_cast<std::uint32_t>(places.size() - 1);
  }
};

/// How many answers were of each kind, so that a test can see that it tested something.
struct Tally {
  int hits = 0, misses = 0, others = 0;
  void add(Outcome outcome) {
    ++(outcome == Outcome::hit ? hits : outcome == Outcome::miss ? misses : others);
  }
};

template <class View>
void expect_same_by(const detail::BatchTarget& target, const View& view, const FileView& alone,
                    const Batch& batch, Tally& tally) {
  SCOPED_TRACE(target.name);
  Hit used;  // what an earlier batch may have left behind
  used.outcome = Outcome::hit;
  used.side = 7;
  used.steps = 9;
  std::vector<Hit> hits(batch.rays.size(), used);
  std::vector<Outcome> blocked(batch.rays.size(), Outcome::absent),
      hidden(batch.segments.size(), Outcome::absent);
  detail::trace_batch(target, view, batch.places, batch.rays, hits);
  detail::occlude_batch(target, view, batch.places, batch.rays, blocked);
  detail::occlude_batch(target, view, batch.places, batch.segments, hidden);
  for (std::size_t i = 0; i < batch.rays.size(); ++i) {
    const auto& [from, direction, interval] = batch.rays[i];
    Hit hit = first_hit(alone, batch.places[from], direction, interval);
    hit.steps = 0;
    ASSERT_TRUE(tetfmt_test::same(hits[i], hit))
        << "ray " << i << ": sides " << hits[i].side << ", " << hit.side;
    ASSERT_EQ(blocked[i], occlusion(alone, batch.places[from], direction, interval)) << "ray " << i;
    tally.add(hit.outcome);
  }
  for (std::size_t i = 0; i < batch.segments.size(); ++i) {
    const auto& [from, to] = batch.segments[i];
    const Outcome outcome = occlusion(alone, batch.places[from], batch.places[to]);
    ASSERT_EQ(hidden[i], outcome) << "segment " << i;
    tally.add(outcome);
  }
}

Tally expect_same(const Scene& scene, const Batch& batch) {
  Tally tally;
  for (const auto& target : batch_targets()) {
    expect_same_by(target, scene.view, scene.view, batch, tally);
    expect_same_by(target, scene.trusted, scene.view, batch, tally);
    if (testing::Test::HasFatalFailure()) return tally;
  }
  return tally;
}

/// A lattice whose inner vertices are off their places, each a little, all faces of the inner box triangles
/// of their own: nothing ties.
Mesh crooked_mesh(int n) {
  tetfmt_test::LatticeOptions options;
  options.one_triangle_a_face = true;
  Mesh mesh = tetfmt_test::lattice_mesh(n, options);
  std::mt19937 random(9);
  const auto off = [&] { return static_cast<float>(static_cast<int>(random() % 201) - 100) / 1024; };
  for (Vec3f& p : mesh.vertices) {
    const auto inner = [&](float x) { return x > 0 && x < static_cast<float>(n); };
    if (inner(p.x) && inner(p.y) && inner(p.z)) p = {p.x + off(), p.y + off(), p.z + off()};
  }
  return mesh;
}

class BatchOn : public testing::TestWithParam<Layout> {
 protected:
  int below(int n) { return static_cast<int>(random_() % static_cast<unsigned>(n)); }
  float any() { return std::uniform_real_distribution<float>(-1, 1)(random_); }
  std::mt19937 random_{11};
};
INSTANTIATE_TEST_SUITE_P(, BatchOn, testing::Values(Layout::tet20, Layout::tet16),
                         [](const auto& given) { return given.param == Layout::tet20 ? "Tet20" : "Tet16"; });

/// Rays of integer directions between places of halves and quarters, whose intervals end on faces: they meet
/// edges and vertices everywhere.
TEST_P(BatchOn, EqualsOneByOneOnLattices) {
  for (const bool sheared : {false, true}) {
    const Mesh mesh = tetfmt_test::lattice_mesh(5);
    const Scene scene(sheared ? tetfmt_test::sheared(mesh) : mesh, GetParam());
    const auto turned = [&](float x, float y, float z) {
      const auto q = tetfmt_test::times(tetfmt_test::kShear, std::array<float, 3>{x, y, z});
      return sheared ? Vec3f{q[0], q[1], q[2]} : Vec3f{x, y, z};
    };
    Batch batch;
    constexpr int kPlaces = 60;
    for (int i = 0; i < kPlaces; ++i) {
      const float unit = i % 3 == 0 ? 4 : i % 3 == 1 ? 2 : 1;
      const auto one = [&] { return static_cast<float>(below(static_cast<int>(7 * unit)) - 1) / unit; };
      batch.add(locate(scene.view, turned(one(), one(), one())));
    }
    for (int i = 0; i < 1000; ++i) {
      const auto step = [&] { return static_cast<float>(below(9) - 4); };
      BatchRay ray{static_cast<std::uint32_t>(below(kPlaces)), turned(step(), step(), step()), {}};
      if (i % 3 != 0) ray.interval.t_max = static_cast<double>(below(17)) / 4;
      if (i % 3 == 2) ray.interval.t_min = static_cast<double>(below(5)) / 4;
      batch.rays.push_back(ray);
      batch.segments.push_back(
          {static_cast<std::uint32_t>(below(kPlaces)), static_cast<std::uint32_t>(below(kPlaces))});
    }
    const Tally tally = expect_same(scene, batch);
    if (HasFatalFailure()) return;
    EXPECT_GT(tally.hits, 1000);
    EXPECT_GT(tally.misses, 1000);
    EXPECT_EQ(tally.others, 0);
  }
}

/// Rays that bounce about: starts on both sides of faces, in all directions, also in the faces' planes.
TEST_P(BatchOn, EqualsOneByOneFromSurfaces) {
  for (const Mesh& mesh : {crooked_mesh(6), tetfmt_test::lattice_mesh(4)}) {
    const Scene scene(mesh, GetParam());
    Batch batch;
    for (int i = 0; i < 8; ++i) batch.add(locate(scene.view, {3 + 4 * any(), 3 + 4 * any(), 3 + 4 * any()}));
    for (std::uint32_t i = 0; i < 3000; ++i) {
      const auto from = static_cast<std::uint32_t>(below(static_cast<int>(batch.places.size())));
      BatchRay ray{from, {any(), any(), any()}, {}};
      if (i % 5 == 0) ray.direction.x = 0;
      if (i % 25 == 0) ray.direction.y = 0;
      const Hit hit = first_hit(scene.view, batch.places[from], ray.direction);
      if (i % 4 == 1) ray.interval.t_max = std::abs(any()) * 4;
      if (i % 4 == 2) ray.interval.t_max = hit.t * (1 + static_cast<double>(below(3) - 1) * 0x1p-52);
      if (i % 4 == 3) ray.interval.t_min = hit.t;
      batch.rays.push_back(ray);
      batch.segments.push_back(
          {from, static_cast<std::uint32_t>(below(static_cast<int>(batch.places.size())))});
      if (hit.outcome == Outcome::hit && i % 2 == 0) {
        batch.add(near_side(scene.view, hit));
        batch.add(far_side(scene.view, hit));
      }
    }
    const Tally tally = expect_same(scene, batch);
    if (HasFatalFailure()) return;
    EXPECT_GT(tally.hits, 1500);
    EXPECT_GT(tally.misses, 1500);
  }
}

/// In a file without the inside, rays may start in what is left out, or run into it.
TEST_P(BatchOn, EqualsOneByOneInPartialFiles) {
  for (const Index kept : {0u, 1u}) {
    const Scene scene(tetfmt_test::with_regions(tetfmt_test::lattice_mesh(5), {kept}), GetParam());
    Batch batch;
    for (int i = 0; i < 40; ++i)
      batch.add(locate(scene.view, {2.5f + 4 * any(), 2.5f + 4 * any(), 2.5f + 4 * any()}));
    for (std::uint32_t i = 0; i < 40; ++i) {
      const Hit hit = first_hit(scene.view, batch.places[i], {any(), any(), any()});
      if (hit.outcome == Outcome::hit)
        batch.add(i % 2 == 0 ? near_side(scene.view, hit) : far_side(scene.view, hit));
    }
    const int count = static_cast<int>(batch.places.size());
    for (int i = 0; i < 1500; ++i) {
      BatchRay ray{static_cast<std::uint32_t>(below(count)), {any(), any(), any()}, {}};
      if (i % 3 == 1) ray.interval.t_max = 3;
      if (i % 3 == 2) ray.interval.t_min = std::abs(any());
      batch.rays.push_back(ray);
      batch.segments.push_back(
          {static_cast<std::uint32_t>(below(count)), static_cast<std::uint32_t>(below(count))});
    }
    const Tally tally = expect_same(scene, batch);
    if (HasFatalFailure()) return;
    EXPECT_GT(tally.hits, 300);
    EXPECT_GT(tally.others, 300);  // absent
  }
}

/// Whatever first_hit takes.
TEST_P(BatchOn, TakesWhatFirstHitTakes) {
  const Scene scene(crooked_mesh(5), GetParam());
  Batch batch;
  for (const Vec3f& p : {Vec3f{2.5f, 2.25f, 2.5f},
                         {9, 1, 2},
                         {-1e6f, 3e5f, 2},
                         {1e30f, 1, 1},
                         {-3e38f, 3e38f, 1},
                         {0x1p-149f, 1e-40f, 2},
                         {kInfinity, 1, 2},
                         {kNaN, 1, 2}})
    batch.add(locate(scene.view, p));
  batch.add({});  // corrupt
  batch.places.push_back(batch.places[0]);
  batch.places.back().state = Location::State::absent;
  batch.places.push_back(batch.places[0]);
  batch.places.back().position = {1e300, -1e300, 0};
  const float numbers[] = {0,      -0.0f, 1,     -2,       0.3f,      0x1p-149f,  -0x1p-140f,
                           1e-30f, 1e30f, 3e38f, -3.4e38f, kInfinity, -kInfinity, kNaN};
  const double ends[] = {
      0, -1, 0.5, 2, 1e-320, -0.0, 1e300, std::numeric_limits<double>::infinity(), -1e300, kNaN, 0x1p-60, 40};
  const auto pick = [&](const auto& list) { return list[random_() % std::size(list)]; };
  for (std::uint32_t i = 0; i < 6000; ++i) {
    BatchRay ray{i % static_cast<std::uint32_t>(batch.places.size()),
                 {pick(numbers), pick(numbers), pick(numbers)},
                 {}};
    if (i % 2 == 0) ray.direction = {2.5f + any() - 9, 1.5f + any(), any()};
    if (i % 3 != 0) ray.interval = {pick(ends), pick(ends)};
    batch.rays.push_back(ray);
  }
  for (std::uint32_t i = 0; i < batch.places.size(); ++i)
    for (std::uint32_t k = 0; k < batch.places.size(); ++k) batch.segments.push_back({i, k});
  const Tally tally = expect_same(scene, batch);
  if (HasFatalFailure()) return;
  EXPECT_GT(tally.hits, 100);
  EXPECT_GT(tally.misses, 1000);
  EXPECT_GT(tally.others, 100);
}

/// Any number of rays by the public names; positions that do not exist.
TEST_P(BatchOn, TakesAnyNumber) {
  const Scene scene(crooked_mesh(5), GetParam());
  const std::vector<Location> places = {locate(scene.view, {2.5f, 2.25f, 2.5f}),
                                        locate(scene.view, {9, 1, 2})};
  for (const std::size_t count :
       {std::size_t{0}, std::size_t{1}, kLanes - 1, kLanes, kLanes + 1, std::size_t{1000}}) {
    std::vector<BatchRay> rays;
    std::vector<BatchSegment> segments;
    for (std::uint32_t i = 0; i < count; ++i) {
      rays.push_back({i % 7 == 3 ? 2 + i * i * i : i % 2, {any(), any(), any()}, {}});
      segments.push_back({i % 7 == 3 ? kNone : i % 2, i % 11 == 5 ? 2u : 1 - i % 2});
    }
    std::vector<Hit> hits(count), trusted_hits(count);
    std::vector<Outcome> blocked(count), trusted_blocked(count), hidden(count), trusted_hidden(count);
    trace_batch(scene.view, places, rays, hits);
    trace_batch(scene.trusted, places, rays, trusted_hits);
    occlude_batch(scene.view, places, rays, blocked);
    occlude_batch(scene.trusted, places, rays, trusted_blocked);
    occlude_batch(scene.view, places, segments, hidden);
    occlude_batch(scene.trusted, places, segments, trusted_hidden);
    EXPECT_TRUE(tetfmt_test::same(hits, trusted_hits));
    EXPECT_EQ(blocked, trusted_blocked);
    EXPECT_EQ(hidden, trusted_hidden);
    for (std::size_t i = 0; i < count; ++i) {
      Hit alone;
      alone.outcome = Outcome::corrupt;
      if (rays[i].from < 2) alone = first_hit(scene.trusted, places[rays[i].from], rays[i].direction);
      alone.steps = 0;
      ASSERT_TRUE(tetfmt_test::same(hits[i], alone)) << i;
      ASSERT_EQ(blocked[i], alone.outcome) << i;
      const auto& [from, to] = segments[i];
      ASSERT_EQ(hidden[i],
                from < 2 && to < 2 ? occlusion(scene.view, places[from], places[to]) : Outcome::corrupt);
    }
  }
}

/// Bytes that describe no mesh: walks by a view that checks end, and where only references are broken, as
/// those of one ray do. (Signs of vertices that are out of bounds are nobody's.)
TEST_P(BatchOn, EndsOnBrokenBytes) {
  const Scene whole(crooked_mesh(4), GetParam());
  Batch batch;
  for (int i = 0; i < 12; ++i) {
    const Location from = locate(whole.view, {2 + 2 * any(), 2 + 2 * any(), 2 + 2 * any()});
    batch.add(from);
    const Hit hit = first_hit(whole.view, from, {any(), any(), any()});
    if (hit.outcome == Outcome::hit) batch.add(near_side(whole.view, hit));
  }
  const int count = static_cast<int>(batch.places.size());
  for (int i = 0; i < 150; ++i) {
    BatchRay ray{static_cast<std::uint32_t>(below(count)), {any(), any(), any()}, {}};
    if (i % 3 == 1) ray.interval.t_max = 2;
    if (i % 3 == 2) ray.interval.t_min = 0.5;
    batch.rays.push_back(ray);
    batch.segments.push_back(
        {static_cast<std::uint32_t>(below(count)), static_cast<std::uint32_t>(below(count))});
  }
  Tally tally;
  for (int i = 0; i < 80; ++i) {
    std::vector<std::byte> bytes = whole.bytes;
    const bool vertices = i % 3 == 0;
    for (const SectionKind kind : {kTets, kSides, kVertices}) {
      if (vertices != (kind == kVertices)) continue;
      const SectionEntry& section = *whole.view.find(kind);
      for (int k = 0; k < 1 << i % 8; ++k) {
        const std::size_t word = random_() % (section.stored_bytes / 4);
        const auto value =
            static_cast<std::uint32_t>(i % 2 == 0 ? random_() : random_() % (2 * whole.view.tet_count()));
        std::memcpy(&bytes[section.offset + 4 * word], &value, sizeof value);
      }
    }
    const FileView view = *FileView::open(bytes);
    for (const auto& target : batch_targets()) {
      if (!vertices) {
        expect_same_by(target, view, view, batch, tally);
        if (HasFatalFailure()) return;
        continue;
      }
      std::vector<Hit> hits(batch.rays.size());
      std::vector<Outcome> blocked(batch.rays.size()), hidden(batch.segments.size());
      detail::trace_batch(target, view, batch.places, batch.rays, hits);
      detail::occlude_batch(target, view, batch.places, batch.rays, blocked);
      detail::occlude_batch(target, view, batch.places, batch.segments, hidden);
    }
  }
  EXPECT_GT(tally.hits, 1000);
  EXPECT_GT(tally.misses, 1000);
  EXPECT_GT(tally.others, 1000);
}

TEST(BatchTargets, AreWhatTheProcessorCanRun) {
  const auto targets = batch_targets();
  ASSERT_FALSE(targets.empty());
  for (const auto& target : targets) EXPECT_EQ(kLanes % target.width, 0u) << target.name;
  EXPECT_TRUE(std::is_sorted(targets.begin(), targets.end(),
                             [](const auto& a, const auto& b) { return a.width > b.width; }));
}

}  // namespace
