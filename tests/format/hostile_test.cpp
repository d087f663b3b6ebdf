// SPDX-License-Identifier: AGPL-3.0-or-later
// Bytes that mean harm: no crash, no hang, no allocation that the bytes do not justify.
#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "allocation_count.hpp"
#include "format_support.hpp"
#include "tetfmt/reconstruct.hpp"
#include "tetfmt/traverse.hpp"

namespace tetfmt_test {
namespace {

using tetfmt::FileView;
using tetfmt::Layout;
using tetfmt::Vec3f;

Index below(std::mt19937& random, Index count) {
  return static_cast<Index>(random() % count);
}

/// Every operation of traverse.hpp from a place, and from both sides of the face that it sees first. Each
/// ends within as many steps as there are tetrahedra, and one more.
void ask_everything(const FileView& view, const tetfmt::Location& from, const tetfmt::Location& other,
                    const Vec3f& direction) {
  const std::uint64_t cap = std::uint64_t{view.tet_count()} + 1;
  const tetfmt::Hit first = tetfmt::first_hit(view, from, direction);
  for (const tetfmt::Location& place :
       {from, tetfmt::near_side(view, first), tetfmt::far_side(view, first)}) {
    for (const tetfmt::Interval& interval :
         {tetfmt::Interval{}, tetfmt::Interval{0, 0.5}, tetfmt::Interval{0.25, 1e300}}) {
      ASSERT_LE(tetfmt::first_hit(view, place, direction, interval).steps, cap);
      (void)tetfmt::occlusion(view, place, direction, interval);
      std::vector<tetfmt::Hit> hits;
      (void)tetfmt::all_hits(view, place, direction, hits, interval);
      ASSERT_LE(hits.size(), cap);
      for (const tetfmt::Hit& hit : hits) {
        ASSERT_EQ(hit.outcome, tetfmt::Outcome::hit);
        ASSERT_LE(hit.steps, cap);
        ASSERT_LT(hit.side, view.sides().size());
        ASSERT_LT(hit.tet, view.tet_count());
        (void)view.region_of(hit.neighbor);
      }
    }
    const std::vector<Vec3f> directions(16, direction);
    std::vector<tetfmt::Hit> hits(directions.size());
    ASSERT_LE(tetfmt::first_hits(view, place, directions, hits), cap * directions.size());
    (void)tetfmt::occlusion(view, place, other);
    (void)tetfmt::occlusion(view, other, place);
  }
}

/// Everything that may be done with bytes that nobody has checked.
void use_untrusted(const Bytes& bytes, std::mt19937& random) {
  (void)tetfmt::validate(bytes);
  const auto view = FileView::open(bytes);
  if (!view) return;
  (void)tetfmt::reconstruct(*view);

  std::uniform_real_distribution<float> inside(-0.2f, 1.0f);
  const std::uint64_t cap = std::uint64_t{view->tet_count()} + 1;
  tetfmt::Location before;
  for (int i = 0; i < 8; ++i) {
    const Vec3f point{inside(random), inside(random), inside(random)};
    const Vec3f direction{inside(random) - 0.4f, inside(random) - 0.4f, inside(random) - 0.4f};
    const tetfmt::Location start = tetfmt::locate(*view, point);
    for (const auto kernel : {tetfmt::Kernel::exact, tetfmt::Kernel::float_only}) {
      const tetfmt::Hit hit = tetfmt::first_hit(*view, start, direction, {}, kernel);
      ASSERT_LE(hit.steps, cap);
      if (hit.outcome == tetfmt::Outcome::hit) {
        ASSERT_LT(hit.side, view->sides().size());
        ASSERT_LT(hit.tet, view->tet_count());
      }
    }
    ask_everything(*view, start, before, direction);
    before = start;
  }
}

TEST(Hostile, NoBytesAndFewBytes) {
  EXPECT_FALSE(tetfmt::validate({}).valid());
  EXPECT_FALSE(FileView::open({}));
  Bytes nothing;
  tetfmt::rehash(nothing);
  EXPECT_TRUE(nothing.empty());
}

// Validation takes bytes from anywhere: a download buffer need not be aligned.
TEST(Hostile, MisalignedBytes) {
  for (const Layout layout : kLayouts) {
    const Bytes bytes = tetfmt::encode(full_mesh(3), layout);
    for (const std::size_t shift : {1u, 2u, 4u, 7u}) {
      Bytes buffer(bytes.size() + shift);
      std::copy(bytes.begin(), bytes.end(), buffer.begin() + static_cast<std::ptrdiff_t>(shift));
      const auto report = tetfmt::validate(std::span(buffer).subspan(shift));
      EXPECT_TRUE(report.valid()) << shift << ": " << text(report);
    }
  }
}

// A header of 128 bytes can claim 2^31 tets. Nothing may be allocated for a claim.
TEST(Hostile, ClaimsAreNotAllocatedFor) {
  const Bytes original = tetfmt::encode(two_tets(), Layout::tet20);
  const auto expect_frugal = [](const Bytes& bytes, const char* what) {
    reset_allocated_bytes();
    const bool valid = tetfmt::validate(bytes).valid();
    const bool opened = static_cast<bool>(FileView::open(bytes));
    EXPECT_LT(allocated_bytes(), 65536u) << what;
    EXPECT_FALSE(valid) << what;
    EXPECT_FALSE(opened) << what;
  };

  for (const std::uint32_t claim : {0x7FFFFFFEu, 0x7FFFFFFFu, 0xFFFFFFFEu, 0xFFFFFFFFu, 0x10000000u}) {
    Bytes bytes = original;
    auto& h = header(bytes);
    h.tet_count = h.vertex_count = h.side_count = h.triangle_count = h.source_count = h.toc_count = claim;
    tetfmt::rehash(bytes);
    expect_frugal(bytes, "every count");

    bytes = original;
    header(bytes).tet_count = claim;
    auto& tets = entry(bytes, tetfmt::kTets);
    tets.count = claim;
    tets.raw_bytes = tets.stored_bytes = std::uint64_t{claim} * 20;
    tetfmt::rehash(bytes);
    expect_frugal(bytes, "tets, lengths to match");
  }

  // Products and sums that come out right only modulo 2^64.
  for (const auto kind :
       {tetfmt::kTets, tetfmt::kVertices, tetfmt::kSources, tetfmt::kSides, tetfmt::kHullFaces}) {
    for (const unsigned shift : {60u, 61u, 62u, 63u}) {
      Bytes bytes = original;
      entry(bytes, kind).count += std::uint64_t{1} << shift;
      tetfmt::rehash(bytes);
      expect_frugal(bytes, "product");
      bytes = original;
      entry(bytes, kind).offset -= std::uint64_t{1} << shift;
      entry(bytes, kind).stored_bytes += std::uint64_t{1} << shift;
      tetfmt::rehash(bytes);
      expect_frugal(bytes, "sum");
    }
  }
}

TEST(Hostile, MemoryOfAValidationFollowsTheBytes) {
  LatticeOptions options;
  options.low = 3;
  for (const Layout layout : kLayouts) {
    const tetfmt::Mesh mesh = lattice_mesh(16, options);
    const Bytes bytes = tetfmt::encode(mesh, layout);
    reset_allocated_bytes();
    EXPECT_TRUE(tetfmt::validate(bytes).valid());
    EXPECT_LT(allocated_bytes(), 60 * mesh.tets.size());
  }
}

TEST(Hostile, RandomBytes) {
  std::mt19937 random(5);
  for (int i = 0; i < 3000; ++i) {
    Bytes bytes(random() % 2000);
    for (std::byte& b : bytes) b = static_cast<std::byte>(random());
    use_untrusted(bytes, random);
    // With a sound beginning, so that more of the code is reached.
    const Bytes sound = tetfmt::encode(two_tets(), kLayouts[i % 2]);
    std::copy_n(sound.begin(), std::min(bytes.size(), static_cast<std::size_t>(random() % 600)),
                bytes.begin());
    tetfmt::rehash(bytes);
    use_untrusted(bytes, random);
  }
}

// A sound container whose sections hold anything at all.
TEST(Hostile, RandomSections) {
  std::mt19937 random(6);
  for (int i = 0; i < 600; ++i) {
    Bytes bytes = tetfmt::encode(i % 3 == 0 ? full_mesh(3) : two_tets(), kLayouts[i % 2]);
    for (std::uint32_t s = 0; s < header(bytes).toc_count; ++s) {
      const auto found = at<tetfmt::SectionEntry>(bytes, 128 + 64 * std::uint64_t{s});
      const unsigned density = random() % 64;
      for (std::uint64_t byte = found.offset; byte < found.offset + found.stored_bytes; ++byte)
        if (random() % 64 < density) bytes[byte] = static_cast<std::byte>(random());
    }
    tetfmt::rehash(bytes);
    use_untrusted(bytes, random);
  }
}

// References that exist, in any order: walks go in circles instead of leaving the arrays.
TEST(Hostile, RandomButExistingReferences) {
  std::mt19937 random(7);
  for (int i = 0; i < 300; ++i) {
    Bytes bytes = tetfmt::encode(full_mesh(3), Layout::tet20);
    for (Index t = 0; t < 162; ++t) {
      auto& cell = element<tetfmt::Tet20>(bytes, tetfmt::kTets, t);
      for (auto& ref : cell.neighbors) {
        if (random() % 2 == 0)
          ref = random() % 8 == 0 ? tetfmt::side_ref(below(random, 24)) : below(random, 162);
      }
    }
    tetfmt::rehash(bytes);
    use_untrusted(bytes, random);
  }
}

/// Two cells that each send every walk to the other, with apexes that go back and forth: no face ever leads
/// out.
Bytes trap(Layout layout) {
  tetfmt::Mesh mesh = two_tets();
  mesh.tets[0].neighbors = {1, 1, 1, 1};
  mesh.tets[1].neighbors = {0, 0, 0, 0};
  mesh.sides.clear();
  return tetfmt::encode(mesh, layout);
}

/// The same through constrained faces: every face of a cell is one side, and beyond its twin is the other
/// cell.
Bytes trap_of_sides(Layout layout) {
  tetfmt::Mesh mesh = two_tets();
  mesh.tets[0].neighbors.fill(tetfmt::side_ref(1));
  mesh.tets[1].neighbors.fill(tetfmt::side_ref(0));
  return tetfmt::encode(mesh, layout);
}

/// In the second cell, where every walk is caught.
tetfmt::Location in_the_trap(tetfmt::Ref out) {
  tetfmt::Location start;
  start.state = tetfmt::Location::State::inside;
  start.position = {0.25, 0.25, -0.5};
  start.cell = {1, {0, 2, 3, 4}, {out, out, out, out}};
  return start;
}

constexpr Vec3f kDirections[] = {{0, 0, 1}, {0, 0, -1}, {1, 0.25f, 0.5f}, {-1, 2, -0.125f}};

TEST(Hostile, CyclesEnd) {
  std::mt19937 random(8);
  for (const Layout layout : kLayouts) {
    Bytes bytes = trap(layout);
    // The encoder found no hull face; a ray from outside needs one to be caught by.
    ASSERT_EQ(header(bytes).hull_count, 0u);
    use_untrusted(bytes, random);
    const auto view = FileView::open(bytes);
    ASSERT_TRUE(view);
    EXPECT_FALSE(tetfmt::reconstruct(*view));
    EXPECT_FALSE(tetfmt::validate(bytes).valid());
    const tetfmt::Location start = in_the_trap(0);
    tetfmt::Location target = start;
    target.state = tetfmt::Location::State::outside;
    target.position = {100, 200, -300};
    for (const Vec3f& direction : kDirections) {
      for (const auto kernel : {tetfmt::Kernel::exact, tetfmt::Kernel::float_only}) {
        const auto hit = tetfmt::first_hit(*view, start, direction, {}, kernel);
        EXPECT_EQ(hit.outcome, tetfmt::Outcome::corrupt);
        EXPECT_LE(hit.steps, 3u);
      }
      std::vector<tetfmt::Hit> hits;
      EXPECT_EQ(tetfmt::occlusion(*view, start, direction), tetfmt::Outcome::corrupt);
      EXPECT_EQ(tetfmt::occlusion(*view, start, target), tetfmt::Outcome::corrupt);
      EXPECT_EQ(tetfmt::all_hits(*view, start, direction, hits), tetfmt::Outcome::corrupt);
      EXPECT_TRUE(hits.empty());
      // What lies before the end of an interval may be all that was asked for; the cycle is no matter then.
      EXPECT_NE(tetfmt::first_hit(*view, start, direction, {0, 1e-3}).outcome, tetfmt::Outcome::hit);
      ask_everything(*view, start, target, direction);
    }
    EXPECT_EQ(tetfmt::locate(*view, {100, 100, 100}).state, tetfmt::Location::State::corrupt);
  }
}

TEST(Hostile, CyclesThroughConstrainedFacesEnd) {
  std::mt19937 random(8);
  for (const Layout layout : kLayouts) {
    const Bytes bytes = trap_of_sides(layout);
    use_untrusted(bytes, random);
    const auto view = FileView::open(bytes);
    ASSERT_TRUE(view);
    EXPECT_FALSE(tetfmt::validate(bytes).valid());
    const tetfmt::Location start = in_the_trap(tetfmt::side_ref(0));
    for (const Vec3f& direction : kDirections) {
      std::vector<tetfmt::Hit> hits;
      EXPECT_EQ(tetfmt::all_hits(*view, start, direction, hits), tetfmt::Outcome::corrupt);
      EXPECT_LE(hits.size(), 3u);  // one a step
      // Passes through all faces before t_min, of which there is no end.
      EXPECT_EQ(tetfmt::first_hit(*view, start, direction, {1e300, 2e300}).outcome, tetfmt::Outcome::corrupt);
      EXPECT_EQ(tetfmt::occlusion(*view, start, direction, {1e300, 2e300}), tetfmt::Outcome::corrupt);
      ask_everything(*view, start, start, direction);
    }
  }
}

// A start that is no cell of the file: nothing it names may be trusted.
TEST(Hostile, InventedStarts) {
  std::mt19937 random(9);
  for (const Layout layout : kLayouts) {
    const Bytes bytes = tetfmt::encode(full_mesh(3), layout);
    const auto view = FileView::open(bytes);
    for (int i = 0; i < 20000; ++i) {
      tetfmt::Location start;
      start.state = tetfmt::Location::State::inside;
      const auto word = [&]() -> std::uint32_t {
        return random() % 3 == 0 ? static_cast<Index>(random()) : below(random, 200);
      };
      start.cell.tet = word();
      for (auto& id : start.cell.vertices) id = word();
      for (auto& ref : start.cell.neighbors) ref = word();
      start.position = {0.3, 0.2, 0.1};
      start.positive = random() % 2 == 0;
      start.face = static_cast<std::uint8_t>(random() % 8);
      tetfmt::Hit hit = tetfmt::first_hit(*view, start, {1, 2, 3}, {0, i % 2 == 0 ? 1.0 : 1e9});
      ASSERT_LE(hit.steps, view->tet_count() + 1);
      std::vector<tetfmt::Hit> hits;
      tetfmt::all_hits(*view, start, {1, 2, 3}, hits);
      ASSERT_LE(hits.size(), view->tet_count() + 1);
      const tetfmt::Location target = tetfmt::locate(*view, {2, 2, 2});
      (void)tetfmt::occlusion(*view, start, target);
      (void)tetfmt::occlusion(*view, target, start);
      // A hit that was never made.
      hit.outcome = tetfmt::Outcome::hit;
      hit.side = word();
      hit.side_u = i % 3 == 0 ? std::numeric_limits<double>::quiet_NaN() : 1e300;
      for (auto& id : hit.face) id = word();
      (void)tetfmt::first_hit(*view, tetfmt::near_side(*view, hit), {1, 2, 3});
      (void)tetfmt::first_hit(*view, tetfmt::far_side(*view, hit), {1, 2, 3});
      (void)tetfmt::locate(*view, {0.3f, 0.2f, 0.1f}, &start.cell);
    }
  }
}

}  // namespace
}  // namespace tetfmt_test
