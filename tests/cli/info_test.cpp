// SPDX-License-Identifier: AGPL-3.0-or-later
#include <nlohmann/json.hpp>

#include "cli/cli_support.hpp"

namespace tetfmt_test {
namespace {

using Json = nlohmann::json;

TEST_F(CliTest, InfoJsonHoldsTheFacts) {
  auto mesh = box_mesh();
  mesh.metadata = R"({"made": "here"})";
  for (const auto layout : {tetfmt::Layout::tet20, tetfmt::Layout::tet16}) {
    write_mesh("box.tet", mesh, layout);
    const RunResult result = tet({"info", "box.tet", "--format", "json"});
    ASSERT_EQ(result.exit_code, 0) << result.err;
    EXPECT_EQ(result.err, "");
    const Json info = Json::parse(result.out);
    const auto size = std::filesystem::file_size("box.tet");
    EXPECT_EQ(info["path"], "box.tet");
    EXPECT_EQ(info["layout"], layout == tetfmt::Layout::tet20 ? "tet20" : "tet16");
    EXPECT_EQ(info["bytes"], size);
    EXPECT_EQ(info["tets"], 6 * 6 * 6 * 6);
    EXPECT_EQ(info["vertices"], 7 * 7 * 7);
    EXPECT_EQ(info["input_triangles"], 12);
    EXPECT_EQ(info["kept_triangles"], 12);
    EXPECT_EQ(info["constrained_faces"], 6 * 2 * 2 * 2);
    EXPECT_EQ(info["hull_faces"], 6 * 6 * 6 * 2);
    EXPECT_DOUBLE_EQ(info["bytes_per_tet"].get<double>(), static_cast<double>(size) / 1296);
    EXPECT_DOUBLE_EQ(info["bytes_per_input_triangle"].get<double>(), static_cast<double>(size) / 12);
    EXPECT_EQ(info["grid_step"], 1.0);
    EXPECT_EQ(info["origin"], Json({10.0, 20.0, 30.0}));
    EXPECT_EQ(info["surface"]["local"]["low"], Json({2.0, 2.0, 2.0}));
    EXPECT_EQ(info["surface"]["model"]["high"], Json({14.0, 24.0, 34.0}));
    EXPECT_EQ(info["box"]["local"]["high"], Json({6.0, 6.0, 6.0}));
    EXPECT_EQ(info["box"]["model"]["low"], Json({10.0, 20.0, 30.0}));
    EXPECT_EQ(info["sources"][0]["tet"], 0);
    EXPECT_EQ(info["metadata"]["made"], "here");
    std::uint64_t tets_bytes = 0;
    for (const Json& section : info["sections"]) {
      if (section["kind"] == "TETS") tets_bytes = section["bytes"].get<std::uint64_t>();
      EXPECT_EQ(section["bytes"].get<std::uint64_t>(),
                section["count"].get<std::uint64_t>() * section["stride"].get<std::uint64_t>());
    }
    EXPECT_EQ(tets_bytes, 1296 * static_cast<std::uint64_t>(layout));
  }
}

TEST_F(CliTest, InfoTextShowsTheFacts) {
  write_mesh("box.tet", box_mesh());
  const RunResult result = tet({"info", "box.tet"});
  EXPECT_EQ(result.exit_code, 0);
  EXPECT_EQ(result.err, "");
  for (const char* part :
       {"tet20", "1,296", "343", "10 20 30", "VERT", "TETS", "source tet", "2 2 2  to  4 4 4"}) {
    EXPECT_NE(result.out.find(part), std::string::npos) << part;
  }
}

TEST_F(CliTest, InfoSurvivesHostileMetadata) {
  auto mesh = box_mesh();
  for (const std::string& metadata : {std::string(200000, '[') + std::string(200000, ']'),
                                      std::string("not json \xFF\xFE"), std::string("\x1b[31m\n\n")}) {
    mesh.metadata = metadata;
    write_mesh("box.tet", mesh);
    const RunResult json = tet({"info", "box.tet", "--format", "json"});
    EXPECT_EQ(json.exit_code, 0) << json.err;
    EXPECT_TRUE(Json::accept(json.out));
    const RunResult text = tet({"info", "box.tet"});
    EXPECT_EQ(text.exit_code, 0) << text.err;
    EXPECT_EQ(text.out.find('\x1b'), std::string::npos);
  }
}

}  // namespace
}  // namespace tetfmt_test
