// SPDX-License-Identifier: AGPL-3.0-or-later
// The text in spec/ against the library: the annotated files are decoded from the text itself.
#include <gtest/gtest.h>

#include <charconv>
#include <fstream>
#include <map>
#include <sstream>

#include "format_support.hpp"

namespace tetfmt_test {
namespace {

using tetfmt::Layout;

std::vector<std::string> lines_of(const std::string& name) {
  std::ifstream file(std::string(TETFMT_SPEC_FOLDER) + "/" + name);
  if (!file) throw std::runtime_error("cannot read spec/" + name);
  std::vector<std::string> lines;
  for (std::string line; std::getline(file, line);) lines.push_back(line);
  return lines;
}

/// The blocks that start with "```hexdump NAME": lines "offset: bytes ; comment" or "; comment".
std::map<std::string, Bytes> hex_dumps() {
  std::map<std::string, Bytes> dumps;
  Bytes* dump = nullptr;
  for (const std::string& line : lines_of("format.md")) {
    const std::string marker = "```hexdump ";
    if (line.rfind(marker, 0) == 0) {
      dump = &dumps[line.substr(marker.size())];
    } else if (line.rfind("```", 0) == 0) {
      dump = nullptr;
    } else if (dump != nullptr) {
      std::istringstream words(line.substr(0, line.find(';')));
      std::string offset, word;
      if (!(words >> offset)) continue;
      EXPECT_EQ(std::stoul(offset, nullptr, 16), dump->size()) << line;
      while (words >> word) {
        EXPECT_EQ(word.size(), 2u) << line;
        dump->push_back(static_cast<std::byte>(std::stoul(word, nullptr, 16)));
      }
    }
  }
  return dumps;
}

void expect_golden(const std::string& name, const tetfmt::Mesh& mesh, Layout layout) {
  const auto dumps = hex_dumps();
  ASSERT_TRUE(dumps.count(name)) << "spec/format.md has no block " << name;
  const Bytes& golden = dumps.at(name);
  const Bytes encoded = tetfmt::encode(mesh, layout);
  ASSERT_EQ(golden.size(), encoded.size());
  for (std::size_t i = 0; i < golden.size(); ++i) {
    ASSERT_EQ(std::to_integer<int>(golden[i]), std::to_integer<int>(encoded[i])) << "byte " << i;
  }
  const tetfmt::Report report = tetfmt::validate(golden);
  EXPECT_TRUE(report.valid()) << text(report);
  EXPECT_EQ(report.level, tetfmt::Level::geometry);
}

TEST(Golden, ThereAreFourAnnotatedFiles) {
  EXPECT_EQ(hex_dumps().size(), 4u);
}

TEST(Golden, OneTet) {
  expect_golden("one-tet", one_tet(), Layout::tet20);
}

TEST(Golden, TwoTetsTet20) {
  expect_golden("two-tets-tet20", two_tets(), Layout::tet20);
}

TEST(Golden, TwoTetsTet16) {
  expect_golden("two-tets-tet16", two_tets(), Layout::tet16);
}

TEST(Golden, Room) {
  expect_golden("room-tet20", room(), Layout::tet20);
}

// What the commentary says about the second dump, read through the view.
TEST(Golden, TwoTetsDecode) {
  const auto dumps = hex_dumps();
  const auto view = tetfmt::FileView::open(dumps.at("two-tets-tet20"));
  ASSERT_TRUE(view) << to_string(view.error());
  EXPECT_EQ(view->header().origin, (std::array<double, 3>{10.5, -2.25, 1000}));
  EXPECT_EQ(view->header().grid_exponent, -2);
  EXPECT_EQ(view->vertices()[1], (tetfmt::Vec3f{0, 0.25f, 1.5f}));
  EXPECT_EQ(view->tets20()[0].vertex_xor, 0u ^ 1u ^ 2u ^ 4u);
  EXPECT_EQ(view->tets20()[0].neighbors, (std::array<tetfmt::Ref, 4>{kHull, 0x80000001u, kHull, kHull}));
  EXPECT_EQ(view->tets20()[1].vertex_xor, 0u ^ 2u ^ 3u ^ 4u);
  EXPECT_EQ(view->sources()[0].tet, 1u);
  EXPECT_EQ(view->sources()[0].vertices, (std::array<Index, 4>{0, 2, 3, 4}));
  EXPECT_EQ(view->sides()[0].tet, 1u);
  EXPECT_EQ(view->sides()[1].tet, 0u);
  EXPECT_EQ(view->sides()[1].triangle, 1u);
  EXPECT_TRUE(view->triangles()[0].dropped());
  EXPECT_EQ(view->triangles()[1].vertices, (std::array<Index, 3>{2, 0, 4}));
  EXPECT_EQ(view->hull()[5], (tetfmt::HullFace{1, {2, 3, 4}}));

  const auto view16 = tetfmt::FileView::open(dumps.at("two-tets-tet16"));
  ASSERT_TRUE(view16) << to_string(view16.error());
  EXPECT_EQ(view16->tets16()[0].neighbor_xor, (std::array<tetfmt::Ref, 3>{0, 0x7FFFFFFEu, 0}));
  EXPECT_EQ(view16->tets16()[1].neighbor_xor, (std::array<tetfmt::Ref, 3>{0, 0, 0x7FFFFFFFu}));
}

// Sizes are part of the format: readers in other languages hard-code them.
TEST(Golden, StructureSizes) {
  using namespace tetfmt;
  EXPECT_EQ(sizeof(FileHeader), 128u);
  EXPECT_EQ(offsetof(FileHeader, file_bytes), 16u);
  EXPECT_EQ(offsetof(FileHeader, toc_count), 32u);
  EXPECT_EQ(offsetof(FileHeader, origin), 64u);
  EXPECT_EQ(offsetof(FileHeader, grid_exponent), 88u);
  EXPECT_EQ(offsetof(FileHeader, reserved), 96u);
  EXPECT_EQ(offsetof(FileHeader, toc_hash), 112u);
  EXPECT_EQ(offsetof(FileHeader, header_hash), 120u);
  EXPECT_EQ(sizeof(SectionEntry), 64u);
  EXPECT_EQ(offsetof(SectionEntry, stride), 12u);
  EXPECT_EQ(offsetof(SectionEntry, offset), 16u);
  EXPECT_EQ(offsetof(SectionEntry, stored_bytes), 24u);
  EXPECT_EQ(offsetof(SectionEntry, raw_bytes), 32u);
  EXPECT_EQ(offsetof(SectionEntry, count), 40u);
  EXPECT_EQ(offsetof(SectionEntry, hash), 48u);
  EXPECT_EQ(offsetof(SectionEntry, reserved), 56u);
  EXPECT_EQ(sizeof(Vec3f), 12u);
  EXPECT_EQ(sizeof(Tet20), 20u);
  EXPECT_EQ(sizeof(Tet16), 16u);
  EXPECT_EQ(sizeof(SourceTet), 40u);
  EXPECT_EQ(sizeof(Side), 12u);
  EXPECT_EQ(sizeof(Triangle), 12u);
  EXPECT_EQ(sizeof(HullFace), 16u);
}

// spec/issues.md has exactly the codes of issues.def, in its order, each with its level, its meaning, and
// something to say about where, why and what to do.
TEST(Golden, IssuesAreExplained) {
  struct Row {
    int number;
    const char *name, *level, *meaning;
  };
  const std::vector<Row> table = {
#define TETFMT_ISSUE(number, name, level, meaning) {number, #name, #level, meaning},
#include "tetfmt/issues.def"
#undef TETFMT_ISSUE
  };
  const std::vector<std::string> lines = lines_of("issues.md");
  std::size_t row = 0;
  for (std::size_t i = 0; i < lines.size(); ++i) {
    if (lines[i].rfind("### ", 0) != 0) continue;
    ASSERT_LT(row, table.size()) << lines[i] << " is not in issues.def";
    const Row& expected = table[row++];
    EXPECT_EQ(lines[i], "### " + std::to_string(expected.number) + " " + expected.name);
    ASSERT_LT(i + 6, lines.size());
    EXPECT_EQ(lines[i + 2], std::string("- Level: ") + expected.level) << lines[i];
    EXPECT_EQ(lines[i + 3].rfind("- Where: ", 0), 0u) << lines[i];
    EXPECT_EQ(lines[i + 4], std::string("- Meaning: ") + expected.meaning) << lines[i];
    EXPECT_EQ(lines[i + 5].rfind("- Usual cause: ", 0), 0u) << lines[i];
    EXPECT_EQ(lines[i + 6].rfind("- What to do: ", 0), 0u) << lines[i];
  }
  EXPECT_EQ(row, table.size()) << "issues.def has codes that spec/issues.md lacks";
}

}  // namespace
}  // namespace tetfmt_test
