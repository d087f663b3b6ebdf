// SPDX-License-Identifier: AGPL-3.0-or-later
// `tet validate`: silence, verdicts, priorities, and JSON held against its published schema.
#include <fstream>
#include <nlohmann/json.hpp>

#include "cli/cli_support.hpp"
#include "support/schema_checker.hpp"

namespace tetfmt_test {
namespace {

using Json = nlohmann::json;

Json checked_report(const std::string& text) {
  SchemaChecker checker(Json::parse(std::ifstream(VALIDATE_SCHEMA)));
  const Json report = Json::parse(text);
  EXPECT_EQ(checker.errors(report), std::vector<std::string>{}) << text;
  return report;
}

/// A box whose tets claim neighbours that do not exist: many problems of few codes.
std::string broken_bytes(std::string bytes) {
  const auto* header = reinterpret_cast<const tetfmt::FileHeader*>(bytes.data());
  const auto* sections = reinterpret_cast<const tetfmt::SectionEntry*>(bytes.data() + header->toc_offset);
  for (std::uint32_t i = 0; i < header->toc_count; ++i) {
    if (sections[i].kind != tetfmt::kTets) continue;
    auto* tets = reinterpret_cast<tetfmt::Tet20*>(bytes.data() + sections[i].offset);
    for (std::uint64_t t = 100; t < 140; ++t) tets[t].neighbors[1] = 0x70000000;
  }
  return bytes;
}

TEST_F(CliTest, ValidateIsSilentWhenAllIsWell) {
  write_mesh("a.tet", box_mesh(), tetfmt::Layout::tet20);
  write_mesh("b.tet", box_mesh(), tetfmt::Layout::tet16);
  for (const char* level : {"structure", "checksum", "topology", "geometry"}) {
    const RunResult result = tet({"validate", "--level", level, "a.tet", "b.tet"});
    EXPECT_EQ(result.exit_code, 0) << level;
    EXPECT_EQ(result.out, "") << level;
    EXPECT_EQ(result.err, "") << level;
  }
}

TEST_F(CliTest, ValidateFoldsProblemsByCode) {
  const std::string whole = read_bytes(write_mesh("whole.tet", box_mesh()));
  write_bytes("broken.tet", broken_bytes(whole));
  const RunResult result = tet({"validate", "whole.tet", "broken.tet"});
  EXPECT_EQ(result.exit_code, 3);
  EXPECT_TRUE(is_one_line(result.err, "tet validate", {"broken.tet", "invalid", "convert it again"}));
  EXPECT_NE(result.out.find("broken.tet: 2103 section_hash, 1 time: "), std::string::npos) << result.out;
  EXPECT_NE(result.out.find("broken.tet: 4001 reference_range, 40 times: "), std::string::npos) << result.out;
  EXPECT_EQ(result.out.find("whole.tet"), std::string::npos);
  for (std::size_t begin = 0; begin < result.out.size(); begin = result.out.find('\n', begin) + 1) {
    EXPECT_EQ(result.out.compare(begin, 12, "broken.tet: "), 0);
  }
}

TEST_F(CliTest, ValidateLevelsLookNoDeeperThanAsked) {
  std::string bytes = read_bytes(write_mesh("whole.tet", box_mesh()));
  bytes = broken_bytes(bytes);
  write_bytes("broken.tet", bytes);
  EXPECT_EQ(tet({"validate", "--level", "structure", "broken.tet"}).exit_code, 0);
  const RunResult checksum = tet({"validate", "--level", "checksum", "broken.tet"});
  EXPECT_EQ(checksum.exit_code, 3);
  EXPECT_NE(checksum.out.find("2103"), std::string::npos);
  EXPECT_EQ(checksum.out.find("4001"), std::string::npos);
}

TEST_F(CliTest, ValidateUnreadableWinsOverInvalid) {
  write_mesh("whole.tet", box_mesh());
  write_bytes("empty.tet", "");
  EXPECT_EQ(tet({"validate", "whole.tet", "empty.tet"}).exit_code, 3);
  for (const auto& order : {std::vector<std::string>{"validate", "empty.tet", "missing.tet", "whole.tet"},
                            {"validate", "missing.tet", "whole.tet", "empty.tet"}}) {
    const RunResult result = tet(order);
    EXPECT_EQ(result.exit_code, 2);
    EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 2) << result.err;
  }
}

TEST_F(CliTest, ValidateJsonFollowsItsSchema) {
  const std::string whole = read_bytes(write_mesh("whole.tet", box_mesh()));
  write_bytes("broken.tet", broken_bytes(whole));
  write_bytes("cut\xFF.tet", whole.substr(0, 1000));

  const RunResult sound = tet({"validate", "--format", "json", "whole.tet"});
  EXPECT_EQ(sound.exit_code, 0);
  EXPECT_EQ(sound.err, "");
  const Json valid = checked_report(sound.out);
  EXPECT_EQ(valid["verdict"], "valid");
  EXPECT_EQ(valid["files"][0]["reached_level"], "geometry");
  EXPECT_EQ(valid["files"][0]["issues"], Json::array());

  const RunResult mixed =
      tet({"validate", "--format", "json", "whole.tet", "broken.tet", "cut\xFF.tet", "missing.tet"});
  EXPECT_EQ(mixed.exit_code, 2);
  const Json report = checked_report(mixed.out);
  EXPECT_EQ(report["verdict"], "unreadable");
  ASSERT_EQ(report["files"].size(), 4u);
  EXPECT_EQ(report["files"][0]["verdict"], "valid");
  EXPECT_EQ(report["files"][1]["verdict"], "invalid");
  EXPECT_EQ(report["files"][2]["verdict"], "invalid");
  EXPECT_EQ(report["files"][3]["verdict"], "unreadable");
  EXPECT_EQ(report["files"][3]["reached_level"], nullptr);
  // Counts are complete where examples are capped.
  bool found = false;
  std::uint64_t sum = 0;
  for (const Json& issue : report["files"][1]["issues"]) {
    sum += issue["count"].get<std::uint64_t>();
    if (issue["code"] != 4001) continue;
    found = true;
    EXPECT_EQ(issue["count"], 40);
    EXPECT_EQ(issue["examples"].size(), 8u);
    for (const Json& example : issue["examples"]) {
      EXPECT_GE(example["where"], 100);
      EXPECT_LT(example["where"], 140);
    }
  }
  EXPECT_TRUE(found) << mixed.out;
  EXPECT_EQ(report["files"][1]["problems"], sum);
}

TEST(SchemaChecker, SeesDifferences) {
  SchemaChecker checker(Json::parse(std::ifstream(VALIDATE_SCHEMA)));
  EXPECT_FALSE(checker.errors(Json::parse("{}")).empty());
  EXPECT_FALSE(
      checker.errors(Json::parse(R"({"report":"tet validate","version":1,"verdict":"good","files":[]})"))
          .empty());
}

TEST_F(CliTest, ValidateTellsUnsupportedFromInvalid) {
  std::string bytes = read_bytes(write_mesh("whole.tet", box_mesh()));
  reinterpret_cast<tetfmt::FileHeader*>(bytes.data())->major = 99;
  write_bytes("future.tet", bytes);
  write_bytes("empty.tet", "");
  const RunResult result = tet({"validate", "whole.tet", "future.tet"});
  EXPECT_EQ(result.exit_code, 5);
  EXPECT_NE(result.out.find("future.tet: 2003 unsupported_major"), std::string::npos) << result.out;
  EXPECT_TRUE(is_one_line(result.err, "tet validate", {"future.tet", "unsupported", "newer"}));
  EXPECT_EQ(tet({"validate", "empty.tet", "future.tet"}).exit_code, 3);
  EXPECT_EQ(tet({"info", "future.tet"}).exit_code, 5);
  const RunResult json = tet({"validate", "--format", "json", "future.tet"});
  EXPECT_EQ(json.exit_code, 5);
  EXPECT_EQ(checked_report(json.out)["verdict"], "invalid");
}

}  // namespace
}  // namespace tetfmt_test
