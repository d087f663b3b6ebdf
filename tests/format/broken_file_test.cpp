// SPDX-License-Identifier: AGPL-3.0-or-later
// Every broken file is reported with its code, and not before its level.
#include <gtest/gtest.h>

#include <filesystem>

#include "broken_files.hpp"
#include "tetfmt/mapped_file.hpp"

namespace tetfmt_test {
namespace {

using tetfmt::Code;
using tetfmt::Layout;
using tetfmt::Level;
using tetfmt::Mesh;

TEST(BrokenFile, TheUnbrokenOnesAreValid) {
  for (const Mesh& mesh :
       {one_tet(), two_tets(), full_mesh(3), full_mesh(7), lattice_mesh(4), attributed_mesh(),
        region_mesh(3, {0}), region_mesh(4, {0}), region_mesh(3, {1}), region_mesh(4, {1}),
        region_mesh(3, {0, 1}), joined(region_mesh(4, {1}), region_mesh(4, {1}), 4),
        joined(region_mesh(9, {0}), region_mesh(3, {1}), 3)}) {
    const Bytes bytes = tetfmt::encode(mesh, Layout::tet20);
    EXPECT_TRUE(tetfmt::validate(bytes).valid()) << text(tetfmt::validate(bytes));
  }
}

TEST(BrokenFile, IsReportedWithItsCodeAtItsLevel) {
  for (const BrokenFile& broken : broken_files()) {
    const std::string name = std::string(tetfmt::code_name(broken.code)) + ": " + broken.what;
    const Bytes bytes = broken.make();
    const Level level = tetfmt::code_level(broken.code);
    const tetfmt::Report report = tetfmt::validate(bytes, level);
    EXPECT_TRUE(report.issues.count(broken.code)) << name << "\n" << text(report);
    EXPECT_TRUE(tetfmt::validate(bytes).issues.count(broken.code)) << name;
    for (const auto& [code, group] : report.issues) {
      EXPECT_GE(group.count, group.examples.size()) << name;
      EXPECT_FALSE(group.examples.empty()) << name;
      for (const tetfmt::Error& example : group.examples) {
        EXPECT_EQ(example.code, code) << name;
        EXPECT_FALSE(example.text.empty()) << name;
        EXPECT_EQ(example.text.find('\n'), std::string::npos) << name;
      }
    }
    // The code's level is the lowest that can report it.
    if (level > Level::structure) {
      const auto shallower = tetfmt::validate(bytes, static_cast<Level>(static_cast<int>(level) - 1));
      EXPECT_FALSE(shallower.issues.count(broken.code)) << name;
    }
    EXPECT_FALSE(tetfmt::TrustedView::validated(bytes)) << name;
  }
}

// Geometry's cases must be sound in every other respect, or they would prove nothing about the geometric
// check.
TEST(BrokenFile, GeometryCasesPassTopology) {
  for (const BrokenFile& broken : broken_files()) {
    if (tetfmt::code_level(broken.code) != Level::geometry) continue;
    const tetfmt::Report report = tetfmt::validate(broken.make(), Level::topology);
    EXPECT_TRUE(report.valid()) << tetfmt::code_name(broken.code) << ": " << broken.what << "\n"
                                << text(report);
  }
}

// 1xxx: there are no bytes to validate.
TEST(BrokenFile, UnreadablePaths) {
  const auto absent = tetfmt::MappedFile::open("no-such-folder/no-such-file.tet");
  ASSERT_FALSE(absent);
  EXPECT_EQ(absent.error().code, Code::cannot_open);
  EXPECT_NE(absent.error().text.find("no-such-file.tet"), std::string::npos);
  const auto folder = tetfmt::MappedFile::open(std::filesystem::temp_directory_path().string());
  ASSERT_FALSE(folder);
  EXPECT_EQ(folder.error().code, Code::not_a_file);
}

TEST(BrokenFile, EveryCodeHasACase) {
  std::set<Code> covered = {Code::cannot_open, Code::not_a_file};  // UnreadablePaths
  for (const BrokenFile& broken : broken_files()) covered.insert(broken.code);
#define TETFMT_ISSUE(number, name, level, meaning) \
  EXPECT_TRUE(covered.count(Code::name)) << "no broken file for " << #name;
#include "tetfmt/issues.def"
#undef TETFMT_ISSUE
}

}  // namespace
}  // namespace tetfmt_test
