// SPDX-License-Identifier: AGPL-3.0-or-later
#include <nlohmann/json.hpp>

#include "cli/cli_support.hpp"
#include "support/region_mesh.hpp"

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

TEST_F(CliTest, InfoListsRegionsAndWhatWasLeftOut) {
  LatticeOptions options;
  options.low = 2;
  options.origin = {10, 20, 30};
  write_mesh("all.tet", with_regions(lattice_mesh(6, options), {0, 1}));
  write_mesh("inside.tet", with_regions(lattice_mesh(6, options), {1}));
  ASSERT_EQ(tet({"validate", "all.tet"}).exit_code, 0);
  ASSERT_EQ(tet({"validate", "inside.tet"}).exit_code, 0);
  Json info = Json::parse(tet({"info", "all.tet", "--format", "json"}).out);
  EXPECT_EQ(info["partial"], false);
  EXPECT_EQ(info["one_sided_faces"], 0);
  ASSERT_EQ(info["regions"].size(), 2u);
  EXPECT_EQ(info["regions"][0]["id"], 0);
  EXPECT_EQ(info["regions"][0]["tets"], 6 * (6 * 6 * 6 - 2 * 2 * 2));
  EXPECT_EQ(info["regions"][0]["volume"], 6.0 * 6 * 6 - 2 * 2 * 2);
  EXPECT_EQ(info["regions"][1]["volume"], 8.0);
  EXPECT_EQ(info["regions"][1]["low"], Json({12.0, 22.0, 32.0}));
  EXPECT_EQ(info["regions"][1]["high"], Json({14.0, 24.0, 34.0}));

  info = Json::parse(tet({"info", "inside.tet", "--format", "json"}).out);
  EXPECT_EQ(info["partial"], true);
  EXPECT_EQ(info["one_sided_faces"], 48);
  ASSERT_EQ(info["regions"].size(), 1u);
  EXPECT_EQ(info["regions"][0]["id"], 1);
  const RunResult text = tet({"info", "inside.tet"});
  for (const char* part : {"one-sided faces", "48", "region", "12 22 32  to  14 24 34", "8"})
    EXPECT_NE(text.out.find(part), std::string::npos) << part << text.out;
}

TEST_F(CliTest, InfoTextShowsTheFirstOfMany) {
  auto mesh = box_mesh();
  mesh.optional = {
      optional_section(tetfmt::kMaterials, sizeof(tetfmt::Material), std::vector<tetfmt::Material>(25)),
      optional_section(tetfmt::kObjects, sizeof(tetfmt::Object), std::vector<tetfmt::Object>(21))};
  write_mesh("box.tet", mesh);
  const RunResult text = tet({"info", "box.tet"});
  for (const char* part : {"material 19", "... and 5 more", "object 19", "... and 1 more"})
    EXPECT_NE(text.out.find(part), std::string::npos) << part << text.out;
  EXPECT_EQ(text.out.find("material 20"), std::string::npos);
  const Json info = Json::parse(tet({"info", "box.tet", "--format", "json"}).out);
  EXPECT_EQ(info["materials"].size(), 25u);
  EXPECT_EQ(info["objects"].size(), 21u);
}

TEST_F(CliTest, InfoTellsWhichAttributesThereAre) {
  auto mesh = box_mesh();
  const std::string texts("walls\0quality\0", 14);
  const auto bytes = std::as_bytes(std::span(texts));
  tetfmt::Material material;
  material.name = 0;
  material.base_color = {1, 0.5f, 0, 1};
  const std::vector<std::array<tetfmt::Index, 3>> corners(12, {0, 1, 1});
  mesh.optional = {
      {tetfmt::kTexts, 1, {bytes.begin(), bytes.end()}},
      optional_section(tetfmt::kMaterials, sizeof material, std::vector{material}),
      optional_section(tetfmt::kCorners, 12, corners),
      optional_section(tetfmt::kTexcoords, 8, std::vector<std::array<float, 2>>(2)),
      optional_section(tetfmt::kProperties, 8, std::vector<tetfmt::Property>{{6, 3}, {tetfmt::kNone, 99}}),
      optional_section(tetfmt::kPropertyValues, 8, std::vector<double>(4))};
  write_mesh("box.tet", mesh);
  const Json info = Json::parse(tet({"info", "box.tet", "--format", "json"}).out);
  EXPECT_EQ(info["materials"][0]["name"], "walls");
  EXPECT_EQ(info["materials"][0]["base_color"], Json({1.0, 0.5, 0.0, 1.0}));
  const Json& attributes = info["attributes"];
  EXPECT_EQ(attributes["surface_points"], 2);
  EXPECT_EQ(attributes["normals"], false);
  EXPECT_EQ(attributes["texcoords"], true);
  EXPECT_EQ(attributes["properties"][0]["name"], "quality");
  EXPECT_EQ(attributes["properties"][0]["type"], "uint16");
  EXPECT_EQ(attributes["properties"][1]["type"], 99);  // info shows; `tet validate` judges
  const RunResult text = tet({"info", "box.tet"});
  for (const char* part : {"texture coordinates, property quality (uint16)", "2 surface points", "\"walls\""})
    EXPECT_NE(text.out.find(part), std::string::npos) << part << text.out;
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
