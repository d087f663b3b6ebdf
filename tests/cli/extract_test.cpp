// SPDX-License-Identifier: AGPL-3.0-or-later
// `tet extract`: the surface comes back as it went in, in every format, and from no broken file.
#include <cmath>
#include <cstring>
#include <limits>
#include <map>

#include "cli/cli_support.hpp"
#include "cli/mesh_files.hpp"
#include "support/region_mesh.hpp"
#include "tetfmt/encode.hpp"
#ifdef TET_HAS_CONVERTER
#include "prep/appearance.hpp"
#endif

namespace tetfmt_test {
namespace {

using tetfmt::Index;
using tetfmt::kNone;
using tetfmt::PropertyType;

constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();

// ------------------------------------------------------------------------------------------- making files

std::array<double, 3> model_position(const tetfmt::Mesh& mesh, Index vertex) {
  const auto& p = mesh.vertices[vertex];
  return {mesh.origin[0] + static_cast<double>(p.x), mesh.origin[1] + static_cast<double>(p.y),
          mesh.origin[2] + static_cast<double>(p.z)};
}

class Texts {
 public:
  std::uint32_t add(const std::string& text) {
    const auto at = static_cast<std::uint32_t>(bytes_.size());
    for (const char c : text) bytes_.push_back(static_cast<std::byte>(c));
    bytes_.push_back(std::byte{0});
    return at;
  }
  tetfmt::OptionalSection section() const { return {tetfmt::kTexts, 1, bytes_}; }

 private:
  std::vector<std::byte> bytes_;
};

struct Look {
  std::vector<std::array<Index, 3>> corners;
  std::vector<std::array<float, 3>> normals;
  std::vector<std::array<float, 2>> texcoords;
  std::vector<std::array<float, 4>> colors;
  std::vector<std::vector<double>> values;
};

/// Five surface points shared by the twelve triangles.
Look point_look() {
  Look look;
  for (Index i = 0; i < 12; ++i) look.corners.push_back({i % 5, (i + 2) % 5, (i * i) % 5});
  for (int i = 0; i < 5; ++i) {
    const float x = static_cast<float>(i);
    look.normals.push_back({0.1f * x, -1, 1e-7f});
    look.texcoords.push_back({x / 7, -x});
    look.colors.push_back({x / 255, 1, 0, 1});
  }
  look.values = {{0.1, 0.2, 0.3, 0.4, 0.5}, {1, 2, 3, 4, 255}, {1, 2, 3, 4, 256}};
  return look;
}

/// The box with two materials, two objects and values at surface points: everything by hand.
tetfmt::Mesh dressed(tetfmt::Mesh mesh, const Look& look) {
  Texts texts;
  std::vector<tetfmt::Material> materials(3);
  materials[0].name = texts.add("brushed steel");
  materials[0].base_color = {0.25f, 0.5f, 0.1f, 0.75f};
  materials[0].base_color_texture = texts.add("steel.png");
  materials[1].name = materials[0].name;  // a second one of the same name
  materials[1].ior = 1.33f;
  const std::vector<tetfmt::Object> objects = {{texts.add("lid"), texts.add("a.obj")},
                                               {kNone, texts.add("b.ply")}};
  const std::vector<tetfmt::Property> properties = {
      {texts.add("quality of"), static_cast<std::uint32_t>(PropertyType::float64)},
      {texts.add("x"), static_cast<std::uint32_t>(PropertyType::uint8)},
      {texts.add("big"), static_cast<std::uint32_t>(PropertyType::uint8)}};
  std::vector<Index> object_of(mesh.triangles.size());
  for (Index i = 0; i < object_of.size(); ++i) object_of[i] = i < 5 ? 0 : 1;
  for (tetfmt::Side& side : mesh.sides) side.material = side.triangle % 3;
  std::vector<double> values;
  for (const auto& column : look.values) values.insert(values.end(), column.begin(), column.end());

  const auto add = [&](tetfmt::SectionKind kind, const auto& elements) {
    using T = typename std::decay_t<decltype(elements)>::value_type;
    if (!elements.empty()) mesh.optional.push_back(optional_section(kind, sizeof(T), elements));
  };
  mesh.optional = {texts.section()};
  add(tetfmt::kMaterials, materials);
  add(tetfmt::kObjects, objects);
  add(tetfmt::kTriangleObjects, object_of);
  add(tetfmt::kCorners, look.corners);
  add(tetfmt::kNormals, look.normals);
  add(tetfmt::kTexcoords, look.texcoords);
  add(tetfmt::kColors, look.colors);
  if (!look.values.empty()) add(tetfmt::kProperties, properties);
  if (!look.values.empty()) add(tetfmt::kPropertyValues, values);
  return mesh;
}

/// The box whose walls are of two triangles each in the input, cut into one piece a face; and at the end of
/// the input a triangle that repeats the first, of which no piece is left.
tetfmt::Mesh cut_box() {
  LatticeOptions options;
  options.low = 2;
  options.origin = {10, 20, 30};
  const tetfmt::Mesh whole = lattice_mesh(6, options);
  options.one_triangle_a_face = true;
  tetfmt::Mesh cut = lattice_mesh(6, options);
  std::vector<Index> origins(cut.triangles.size(), kNone);
  for (std::size_t s = 0; s < cut.sides.size(); ++s) {
    EXPECT_EQ(cut.sides[s].tet, whole.sides[s].tet);
    origins[cut.sides[s].triangle] = whole.sides[s].triangle;
  }
  auto inputs = whole.triangles;
  inputs.push_back({});
  inputs.push_back(inputs[0]);
  cut.optional = {optional_section(tetfmt::kOrigins, sizeof(Index), origins),
                  optional_section(tetfmt::kInputTriangles, sizeof(tetfmt::Triangle), inputs)};
  return cut;
}

// -------------------------------------------------------------------------------------------------- tests

TEST_F(CliTest, ExtractGivesPositionsAndOrderBack) {
  auto mesh = box_mesh();
  mesh.origin = {0.1, -1e9 / 3, 1e-20};  // sums that round
  for (const auto layout : {tetfmt::Layout::tet20, tetfmt::Layout::tet16}) {
    write_mesh("box.tet", mesh, layout);
    for (const std::vector<std::string>& more : {std::vector<std::string>{}, {"--ascii"}}) {
      std::vector<std::string> line = {"extract", "box.tet", "--surface", "box.PLY"};
      line.insert(line.end(), more.begin(), more.end());
      const RunResult result = tet(line);
      ASSERT_EQ(result.exit_code, 0) << result.err;
      EXPECT_EQ(result.out, "");
      EXPECT_TRUE(is_one_line(result.err, "tet extract", {"box.PLY", "12 triangles of 12 input triangles"}));
      const Ply ply = read_ply("box.PLY");
      EXPECT_EQ(ply.elements.at("vertex").count, 8u);
      EXPECT_EQ(ply.elements.at("vertex").properties.size(), 3u);
      ASSERT_EQ(ply.elements.at("face").count, 12u);
      EXPECT_EQ(ply.elements.at("face").properties.size(), 1u);
      for (std::size_t i = 0; i < 12; ++i)
        for (std::size_t k = 0; k < 3; ++k)
          EXPECT_EQ(ply.position(i, k), model_position(mesh, mesh.triangles[i].vertices[k]));
    }
    ASSERT_EQ(tet({"extract", "box.tet", "--surface", "box.obj"}).exit_code, 0);
    const Obj obj = read_obj("box.obj");
    ASSERT_EQ(obj.faces.size(), 12u);
    for (std::size_t i = 0; i < 12; ++i) {
      for (std::size_t k = 0; k < 3; ++k) {
        const auto expected = model_position(mesh, mesh.triangles[i].vertices[k]);
        const auto& corner = obj.faces[i].corners[k];
        EXPECT_EQ(obj.v[static_cast<std::size_t>(corner.v - 1)],
                  std::vector<double>(expected.begin(), expected.end()));
        EXPECT_EQ(corner.vt, 0);
        EXPECT_EQ(corner.vn, 0);
      }
    }
    EXPECT_FALSE(std::filesystem::exists("box.mtl"));  // there is nothing to say in it
  }
}

TEST_F(CliTest, ExtractPlyKeepsEveryValue) {
  const Look look = point_look();
  write_mesh("box.tet", dressed(box_mesh(), look));
  EXPECT_EQ(tet({"validate", "box.tet"}).exit_code, 0);
  for (const std::vector<std::string>& more : {std::vector<std::string>{}, {"--ascii"}}) {
    std::vector<std::string> line = {"extract", "box.tet", "--surface", "box.ply"};
    line.insert(line.end(), more.begin(), more.end());
    const RunResult result = tet(line);
    ASSERT_EQ(result.exit_code, 0) << result.err;
    EXPECT_TRUE(is_one_line(result.err, "tet extract", {"12 triangles"}));
    const Ply ply = read_ply("box.ply");
    const std::vector<std::pair<std::string, std::string>> expected = {
        {"double", "x"},   {"double", "y"},          {"double", "z"},  {"float", "nx"},  {"float", "ny"},
        {"float", "nz"},   {"float", "s"},           {"float", "t"},   {"uchar", "red"}, {"uchar", "green"},
        {"uchar", "blue"}, {"double", "quality_of"}, {"uchar", "x_2"}, {"double", "big"}};  // 256 is no uchar
    EXPECT_EQ(ply.elements.at("vertex").properties, expected);
    for (std::size_t i = 0; i < 12; ++i) {
      for (std::size_t k = 0; k < 3; ++k) {
        const Index p = look.corners[i][k];
        EXPECT_EQ(ply.position(i, k), model_position(box_mesh(), box_mesh().triangles[i].vertices[k]));
        EXPECT_EQ(ply.at("nx", i, k), static_cast<double>(look.normals[p][0]));
        EXPECT_EQ(ply.at("nz", i, k), static_cast<double>(look.normals[p][2]));
        EXPECT_EQ(ply.at("s", i, k), static_cast<double>(look.texcoords[p][0]));
        EXPECT_EQ(ply.at("t", i, k), static_cast<double>(look.texcoords[p][1]));
        EXPECT_EQ(ply.at("red", i, k), p);
        EXPECT_EQ(ply.at("green", i, k), 255);
        EXPECT_EQ(ply.at("quality_of", i, k), look.values[0][p]);
        EXPECT_EQ(ply.at("x_2", i, k), look.values[1][p]);
        EXPECT_EQ(ply.at("big", i, k), look.values[2][p]);
      }
      EXPECT_EQ(ply.elements.at("face").columns.at("material")[i], static_cast<double>(i % 3));
      EXPECT_EQ(ply.elements.at("face").columns.at("texnumber")[i], i % 3 == 0 ? 0 : -1);
      EXPECT_EQ(ply.elements.at("face").columns.at("object")[i], i < 5 ? 0 : 1);
    }
    const std::vector<std::string> comments = {
        "made by tet extract",   "material 0 brushed steel", "material 1 brushed steel", "material 2 ",
        "TextureFile steel.png", "object 0 lid of a.obj",    "object 1  of b.ply"};
    EXPECT_EQ(ply.comments, comments);
  }
}

TEST_F(CliTest, ExtractPlyShowsWhatIsMissing) {
  Look look = point_look();
  look.colors[1][0] = 0.3f;  // no multiple of 1/255
  look.colors[2][3] = 0.5f;
  look.texcoords[3] = {kNaN, kNaN};
  look.corners[7][1] = kNone;
  write_mesh("box.tet", dressed(box_mesh(), look));
  ASSERT_EQ(tet({"extract", "box.tet", "--surface", "box.ply"}).exit_code, 0);
  const Ply ply = read_ply("box.ply");
  std::map<std::string, std::string> types;
  for (const auto& [type, name] : ply.elements.at("vertex").properties) types[name] = type;
  EXPECT_EQ(types.at("red"), "float");
  EXPECT_EQ(types.at("alpha"), "float");
  EXPECT_EQ(types.at("x_2"), "double");  // it has to hold nan
  for (std::size_t i = 0; i < 12; ++i) {
    for (std::size_t k = 0; k < 3; ++k) {
      const Index p = look.corners[i][k];
      if (p == kNone) {
        for (const char* name : {"nx", "s", "red", "alpha", "x_2"})
          EXPECT_TRUE(std::isnan(ply.at(name, i, k))) << name;
        continue;
      }
      EXPECT_EQ(ply.at("red", i, k), static_cast<double>(look.colors[p][0]));
      EXPECT_EQ(ply.at("alpha", i, k), static_cast<double>(look.colors[p][3]));
      EXPECT_EQ(std::isnan(ply.at("s", i, k)), p == 3);
    }
  }
}

TEST_F(CliTest, ExtractObjKeepsValuesNamesAndMaterials) {
  const Look look = point_look();
  write_mesh("box.tet", dressed(box_mesh(), look));
  const RunResult result = tet({"extract", "box.tet", "--surface", "out.obj"});
  ASSERT_EQ(result.exit_code, 0);
  EXPECT_NE(result.err.find("3 properties"), std::string::npos) << result.err;
  EXPECT_EQ(result.err.find("opacity"), std::string::npos) << result.err;
  const Obj obj = read_obj("out.obj");
  EXPECT_EQ(obj.library, "out.mtl");
  EXPECT_EQ(obj.vt.size(), 5u);
  EXPECT_EQ(obj.vn.size(), 5u);
  EXPECT_EQ(obj.grouping, "oo");
  const std::array<std::string, 3> materials = {"brushed steel", "brushed steel_2", "material_2"};
  ASSERT_EQ(obj.faces.size(), 12u);
  for (std::size_t i = 0; i < 12; ++i) {
    EXPECT_EQ(obj.faces[i].material, materials[i % 3]);
    EXPECT_EQ(obj.faces[i].object, i < 5 ? "lid" : "b.ply");
    for (std::size_t k = 0; k < 3; ++k) {
      const Index p = look.corners[i][k];
      const auto& corner = obj.faces[i].corners[k];
      const auto place = model_position(box_mesh(), box_mesh().triangles[i].vertices[k]);
      const auto& v = obj.v[static_cast<std::size_t>(corner.v - 1)];
      ASSERT_EQ(v.size(), 6u);
      EXPECT_TRUE(std::equal(place.begin(), place.end(), v.begin()));
      EXPECT_EQ(static_cast<float>(v[3]), look.colors[p][0]);
      EXPECT_EQ(static_cast<float>(obj.vt[static_cast<std::size_t>(corner.vt - 1)][0]), look.texcoords[p][0]);
      EXPECT_EQ(static_cast<float>(obj.vn[static_cast<std::size_t>(corner.vn - 1)][0]), look.normals[p][0]);
      EXPECT_EQ(static_cast<float>(obj.vn[static_cast<std::size_t>(corner.vn - 1)][2]), look.normals[p][2]);
    }
  }
  const std::string library = read_bytes("out.mtl");
  for (const char* part : {"newmtl brushed steel\nKd 0.25 0.5 0.1\nd 0.75\n", "map_Kd steel.png\n",
                           "newmtl brushed steel_2\n", "Ni 1.33\n", "newmtl material_2\n"}) {
    EXPECT_NE(library.find(part), std::string::npos) << part << library;
  }
  EXPECT_EQ(library.find("unknown"), std::string::npos);
}

TEST_F(CliTest, ExtractObjLeavesOutWhatItCannotSay) {
  Look look = point_look();
  look.texcoords[3] = {kNaN, kNaN};
  look.colors[2][3] = 0.5f;
  write_mesh("box.tet", dressed(box_mesh(), look));
  const RunResult result = tet({"extract", "box.tet", "--surface", "out.obj"});
  ASSERT_EQ(result.exit_code, 0);
  EXPECT_NE(result.err.find("texture coordinates at some corners only"), std::string::npos) << result.err;
  EXPECT_NE(result.err.find("opacity"), std::string::npos) << result.err;
  const Obj obj = read_obj("out.obj");
  for (std::size_t i = 0; i < 12; ++i) {
    const bool whole = std::find(look.corners[i].begin(), look.corners[i].end(), 3u) == look.corners[i].end();
    for (const auto& corner : obj.faces[i].corners) {
      EXPECT_EQ(corner.vt != 0, whole) << i;
      EXPECT_NE(corner.vn, 0);
    }
  }
}

TEST_F(CliTest, ExtractObjGroupsObjectsThatComeBack) {
  auto mesh = dressed(box_mesh(), point_look());
  std::vector<Index> object_of(12);
  for (Index i = 0; i < 12; ++i) object_of[i] = i % 2;
  mesh.optional[3] = optional_section(tetfmt::kTriangleObjects, sizeof(Index), object_of);
  write_mesh("box.tet", mesh);
  ASSERT_EQ(tet({"extract", "box.tet", "--surface", "out.obj"}).exit_code, 0);
  EXPECT_EQ(read_obj("out.obj").grouping, std::string(12, 'g'));
}

TEST_F(CliTest, ExtractCountsWhatWasDropped) {
  auto mesh = box_mesh();
  mesh.triangles.insert(mesh.triangles.begin(), tetfmt::Triangle{});
  for (tetfmt::Side& side : mesh.sides) ++side.triangle;
  write_mesh("box.tet", mesh);
  const RunResult result = tet({"extract", "box.tet", "--surface", "box.ply"});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_TRUE(
      is_one_line(result.err, "tet extract", {"12 triangles of 13", "1 triangle is not in the file"}));
  const Ply ply = read_ply("box.ply");
  ASSERT_EQ(ply.elements.at("face").count, 12u);
  EXPECT_EQ(ply.position(0, 0), model_position(mesh, mesh.triangles[1].vertices[0]));
}

TEST_F(CliTest, ExtractKnowsPiecesFromInputTriangles) {
  tetfmt::Mesh mesh = cut_box();
  std::vector<tetfmt::Material> materials(2);
  mesh.optional.push_back(optional_section(tetfmt::kMaterials, sizeof(tetfmt::Material), materials));
  write_mesh("cut.tet", mesh);
  EXPECT_EQ(tet({"validate", "cut.tet"}).exit_code, 0);
  const RunResult whole = tet({"extract", "cut.tet", "--surface", "whole.ply"});
  ASSERT_EQ(whole.exit_code, 0) << whole.err;
  EXPECT_NE(whole.err.find("13 triangles of 14"), std::string::npos) << whole.err;
  EXPECT_NE(whole.err.find("the material of 1 triangle"), std::string::npos) << whole.err;
  const Ply ply = read_ply("whole.ply");
  const tetfmt::Mesh input = box_mesh();
  ASSERT_EQ(ply.elements.at("face").count, 13u);
  EXPECT_EQ(ply.elements.at("vertex").count, 8u);
  for (std::size_t i = 0; i < 13; ++i) {
    EXPECT_EQ(ply.elements.at("face").columns.at("material")[i], i < 12 ? 0 : -1);
    for (std::size_t k = 0; k < 3; ++k)
      EXPECT_EQ(ply.position(i, k), model_position(input, input.triangles[i % 12].vertices[k]));
  }
  ASSERT_EQ(tet({"extract", "cut.tet", "--surface", "whole.obj"}).exit_code, 0);
  EXPECT_EQ(read_obj("whole.obj").faces[11].material, "material_0");
  EXPECT_EQ(read_obj("whole.obj").faces[12].material, "unknown");
  EXPECT_NE(read_bytes("whole.mtl").find("newmtl unknown\n"), std::string::npos);

  const RunResult pieces = tet({"extract", "cut.tet", "--surface", "pieces.ply", "--pieces"});
  ASSERT_EQ(pieces.exit_code, 0) << pieces.err;
  EXPECT_NE(pieces.err.find("48 pieces of 14"), std::string::npos) << pieces.err;
  const Ply cut = read_ply("pieces.ply");
  ASSERT_EQ(cut.elements.at("face").count, 48u);
  for (std::size_t i = 0; i < 48; ++i) {
    for (std::size_t k = 0; k < 3; ++k)
      EXPECT_EQ(cut.position(i, k), model_position(mesh, mesh.triangles[i].vertices[k]));
    Index expected = 0;
    std::memcpy(&expected, mesh.optional[0].bytes.data() + 4 * i, 4);
    EXPECT_EQ(cut.elements.at("face").columns.at("input_triangle")[i], expected);
  }
}

TEST_F(CliTest, ExtractRefusesWrongCommandLines) {
  write_mesh("box.tet", box_mesh());
  std::filesystem::create_symlink("box.tet", "link.ply");
  std::filesystem::create_symlink("box.tet", "box.mtl");
  const auto before = listing();
  const std::vector<std::pair<std::vector<std::string>, std::vector<std::string>>> attempts = {
      {{"box.tet"}, {"--surface"}},
      {{"--surface", "x.ply"}, {"FILE"}},
      {{"box.tet", "--surface", "x.stl"}, {"x.stl", ".ply or .obj"}},
      {{"box.tet", "--surface", "ply"}, {".ply or .obj"}},
      {{"box.tet", "--surface", "folder.ply/x"}, {".ply or .obj"}},
      {{"box.tet", "--surface", "x.obj", "--ascii"}, {"--ascii"}},
      {{"box.tet", "--surface", "x.obj", "--pieces"}, {"--pieces", ".ply"}},
      {{"box.tet", "--surface", "link.ply"}, {"is the input itself"}},
      {{"box.tet", "--surface", "box.obj"}, {"box.mtl", "is the input itself"}},
  };
  for (auto [line, parts] : attempts) {
    line.insert(line.begin(), "extract");
    const RunResult result = tet(line);
    EXPECT_EQ(result.exit_code, 1) << result.err;
    EXPECT_TRUE(is_one_line(result.err, "tet extract", parts));
    EXPECT_EQ(listing(), before);
  }
}

TEST_F(CliTest, ExtractHelpTeaches) {
  const RunResult result = tet({"extract", "--help"});
  EXPECT_EQ(result.exit_code, 0);
  for (const char* part : {"FILE", "--surface", "--pieces", "--ascii", ".ply", ".obj", ".mtl", "nan",
                           "input_triangle", "Exit codes: 0", "Examples:\n  tet extract "}) {
    EXPECT_NE(result.out.find(part), std::string::npos) << part;
  }
  EXPECT_NE(tet({"--help"}).out.find("extract"), std::string::npos);
}

TEST_F(CliTest, ExtractFailsWithoutATrace) {
  write_mesh("box.tet", dressed(box_mesh(), point_look()));
  std::filesystem::create_directory("folder.ply");
  std::filesystem::create_directory("lib.mtl");
  write_bytes("old.ply", "old");
  const std::string whole = read_bytes("box.tet");
  const auto attempt = [&](const std::vector<std::string>& line, int code, std::vector<std::string> parts) {
    const auto before = listing();
    const RunResult result = tet(line);
    EXPECT_EQ(result.exit_code, code) << result.err;
    EXPECT_EQ(result.out, "");
    EXPECT_TRUE(is_one_line(result.err, "tet extract", parts));
    EXPECT_EQ(listing(), before);
    EXPECT_EQ(read_bytes("old.ply"), "old");
  };
  attempt({"extract", "missing.tet", "--surface", "x.ply"}, 2, {"missing.tet"});
  attempt({"extract", "box.tet", "--surface", "missing/x.ply"}, 2, {"missing/x.ply"});
  attempt({"extract", "box.tet", "--surface", "folder.ply"}, 2, {"folder.ply"});
  attempt({"extract", "box.tet", "--surface", "lib.obj"}, 2, {"lib.mtl"});
  attempt({"extract", "box.tet", "--surface", "/dev/full"}, 1, {});
  write_bytes("cut.tet", std::string_view(whole).substr(0, whole.size() - 70));
  attempt({"extract", "cut.tet", "--surface", "old.ply"}, 3, {"cut.tet"});
  std::string newer = whole;
  newer[8] = 2;
  write_bytes("newer.tet", newer);
  attempt({"extract", "newer.tet", "--surface", "old.ply"}, 5, {"newer.tet"});

  LatticeOptions open;
  open.walls = 0;
  write_mesh("none.tet", lattice_mesh(3, open));
  attempt({"extract", "none.tet", "--surface", "old.ply"}, 5, {"none.tet", "no surface"});
}

TEST_F(CliTest, ExtractFollowsNoIndexThatIsNotProved) {
  write_bytes("old.ply", "old");
  const auto refused = [&](const char* what, const tetfmt::Mesh& mesh) {
    write_mesh("bad.tet", mesh);
    const RunResult result = tet({"extract", "bad.tet", "--surface", "old.ply"});
    EXPECT_EQ(result.exit_code, 3) << what << result.err;
    EXPECT_TRUE(is_one_line(result.err, "tet extract", {"bad.tet"}));
    EXPECT_EQ(read_bytes("old.ply"), "old");
  };
  Look look = point_look();
  look.corners[3][1] = 5;
  refused("corner", dressed(box_mesh(), look));
  look = point_look();
  look.normals.pop_back();
  refused("normals", dressed(box_mesh(), look));
  look = point_look();
  look.values[1].pop_back();
  refused("values", dressed(box_mesh(), look));
  auto mesh = dressed(box_mesh(), point_look());
  mesh.optional[3].bytes[0] = std::byte{2};
  refused("object", mesh);
  mesh = box_mesh();
  mesh.triangles[2].vertices[1] = 100000;
  refused("vertex", mesh);
  mesh = cut_box();
  mesh.optional[0].bytes[1] = std::byte{1};
  refused("origin", mesh);
  mesh = cut_box();
  mesh.optional[1].bytes[3] = std::byte{1};
  refused("input vertex", mesh);
  mesh = box_mesh();
  mesh.sides[4].material = mesh.sides[5].material = 9;
  refused("material", mesh);
}

TEST_F(CliTest, ExtractShowsNoControlCharacters) {
  auto mesh = dressed(box_mesh(), point_look());
  for (std::byte& b : mesh.optional[0].bytes)
    if (b == static_cast<std::byte>('e')) b = std::byte{'\n'};
  write_mesh("box.tet", mesh);
  ASSERT_EQ(tet({"extract", "box.tet", "--surface", "box.ply"}).exit_code, 0);
  EXPECT_EQ(read_ply("box.ply").elements.at("face").count, 12u);
  ASSERT_EQ(tet({"extract", "box.tet", "--surface", "box.obj"}).exit_code, 0);
  EXPECT_EQ(read_obj("box.obj").faces[0].material, "brush_d st__l");
}

#ifdef TET_HAS_CONVERTER

TEST_F(CliTest, ExtractDecodesDraco) {
  const Look look = point_look();
  tetprep::Appearance appearance;
  appearance.surface_points = 5;
  appearance.corners = look.corners;
  appearance.corners[6] = {kNone, kNone, kNone};
  appearance.colors = look.colors;
  appearance.normals = look.normals;
  appearance.properties = {{"id", PropertyType::int16, {-5, 4, 3, 2, 1}}};
  auto mesh = box_mesh();
  mesh.optional = tetprep::to_sections(appearance, tetprep::KeepAttributes::all, true);
  write_mesh("box.tet", mesh);
  const RunResult result = tet({"extract", "box.tet", "--surface", "box.ply"});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const Ply ply = read_ply("box.ply");
  for (std::size_t i = 0; i < 12; ++i) {
    for (std::size_t k = 0; k < 3; ++k) {
      EXPECT_EQ(ply.position(i, k), model_position(mesh, mesh.triangles[i].vertices[k]));
      const Index p = appearance.corners[i][k];
      if (p == kNone) {
        EXPECT_TRUE(std::isnan(ply.at("id", i, k)));
        continue;
      }
      EXPECT_EQ(ply.at("id", i, k), appearance.properties[0].values[p]);
      EXPECT_EQ(ply.at("red", i, k), static_cast<double>(look.colors[p][0]));
      EXPECT_NEAR(ply.at("ny", i, k) * std::hypot(look.normals[p][0], 1.0f), -1, 1e-3);
    }
  }
  mesh.optional[0].bytes.resize(mesh.optional[0].bytes.size() / 2);
  write_mesh("box.tet", mesh);
  const RunResult broken = tet({"extract", "box.tet", "--surface", "broken.ply"});
  EXPECT_EQ(broken.exit_code, 3);
  EXPECT_TRUE(is_one_line(broken.err, "tet extract", {"box.tet", "DRAC"}));
  EXPECT_EQ(listing(), (std::vector<std::string>{"box.ply", "box.tet"}));
}

TEST_F(CliTest, ExtractGivesBackWhatWasConverted) {
  ASSERT_EQ(tet({"sample", "torus-knot", "-o", "in.ply", "--triangles", "2000"}).exit_code, 0);
  ASSERT_EQ(tet({"convert", "in.ply", "-o", "a.tet"}).exit_code, 0);
  ASSERT_EQ(tet({"extract", "a.tet", "--surface", "a.ply"}).exit_code, 0);
  const Ply in = read_ply("in.ply"), out = read_ply("a.ply");
  ASSERT_EQ(in.elements.at("face").count, out.elements.at("face").count);
  EXPECT_EQ(in.elements.at("vertex").count, out.elements.at("vertex").count);
  double deviation = 0, extent = 0;
  for (std::size_t i = 0; i < in.elements.at("face").count; ++i) {
    for (std::size_t k = 0; k < 3; ++k) {
      for (std::size_t x = 0; x < 3; ++x) {
        deviation = std::max(deviation, std::abs(in.position(i, k)[x] - out.position(i, k)[x]));
        extent = std::max(extent, std::abs(in.position(i, k)[x] - in.position(0, 0)[x]));
      }
    }
  }
  EXPECT_LT(deviation, extent / (1 << 19));
  // What came out lies on the grid: from then on nothing changes by a bit, in either format.
  for (const std::string ending : {"ply", "obj"}) {
    ASSERT_EQ(tet({"extract", "a.tet", "--surface", "b." + ending}).exit_code, 0);
    ASSERT_EQ(tet({"convert", "b." + ending, "-o", "b.tet"}).exit_code, 0);
    ASSERT_EQ(tet({"extract", "b.tet", "--surface", "c." + ending}).exit_code, 0);
    EXPECT_EQ(read_bytes("b." + ending), read_bytes("c." + ending));
  }
}

#else

TEST_F(CliTest, ExtractWithoutDracoSaysSo) {
  auto mesh = box_mesh();
  mesh.optional = {{tetfmt::kDracoSurface, 1, std::vector<std::byte>(100)}};
  write_mesh("box.tet", mesh);
  const RunResult result = tet({"extract", "box.tet", "--surface", "box.ply"});
  EXPECT_EQ(result.exit_code, 5);
  EXPECT_TRUE(is_one_line(result.err, "tet extract", {"box.tet", "DRAC", "no Draco"}));
}

#endif

}  // namespace
}  // namespace tetfmt_test
