// SPDX-License-Identifier: AGPL-3.0-or-later
// What a surface looks like: into sections, through a file, and back.
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <limits>
#include <random>

#include "prep/draco_surface.hpp"
#include "prep/prep_support.hpp"
#include "support/lattice_mesh.hpp"
#include "surface/read_surface.hpp"
#include "tetfmt/encode.hpp"

namespace tetprep_test {
namespace {

using tetfmt::PropertyType;
using tetprep::Appearance;
using tetprep::KeepAttributes;
using tetprep::kNone;
using tetprep::to_sections;

constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();
constexpr double kWideNaN = std::numeric_limits<double>::quiet_NaN();

/// Of the twelve triangles of a lattice mesh, with everything in it that there can be.
Appearance rich() {
  Appearance look;
  look.materials.resize(3);
  look.materials[0].name = "bronze";
  look.materials[0].values.base_color = {0.1f, 0.2f, 0.3f, 0.5f};
  look.materials[1].name = "bronze";  // twice on purpose
  look.materials[1].base_color_texture = "textures/wood grain.png";
  look.materials[1].values.emission = {10, 0, 2};
  look.materials[2].values.ior = 1.33f;
  look.objects = {{"left", "a.obj"}, {"bronze", "a.obj"}, {"", "b.glb"}};
  look.surface_points = 7;
  for (Index i = 0; i < 12; ++i) {
    look.triangle_material.push_back(i % 3);
    look.triangle_object.push_back(i / 4);
    look.corners.push_back({i % 7, (i + 1) % 7, (3 * i) % 7});
  }
  look.corners[4] = {kNone, 2, 2};
  look.corners[5] = {kNone, kNone, kNone};
  for (int i = 0; i < 7; ++i) {
    const float x = static_cast<float>(i);
    const float length = std::sqrt(1 + x * x);
    look.normals.push_back({1 / length, -x / length, 0});
    look.texcoords.push_back({x / 3, -40 * x});
    look.colors.push_back({x / 255, 1, 0, 254.0f / 255});
  }
  look.normals[3] = {kNaN, kNaN, kNaN};
  look.texcoords[6] = {kNaN, kNaN};
  look.properties = {{"quality", PropertyType::float32, {0, 0.1f, -1e30f, 4, 5, kWideNaN, 7}},
                     {"id", PropertyType::uint32, {0, 1, 2, 3, 4, 4294967295.0, 6}},
                     {"flags", PropertyType::uint8, {0, 255, 2, 3, 4, 5, 6}},
                     {"exact", PropertyType::float64, {0.1, 0.2, 1e300, -0.0, 1.0 / 3, 5, 6}}};
  return look;
}

tetfmt::Mesh mesh_with(const Appearance& look, std::vector<tetfmt::OptionalSection> sections) {
  tetfmt::Mesh mesh = tetfmt_test::lattice_mesh(4);
  for (tetfmt::Side& side : mesh.sides)
    if (!look.triangle_material.empty()) side.material = look.triangle_material[side.triangle];
  mesh.optional = std::move(sections);
  return mesh;
}

/// Through a file that is valid at every level.
Appearance through_file(const Appearance& look, KeepAttributes keep, bool draco,
                        tetfmt::Layout layout = tetfmt::Layout::tet20) {
  const auto bytes = tetfmt::encode(
      mesh_with(keep == KeepAttributes::all ? look : Appearance{}, to_sections(look, keep, draco)), layout);
  const auto file = tetfmt::TrustedView::validated(bytes);
  if (!file) {
    ADD_FAILURE() << tetfmt::to_string(file.error());
    return {};
  }
  return tetprep::read_appearance(file->view());
}

/// Bit for bit: NaN is NaN, and -0 is not 0.
template <class T>
bool same_bits(const std::vector<T>& a, const std::vector<T>& b) {
  return a.size() == b.size() && (a.empty() || std::memcmp(a.data(), b.data(), a.size() * sizeof(T)) == 0);
}

void expect_same_tables(const Appearance& a, const Appearance& b) {
  ASSERT_EQ(a.materials.size(), b.materials.size());
  for (std::size_t i = 0; i < a.materials.size(); ++i) {
    EXPECT_EQ(a.materials[i].name, b.materials[i].name);
    EXPECT_EQ(a.materials[i].base_color_texture, b.materials[i].base_color_texture);
    EXPECT_EQ(std::memcmp(&a.materials[i].values, &b.materials[i].values, sizeof(tetfmt::Material)), 0);
  }
  EXPECT_EQ(a.triangle_material, b.triangle_material);
  ASSERT_EQ(a.objects.size(), b.objects.size());
  for (std::size_t i = 0; i < a.objects.size(); ++i) {
    EXPECT_EQ(a.objects[i].name, b.objects[i].name);
    EXPECT_EQ(a.objects[i].source, b.objects[i].source);
  }
  EXPECT_EQ(a.triangle_object, b.triangle_object);
}

void expect_same_properties(const Appearance& a, const Appearance& b) {
  ASSERT_EQ(a.properties.size(), b.properties.size());
  for (std::size_t i = 0; i < a.properties.size(); ++i) {
    EXPECT_EQ(a.properties[i].name, b.properties[i].name);
    EXPECT_EQ(a.properties[i].type, b.properties[i].type);
    EXPECT_TRUE(same_bits(a.properties[i].values, b.properties[i].values)) << a.properties[i].name;
  }
}

std::string kinds(const std::vector<tetfmt::OptionalSection>& sections) {
  std::string text;
  for (const auto& section : sections)
    for (int i = 0; i < 4; ++i)
      text += static_cast<char>(static_cast<std::uint32_t>(section.kind) >> 8 * i & 0xFF);
  return text;
}

TEST(Sections, RawSectionsKeepEveryBit) {
  const Appearance look = rich();
  for (const auto layout : {tetfmt::Layout::tet20, tetfmt::Layout::tet16}) {
    const Appearance back = through_file(look, KeepAttributes::all, false, layout);
    expect_same_tables(look, back);
    EXPECT_EQ(look.surface_points, back.surface_points);
    EXPECT_EQ(look.corners, back.corners);
    EXPECT_TRUE(same_bits(look.normals, back.normals));
    EXPECT_TRUE(same_bits(look.texcoords, back.texcoords));
    EXPECT_TRUE(same_bits(look.colors, back.colors));
    expect_same_properties(look, back);
  }
}

TEST(Sections, ComeInTheirOrder) {
  EXPECT_EQ(kinds(to_sections(rich(), KeepAttributes::all)), "TEXTMATLOBJTTOBJCORNNORMTEXCCOLRPROPPVAL");
  EXPECT_EQ(kinds(to_sections(rich(), KeepAttributes::all, true)), "TEXTMATLOBJTTOBJDRAC");
  EXPECT_EQ(kinds(to_sections(rich(), KeepAttributes::normals)), "CORNNORM");
  EXPECT_EQ(kinds(to_sections(rich(), KeepAttributes::normals, true)), "DRAC");
  EXPECT_EQ(kinds(to_sections(rich(), KeepAttributes::none)), "");
}

TEST(Sections, AreLeftOutIfTheySayNothing) {
  Appearance look;
  EXPECT_TRUE(to_sections(look, KeepAttributes::all).empty());
  look.objects = {{"", "ball.stl"}};
  look.triangle_object.assign(12, 0);
  EXPECT_TRUE(to_sections(look, KeepAttributes::all).empty());
  look.objects[0].name = "ball";
  EXPECT_EQ(kinds(to_sections(look, KeepAttributes::all)), "TEXTOBJT");
  look.objects = {{"", "a.stl"}, {"", "b.stl"}};
  EXPECT_EQ(kinds(to_sections(look, KeepAttributes::all)), "TEXTOBJTTOBJ");

  look = {};
  look.materials.resize(1);
  EXPECT_EQ(kinds(to_sections(look, KeepAttributes::all)), "MATL");  // no name, so no text
  look = {};
  look.surface_points = 3;
  look.corners.assign(12, {0, 1, 2});
  for (const auto keep : {KeepAttributes::normals, KeepAttributes::all})
    EXPECT_TRUE(to_sections(look, keep).empty() && to_sections(look, keep, true).empty());
}

TEST(Sections, NormalsAlone) {
  for (const bool draco : {false, true}) {
    const Appearance back = through_file(rich(), KeepAttributes::normals, draco);
    EXPECT_TRUE(back.materials.empty() && back.objects.empty() && back.triangle_object.empty());
    EXPECT_TRUE(back.texcoords.empty() && back.colors.empty() && back.properties.empty());
    EXPECT_EQ(back.corners, rich().corners);
    EXPECT_EQ(back.normals.size(), 7u);
  }
}

TEST(Sections, TextsAreStoredOnceAsUtf8) {
  Appearance look;
  look.materials.resize(4);
  look.materials[0].name = "Gr\xC3\xBCn";  // UTF-8
  look.materials[1].name = "Gr\xFCn";      // Latin-1 of the same
  look.materials[2].name = std::string("a\0b", 3);
  look.materials[3].name = "\xED\xA0\x80";  // a surrogate: no UTF-8
  const auto sections = to_sections(look, KeepAttributes::all);
  const auto& bytes = sections.at(0).bytes;
  const std::string text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  EXPECT_EQ(text, std::string("Gr\xC3\xBCn\0ab\0\xC3\xAD\xC2\xA0\xC2\x80\0", 16));
  const Appearance back = through_file(look, KeepAttributes::all, false);
  EXPECT_EQ(back.materials[0].name, back.materials[1].name);
}

// -------------------------------------------------------------------------------------------------- DRAC

double angle(const std::array<float, 3>& a, const std::array<float, 3>& b) {
  double dot = 0, square = 0;
  for (std::size_t i = 0; i < 3; ++i) {
    const std::size_t j = (i + 1) % 3, k = (i + 2) % 3;
    const auto product = [&](std::size_t p, std::size_t q) {
      return static_cast<double>(a[p]) * static_cast<double>(b[q]);
    };
    dot += product(i, i);
    square += std::pow(product(j, k) - product(k, j), 2);
  }
  return std::atan2(std::sqrt(square), dot) * 180 / std::acos(-1.0);
}

template <std::size_t N>
double range_of(const std::vector<std::array<float, N>>& values) {
  double range = 0;
  for (std::size_t k = 0; k < N; ++k) {
    float low = std::numeric_limits<float>::max(), high = -low;
    for (const auto& value : values) {
      if (std::isnan(value[k])) continue;
      low = std::min(low, value[k]);
      high = std::max(high, value[k]);
    }
    range = std::max(range, static_cast<double>(high) - static_cast<double>(low));
  }
  return range;
}

/// Equal where there are none, and within `range / 2^(bits + 1)` (and the rounding of float32) elsewhere.
template <std::size_t N>
void expect_quantized(const std::vector<std::array<float, N>>& a, const std::vector<std::array<float, N>>& b,
                      int bits) {
  ASSERT_EQ(a.size(), b.size());
  const double range = range_of(a);
  for (std::size_t i = 0; i < a.size(); ++i) {
    for (std::size_t k = 0; k < N; ++k) {
      ASSERT_EQ(std::isnan(a[i][k]), std::isnan(b[i][k])) << i;
      if (!std::isnan(a[i][k])) {
        ASSERT_NEAR(static_cast<double>(a[i][k]), static_cast<double>(b[i][k]),
                    range * (std::exp2(-bits - 1) + std::exp2(-23)));
      }
    }
  }
}

void expect_normals(const std::vector<std::array<float, 3>>& a, const std::vector<std::array<float, 3>>& b) {
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t i = 0; i < a.size(); ++i) {
    ASSERT_EQ(std::isnan(a[i][0]), std::isnan(b[i][0])) << i;
    if (!std::isnan(a[i][0])) {
      ASSERT_LT(angle(a[i], b[i]), 0.02) << i;
    }
  }
}

TEST(DracoSection, KeepsFacesCornersPropertiesAndByteColors) {
  const Appearance look = rich();
  const Appearance back = through_file(look, KeepAttributes::all, true);
  expect_same_tables(look, back);
  EXPECT_EQ(look.surface_points, back.surface_points);
  EXPECT_EQ(look.corners, back.corners);
  EXPECT_TRUE(same_bits(look.colors, back.colors));
  expect_same_properties(look, back);
  expect_normals(look.normals, back.normals);
  expect_quantized(look.texcoords, back.texcoords, tetprep::kDracoTexcoordBits);
}

/// Many faces between random points: repeated corners, repeated faces, points that no face has.
Appearance random_look(std::size_t points, std::size_t triangles) {
  std::mt19937 random(5);
  std::uniform_real_distribution<float> uniform(-1, 1);
  Appearance look;
  look.surface_points = points;
  for (std::size_t i = 0; i < triangles; ++i) {
    std::array<Index, 3> corners{};
    for (Index& corner : corners) corner = static_cast<Index>(random() % points);
    if (i % 11 == 0) corners[1] = corners[0];
    if (i % 13 == 0) corners[2] = kNone;
    look.corners.push_back(i % 7 == 3 ? look.corners.back() : corners);
  }
  for (std::size_t i = 0; i < points; ++i) {
    look.normals.push_back({uniform(random), uniform(random), uniform(random)});
    look.texcoords.push_back({100 * uniform(random), uniform(random)});
    look.colors.push_back({1 + uniform(random), 3, 0, 1});  // more than a screen can show
  }
  return look;
}

TEST(DracoSection, KeepsTheOrderOfManyFaces) {
  const Appearance look = random_look(20000, 50000);
  const auto bytes = tetprep::encode_draco(look);
  EXPECT_EQ(bytes, tetprep::encode_draco(look));
  Appearance back;
  tetprep::decode_draco(bytes, back);
  EXPECT_EQ(back.surface_points, look.surface_points);
  EXPECT_EQ(back.corners, look.corners);
  expect_normals(look.normals, back.normals);
  expect_quantized(look.texcoords, back.texcoords, tetprep::kDracoTexcoordBits);
  expect_quantized(look.colors, back.colors, tetprep::kDracoColorBits);
}

TEST(DracoSection, TakesWhatQuantisationCannot) {
  Appearance look;
  look.surface_points = 4;
  look.corners = {{0, 1, 2}, {3, 3, 3}};
  look.normals = {{0, 0, 0}, {0, 0, 5}, {INFINITY, 0, 0}, {1e-20f, 0, 0}};
  look.texcoords = {{3e38f, 1}, {-3e38f, 2}, {INFINITY, 3}, {kNaN, 4}};
  look.properties = {{"", PropertyType::int32, {-2147483648.0, 2147483647.0, 0, 1}},
                     {"far", PropertyType::int32, {2e9, 2e9 + 1, 2e9 + 2, 2e9 + 3}},
                     {"inf", PropertyType::float32, {INFINITY, -INFINITY, 0, 1}}};
  Appearance back;
  tetprep::decode_draco(tetprep::encode_draco(look), back);
  EXPECT_EQ(back.corners, look.corners);
  EXPECT_EQ(back.texcoords[0], look.texcoords[0]);
  EXPECT_EQ(back.texcoords[1], look.texcoords[1]);
  EXPECT_TRUE(std::isnan(back.texcoords[2][1]) && std::isnan(back.texcoords[3][1]));
  EXPECT_TRUE(std::isnan(back.normals[0][0]) && std::isnan(back.normals[2][2]));
  EXPECT_LT(angle(back.normals[1], {0, 0, 1}), 0.02);
  EXPECT_LT(angle(back.normals[3], {1, 0, 0}), 0.02);
  expect_same_properties(look, back);
}

TEST(DracoSection, DamageIsToldOrHarmless) {
  const auto whole = tetprep::encode_draco(rich());
  Appearance back;
  for (std::size_t size = 0; size < whole.size(); ++size) {
    const auto failure = failure_of([&] { tetprep::decode_draco(std::span(whole).first(size), back); });
    EXPECT_EQ(failure.code(), tetprep::ExitCode::invalid) << size;
    EXPECT_TRUE(mentions(failure.what(), {"DRAC section"}));
  }
  std::mt19937 random(3);
  std::size_t refused = 0;
  for (int round = 0; round < 3000; ++round) {
    auto bytes = whole;
    for (unsigned n = 0; n <= random() % 3; ++n)
      bytes[random() % bytes.size()] = static_cast<std::byte>(random());
    try {
      tetprep::decode_draco(bytes, back);
      for (const auto& corners : back.corners)
        for (const Index corner : corners) ASSERT_TRUE(corner == kNone || corner < back.surface_points);
      for (const auto& property : back.properties) ASSERT_EQ(property.values.size(), back.surface_points);
    } catch (const tetprep::Failure& failure) {
      ASSERT_EQ(failure.code(), tetprep::ExitCode::invalid) << failure.what();
      ++refused;
    }
  }
  EXPECT_GT(refused, 300u);
}

TEST(DracoSection, MustHaveAFaceForEveryTriangle) {
  Appearance look = rich();
  look.corners.pop_back();
  const auto sections = to_sections(look, KeepAttributes::normals, true);
  const auto bytes = tetfmt::encode(mesh_with({}, sections), tetfmt::Layout::tet20);
  const auto file = tetfmt::TrustedView::validated(bytes);
  ASSERT_TRUE(file) << tetfmt::to_string(file.error());
  const auto failure = failure_of([&] { tetprep::read_appearance(file->view()); });
  EXPECT_EQ(failure.code(), tetprep::ExitCode::invalid);
  EXPECT_TRUE(mentions(failure.what(), {"11", "12"}));
}

}  // namespace
}  // namespace tetprep_test
