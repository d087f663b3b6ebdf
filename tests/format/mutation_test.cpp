// SPDX-License-Identifier: AGPL-3.0-or-later
// Nothing can be changed without being noticed: bytes by their hashes; the fields that say how things hang
// together even when the hashes are recomputed; lengths by the structure.
#include <gtest/gtest.h>

#include <random>

#include "format_support.hpp"
#include "tetfmt/reconstruct.hpp"

namespace tetfmt_test {
namespace {

using tetfmt::Layout;
using tetfmt::Level;

std::vector<Bytes> small_files() {
  std::vector<Bytes> files;
  for (const Layout layout : kLayouts) {
    for (const auto& mesh : {one_tet(), two_tets(), full_mesh(3)})
      files.push_back(tetfmt::encode(mesh, layout));
  }
  return files;
}

TEST(Mutation, AnySingleByteIsReported) {
  for (Bytes bytes : small_files()) {
    ASSERT_TRUE(tetfmt::validate(bytes, Level::checksum).valid());
    for (std::size_t i = 0; i < bytes.size(); ++i) {
      const std::byte original = bytes[i];
      for (const int mask : {0x01, 0x80, 0xFF, 0x10, 0x5A}) {
        bytes[i] = original ^ static_cast<std::byte>(mask);
        ASSERT_FALSE(tetfmt::validate(bytes, Level::checksum).valid()) << "byte " << i << " xor " << mask;
      }
      bytes[i] = original;
    }
  }
}

TEST(Mutation, AnyValueOfAnyByteOfATinyFileIsReported) {
  for (const Layout layout : kLayouts) {
    Bytes bytes = tetfmt::encode(two_tets(), layout);
    for (std::size_t i = 0; i < bytes.size(); ++i) {
      const std::byte original = bytes[i];
      for (int mask = 1; mask < 256; ++mask) {
        bytes[i] = original ^ static_cast<std::byte>(mask);
        ASSERT_FALSE(tetfmt::validate(bytes, Level::checksum).valid()) << "byte " << i << " xor " << mask;
      }
      bytes[i] = original;
    }
  }
}

TEST(Mutation, EveryTruncationIsReported) {
  for (const Bytes& bytes : small_files()) {
    for (std::size_t length = 0; length < bytes.size(); ++length) {
      const Bytes cut(bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(length));
      ASSERT_FALSE(tetfmt::validate(cut, Level::structure).valid()) << length;
      ASSERT_FALSE(tetfmt::FileView::open(cut)) << length;
    }
  }
}

// Whoever cuts the file may also correct the header and the hashes.
TEST(Mutation, EveryTruncationWithAMatchingHeaderIsReported) {
  for (const Bytes& bytes : small_files()) {
    for (std::size_t length = 128; length < bytes.size(); ++length) {
      Bytes cut(bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(length));
      header(cut).file_bytes = length;
      tetfmt::rehash(cut);
      ASSERT_FALSE(tetfmt::validate(cut, Level::structure).valid()) << length;
    }
  }
}

TEST(Mutation, EveryExtensionIsReported) {
  for (Bytes bytes : small_files()) {
    const std::size_t size = bytes.size();
    for (std::size_t more = 1; more <= 200; ++more) {
      bytes.push_back(std::byte{static_cast<unsigned char>(more > 100 ? more : 0)});
      header(bytes).file_bytes = size;
      ASSERT_FALSE(tetfmt::validate(bytes, Level::structure).valid()) << more;
      header(bytes).file_bytes = bytes.size();
      tetfmt::rehash(bytes);
      ASSERT_FALSE(tetfmt::validate(bytes, Level::structure).valid()) << more << ", header corrected";
    }
  }
}

/// Overwrites one field after another with values that a careless or a careful forger would choose,
/// recomputes the hashes, and expects a report every time.
class FieldForger {
 public:
  FieldForger(Bytes bytes, unsigned random_values, unsigned seed)
      : bytes_(std::move(bytes)), random_values_(random_values), random_(seed) {
    const auto& h = header(bytes_);
    counts_ = {h.tet_count,  h.vertex_count, h.side_count, h.triangle_count,
               h.hull_count, h.source_count, h.toc_count,  static_cast<Index>(h.file_bytes)};
  }

  template <class T>
  void forge(std::uint64_t offset, const std::string& name) {
    const T original = at<T>(bytes_, offset);
    std::set<T> values = {static_cast<T>(original + 1),
                          static_cast<T>(original - 1),
                          T(original ^ 1),
                          static_cast<T>(original ^ 0x80000000u),
                          static_cast<T>(~original),
                          T{0},
                          T{1},
                          static_cast<T>(0x80000000u),
                          static_cast<T>(0xFFFFFFFFu),
                          static_cast<T>(~T{0})};
    for (const Index count : counts_) values.insert({T{count}, static_cast<T>(count - 1)});
    for (unsigned i = 0; i < random_values_; ++i) {
      // Valid tets, sides, vertices are the dangerous ones; any bits, and single bits, for the rest.
      const auto& h = header(bytes_);
      values.insert(T{below(h.tet_count)});
      values.insert(T{below(h.vertex_count)});
      if (h.side_count != 0)
        values.insert({T{below(h.side_count)}, T{tetfmt::side_ref(below(h.side_count))}});
      values.insert(static_cast<T>(random_()));
      values.insert(static_cast<T>(original ^ (T{1} << below(8 * sizeof(T)))));
      values.insert(static_cast<T>(original + below(256) - 128));
    }
    values.erase(original);
    if ((name == "REGN" || name == "BNDS") && original == 0)
      values.erase(T{0x80000000u});  // a bound of -0 is 0
    for (const T value : values) {
      Bytes forged = bytes_;
      at<T>(forged, offset) = value;
      tetfmt::rehash(forged);
      const bool reported = !tetfmt::validate(forged).valid();
      ++tried;
      EXPECT_TRUE(reported) << name << " at byte " << offset << ": " << original << " became " << value;
    }
  }

  /// Every 32-bit word of a section, but not the names of regions: those that stay may be numbered freely.
  void forge_section(tetfmt::SectionKind kind, const std::string& name) {
    const auto found = entry(bytes_, kind);
    for (std::uint64_t i = 0; i < found.stored_bytes; i += 4) {
      if (kind == tetfmt::kRegions && i % sizeof(tetfmt::Region) == offsetof(tetfmt::Region, id)) continue;
      forge<std::uint32_t>(found.offset + i, name);
    }
  }

  std::size_t tried = 0;

 private:
  Index below(Index count) { return static_cast<Index>(random_() % count); }

  Bytes bytes_;
  unsigned random_values_;
  std::mt19937_64 random_;
  std::vector<Index> counts_;
};

void forge_all(const tetfmt::Mesh& mesh, unsigned random_values, unsigned seed) {
  for (const Layout layout : kLayouts) {
    const Bytes bytes = tetfmt::encode(mesh, layout);
    ASSERT_TRUE(tetfmt::validate(bytes).valid());
    FieldForger forger(bytes, random_values, seed);
    forger.forge_section(tetfmt::kTets, "TETS");
    forger.forge_section(tetfmt::kSources, "SRCE");
    forger.forge_section(tetfmt::kSides, "SIDE");
    forger.forge_section(tetfmt::kTriangles, "TRIA");
    forger.forge_section(tetfmt::kHullFaces, "HULL");
    if (tetfmt::FileView::open(bytes)->find(tetfmt::kRegions)) forger.forge_section(tetfmt::kRegions, "REGN");
    if (tetfmt::FileView::open(bytes)->find(tetfmt::kSurfaceBounds))
      forger.forge_section(tetfmt::kSurfaceBounds, "BNDS");

    // Header: all but the version, the origin (any finite one is right) and the hashes.
    for (const std::uint64_t offset : {12, 32, 36, 40, 44, 48, 52, 56, 60, 88, 92, 96, 100, 104, 108})
      forger.forge<std::uint32_t>(offset, "header");
    for (const std::uint64_t offset : {16, 24}) forger.forge<std::uint64_t>(offset, "header");

    // Table of contents: offset, lengths, count; codec, stride and the reserved word with them.
    const auto view = tetfmt::FileView::open(bytes);
    for (std::size_t i = 0; i < view->sections().size(); ++i) {
      const std::uint64_t start = 128 + 64 * i;
      for (const std::uint64_t field : {8, 12}) forger.forge<std::uint32_t>(start + field, "entry");
      for (const std::uint64_t field : {16, 24, 32, 40, 56})
        forger.forge<std::uint64_t>(start + field, "entry");
    }
    std::printf("%zu forged files\n", forger.tried);
  }
}

TEST(Mutation, AnyForgedFieldIsReportedTwoTets) {
  forge_all(two_tets(), 64, 1);
}

TEST(Mutation, AnyForgedFieldIsReportedLattice) {
  forge_all(full_mesh(3), 4, 2);
}

// Triangles of several faces, walls that end in the open.
TEST(Mutation, AnyForgedFieldIsReportedSubdividedOpenSurface) {
  LatticeOptions options;
  options.walls = 0b011010;
  tetfmt::Mesh mesh = lattice_mesh(4, options);
  mesh.sources = {100, 0, 383};
  forge_all(mesh, 1, 3);
}

// One-sided faces, a region table; and no hull at all.
TEST(Mutation, AnyForgedFieldIsReportedPartial) {
  forge_all(region_mesh(3, {0}), 2, 5);
  forge_all(region_mesh(3, {1}), 16, 6);
}

// Cells exchanged, vertices exchanged: sound words in the wrong places.
TEST(Mutation, ExchangedElementsAreReported) {
  for (const Layout layout : kLayouts) {
    const Bytes bytes = tetfmt::encode(full_mesh(3), layout);
    std::mt19937_64 random(4);
    for (const auto kind :
         {tetfmt::kTets, tetfmt::kSides, tetfmt::kTriangles, tetfmt::kHullFaces, tetfmt::kVertices}) {
      Bytes forged = bytes;
      const auto found = entry(forged, kind);
      for (int i = 0; i < 300; ++i) {
        forged = bytes;
        const auto begin = forged.begin() + static_cast<std::ptrdiff_t>(found.offset);
        const auto a = static_cast<std::ptrdiff_t>(random() % found.count * found.stride);
        const auto b = static_cast<std::ptrdiff_t>(random() % found.count * found.stride);
        std::swap_ranges(begin + a, begin + a + found.stride, begin + b);
        if (forged == bytes) continue;
        tetfmt::rehash(forged);
        ASSERT_FALSE(tetfmt::validate(forged).valid()) << a << " and " << b;
      }
    }
  }
}

}  // namespace
}  // namespace tetfmt_test
