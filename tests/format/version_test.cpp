// SPDX-License-Identifier: AGPL-3.0-or-later
// Files from other versions, sections that nobody knows, metadata (spec/format.md, "Versions and
// extensions").
#include <gtest/gtest.h>

#include "format_support.hpp"
#include "tetfmt/reconstruct.hpp"

namespace tetfmt_test {
namespace {

using tetfmt::Code;
using tetfmt::Layout;

Bytes small_file() {
  return tetfmt::encode(two_tets(), Layout::tet20);
}

tetfmt::SectionEntry raw_section(tetfmt::SectionKind kind, std::uint16_t flags, std::uint64_t count) {
  tetfmt::SectionEntry entry;
  entry.kind = kind;
  entry.flags = flags;
  entry.stride = 1;
  entry.raw_bytes = entry.count = count;
  return entry;
}

TEST(Version, OtherMajorIsRefused) {
  for (const int major : {0, 2, 0x0100, 0xFFFF}) {
    Bytes bytes = small_file();
    header(bytes).major = static_cast<std::uint16_t>(major);
    tetfmt::rehash(bytes);
    EXPECT_EQ(codes(tetfmt::validate(bytes)), std::set{Code::unsupported_major});
    EXPECT_FALSE(tetfmt::FileView::open(bytes));
  }
}

TEST(Version, NewerMinorIsAcceptedWithItsFlagsAndReservedWords) {
  Bytes bytes = small_file();
  header(bytes).minor = 7;
  header(bytes).flags = 0x80000002;
  header(bytes).reserved = {1, 2};
  entry(bytes, tetfmt::kVertices).flags |= 0x8000;
  entry(bytes, tetfmt::kVertices).reserved = 3;
  tetfmt::rehash(bytes);
  const tetfmt::Report report = tetfmt::validate(bytes);
  EXPECT_TRUE(report.valid()) << text(report);

  header(bytes).minor = 0;
  tetfmt::rehash(bytes);
  EXPECT_EQ(codes(tetfmt::validate(bytes)), std::set{Code::header_field});  // stops at the header
  header(bytes).flags = 0;
  header(bytes).reserved = {};
  tetfmt::rehash(bytes);
  EXPECT_EQ(codes(tetfmt::validate(bytes)), std::set{Code::section_field});
}

TEST(Version, UnknownOptionalSectionIsSkipped) {
  for (const std::string contents : {"", "something from the future"}) {
    auto added = raw_section(tetfmt::section_kind("futr"), tetfmt::kSafeToCopy, contents.size());
    added.version = 9;
    const Bytes bytes = with_section(small_file(), added, contents);
    const tetfmt::Report report = tetfmt::validate(bytes);
    EXPECT_TRUE(report.valid()) << text(report);
    const auto view = tetfmt::FileView::open(bytes);
    ASSERT_TRUE(view);
    EXPECT_EQ(view->section(tetfmt::section_kind("futr")).size(), contents.size());
    EXPECT_TRUE(tetfmt::reconstruct(*view));
  }
}

// The codec is the business of whoever knows the kind; the hash covers what is stored.
TEST(Version, UnknownOptionalSectionMayBeCompressed) {
  auto added = raw_section(tetfmt::section_kind("futr"), 0, 1000);
  added.codec = 5;
  Bytes bytes = with_section(small_file(), added, "short");
  EXPECT_TRUE(tetfmt::validate(bytes).valid()) << text(tetfmt::validate(bytes));
  bytes.back() ^= std::byte{1};
  EXPECT_EQ(codes(tetfmt::validate(bytes)), std::set{Code::section_hash});
}

TEST(Version, UnknownRequiredSectionIsRefusedByName) {
  const Bytes bytes =
      with_section(small_file(), raw_section(tetfmt::section_kind("PAGE"), tetfmt::kRequired, 4), "abcd");
  const tetfmt::Report report = tetfmt::validate(bytes);
  EXPECT_EQ(codes(report), std::set{Code::unknown_required_section});
  EXPECT_NE(text(report).find("PAGE"), std::string::npos) << text(report);
  const auto view = tetfmt::FileView::open(bytes);
  ASSERT_FALSE(view);
  EXPECT_NE(view.error().text.find("PAGE"), std::string::npos);
}

TEST(Version, SectionsMayComeInAnyOrder) {
  Bytes bytes = tetfmt::encode(full_mesh(3), Layout::tet16);
  const auto expected = tetfmt::reconstruct(*tetfmt::FileView::open(bytes))->tets;
  std::vector<Part> parts = disassemble(bytes);
  ASSERT_EQ(assemble(header(bytes), parts), bytes);
  for (std::size_t turn = 0; turn < parts.size(); ++turn) {
    std::rotate(parts.begin(), parts.begin() + 1, parts.end());
    if (turn % 2 == 1) std::swap(parts[1], parts[4]);
    const Bytes other = assemble(header(bytes), parts);
    const tetfmt::Report report = tetfmt::validate(other);
    EXPECT_TRUE(report.valid()) << text(report);
    EXPECT_EQ(tetfmt::reconstruct(*tetfmt::FileView::open(other))->tets, expected);
  }
}

TEST(Version, MetadataComesBackByteForByte) {
  tetfmt::Mesh mesh = two_tets();
  for (const std::string& metadata :
       {std::string("{}"), std::string(R"({"name":"Größe \u0000 \"x\""})"), std::string(100000, ' ')}) {
    mesh.metadata = metadata;
    const Bytes bytes = tetfmt::encode(mesh, Layout::tet16);
    ASSERT_TRUE(tetfmt::validate(bytes).valid());
    EXPECT_EQ(tetfmt::reconstruct(*tetfmt::FileView::open(bytes))->metadata, metadata);
  }
  mesh.metadata.clear();
  const Bytes bytes = tetfmt::encode(mesh, Layout::tet16);
  for (const auto& found : tetfmt::FileView::open(bytes)->sections())
    EXPECT_NE(found.kind, tetfmt::kMetadata);
}

TEST(Version, MaterialsBoundWhatSidesMayName) {
  tetfmt::Mesh mesh = two_tets();
  for (auto& side : mesh.sides) side.material = 2;
  const Bytes plain = tetfmt::encode(mesh, Layout::tet20);
  EXPECT_EQ(codes(tetfmt::validate(plain)), std::set{Code::material_range});

  mesh.optional = {optional_section(tetfmt::kMaterials, 64, std::vector<tetfmt::Material>(3))};
  EXPECT_TRUE(tetfmt::validate(tetfmt::encode(mesh, Layout::tet20)).valid());
  mesh.optional = {optional_section(tetfmt::kMaterials, 64, std::vector<tetfmt::Material>(2))};
  EXPECT_EQ(codes(tetfmt::validate(tetfmt::encode(mesh, Layout::tet20))), std::set{Code::material_range});
}

TEST(Version, CallersLimitsAreKept) {
  const Bytes bytes = tetfmt::encode(full_mesh(3), Layout::tet20);
  tetfmt::Limits limits;
  limits.max_tets = 162;
  limits.max_vertices = 64;
  EXPECT_TRUE(tetfmt::validate(bytes, tetfmt::Level::geometry, limits).valid());
  limits.max_tets = 161;
  EXPECT_EQ(codes(tetfmt::validate(bytes, tetfmt::Level::geometry, limits)), std::set{Code::limit});
  limits.max_tets = 162;
  limits.max_vertices = 63;
  EXPECT_FALSE(tetfmt::FileView::open(bytes, limits));
}

}  // namespace
}  // namespace tetfmt_test
