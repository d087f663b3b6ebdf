// SPDX-License-Identifier: AGPL-3.0-or-later
// Mesh to bytes and back: nothing is lost, in either layout, from any source tet.
#include <gtest/gtest.h>

#include "format_support.hpp"
#include "tetfmt/reconstruct.hpp"

namespace tetfmt_test {
namespace {

using tetfmt::Layout;
using tetfmt::Mesh;

template <class T>
bool same_bytes(const std::vector<T>& a, const std::vector<T>& b) {
  return a.size() == b.size() && (a.empty() || std::memcmp(a.data(), b.data(), a.size() * sizeof(T)) == 0);
}

void expect_same(const Mesh& expected, const Mesh& found) {
  EXPECT_EQ(expected.origin, found.origin);
  EXPECT_TRUE(same_bytes(expected.vertices, found.vertices));
  EXPECT_EQ(expected.tets, found.tets);
  EXPECT_TRUE(same_bytes(expected.sides, found.sides));
  EXPECT_TRUE(same_bytes(expected.triangles, found.triangles));
  EXPECT_EQ(expected.sources, found.sources);
  EXPECT_EQ(expected.metadata, found.metadata);
  ASSERT_EQ(expected.optional.size(), found.optional.size());
  for (std::size_t i = 0; i < expected.optional.size(); ++i) {
    EXPECT_EQ(expected.optional[i].kind, found.optional[i].kind);
    EXPECT_EQ(expected.optional[i].stride, found.optional[i].stride);
    EXPECT_EQ(expected.optional[i].bytes, found.optional[i].bytes);
  }
}

Mesh decode(const Bytes& bytes) {
  const auto view = tetfmt::FileView::open(bytes);
  if (!view) throw std::runtime_error(to_string(view.error()));
  auto mesh = tetfmt::reconstruct(*view);
  if (!mesh) throw std::runtime_error(to_string(mesh.error()));
  return std::move(mesh).value();
}

std::vector<Mesh> meshes() {
  std::vector<Mesh> all = {one_tet(), two_tets(), full_mesh(3), full_mesh(4), full_mesh(7)};
  LatticeOptions open;
  open.walls = 0b010110;
  open.one_triangle_a_face = true;
  all.push_back(lattice_mesh(5, open));
  LatticeOptions empty;
  empty.walls = 0;
  all.push_back(lattice_mesh(2, empty));
  all.push_back(attributed_mesh());
  for (const int n : {3, 5})
    for (const std::vector<Index>& kept : {std::vector<Index>{0}, {1}, {0, 1}})
      all.push_back(region_mesh(n, kept));
  return all;
}

TEST(RoundTrip, KeepsEverythingAndIsValid) {
  for (const Mesh& mesh : meshes()) {
    for (const Layout layout : kLayouts) {
      const Bytes bytes = tetfmt::encode(mesh, layout);
      const tetfmt::Report report = tetfmt::validate(bytes);
      ASSERT_TRUE(report.valid()) << mesh.tets.size() << " tets: " << text(report);
      expect_same(mesh, decode(bytes));
    }
  }
}

TEST(RoundTrip, LayoutsConvertIntoEachOther) {
  for (const Mesh& mesh : meshes()) {
    const Bytes tet20 = tetfmt::encode(mesh, Layout::tet20), tet16 = tetfmt::encode(mesh, Layout::tet16);
    EXPECT_EQ(decode(tet20).tets, decode(tet16).tets);
    EXPECT_EQ(tetfmt::encode(decode(tet16), Layout::tet20), tet20);
    EXPECT_EQ(tetfmt::encode(decode(tet20), Layout::tet16), tet16);
  }
}

// Walks cross constrained faces by their twins: one tet is enough, inside the surface or outside.
TEST(RoundTrip, AnyTetCanBeTheOnlySource) {
  Mesh mesh = full_mesh(3);
  for (const Layout layout : kLayouts) {
    for (Index source = 0; source < mesh.tets.size(); ++source) {
      mesh.sources = {source};
      const Bytes bytes = tetfmt::encode(mesh, layout);
      ASSERT_EQ(decode(bytes).tets, mesh.tets) << "source " << source;
    }
  }
}

TEST(RoundTrip, EncodingIsRepeatable) {
  const Mesh mesh = full_mesh(4);
  for (const Layout layout : kLayouts) EXPECT_EQ(tetfmt::encode(mesh, layout), tetfmt::encode(mesh, layout));
}

TEST(RoundTrip, RehashLeavesASoundFileAlone) {
  for (const Layout layout : kLayouts) {
    const Bytes bytes = tetfmt::encode(full_mesh(3), layout);
    Bytes again = bytes;
    tetfmt::rehash(again);
    EXPECT_EQ(bytes, again);
  }
}

TEST(RoundTrip, GridExponentIsTheLargest) {
  EXPECT_EQ(tetfmt::grid_exponent({{0, 0, 0}}), 0);
  EXPECT_EQ(tetfmt::grid_exponent({}), 0);
  EXPECT_EQ(tetfmt::grid_exponent({{0, 8, 0}, {24, 0, -16}}), 3);
  EXPECT_EQ(tetfmt::grid_exponent({{1, 0.375f, 0}}), -3);
  EXPECT_EQ(tetfmt::grid_exponent({{-0.0f, 0x1p-149f, 1}}), -149);
  EXPECT_EQ(tetfmt::grid_exponent({{0x1p127f, 0, 0}}), 127);
  EXPECT_EQ(tetfmt::grid_exponent({{0x1.fffffep127f, 0, 0}}), 104);
}

}  // namespace
}  // namespace tetfmt_test
