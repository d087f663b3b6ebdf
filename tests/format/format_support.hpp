// SPDX-License-Identifier: AGPL-3.0-or-later
// Meshes and byte edits that the format's tests share.
#pragma once

#include <cstdint>
#include <cstring>
#include <limits>
#include <set>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "support/lattice_mesh.hpp"
#include "support/region_mesh.hpp"
#include "tetfmt/encode.hpp"
#include "tetfmt/validate.hpp"
#include "tetfmt/view.hpp"

namespace tetfmt_test {

using Bytes = std::vector<std::byte>;
using tetfmt::Index;
using tetfmt::kHull;
using tetfmt::kNone;

inline constexpr tetfmt::Layout kLayouts[] = {tetfmt::Layout::tet20, tetfmt::Layout::tet16};

/// spec/format.md 14.1.
inline tetfmt::Mesh one_tet() {
  tetfmt::Mesh mesh;
  mesh.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  mesh.tets = {{{0, 1, 2, 3}, {kHull, kHull, kHull, kHull}}};
  mesh.metadata = R"({"title":"one tet"})";
  return mesh;
}

/// spec/format.md 14.2 and 14.3.
inline tetfmt::Mesh two_tets() {
  tetfmt::Mesh mesh;
  mesh.origin = {10.5, -2.25, 1000};
  mesh.vertices = {{-0.75f, -0.5f, 0}, {0, 0.25f, 1.5f}, {1, -0.25f, 0}, {0.25f, 0, -1.25f}, {0, 1.25f, 0}};
  mesh.tets = {{{0, 1, 2, 4}, {kHull, tetfmt::side_ref(1), kHull, kHull}},
               {{0, 2, 3, 4}, {kHull, kHull, tetfmt::side_ref(0), kHull}}};
  mesh.sides = {{1, 1, 0}, {0, 1, 0}};
  mesh.triangles = {{}, {{2, 0, 4}}};
  mesh.sources = {1};
  return mesh;
}

/// spec/format.md 14.4: a room of one tetrahedron, what is around it left out.
inline tetfmt::Mesh room() {
  using namespace tetfmt;
  using namespace std::string_view_literals;
  Mesh mesh;
  mesh.vertices = {{0, 0, 0}, {3, 0, 0}, {0, 2, 0}, {0, 0, 1}};
  mesh.tets = {{{0, 1, 2, 3}, {side_ref(1), side_ref(3), side_ref(5), side_ref(7)}}};
  mesh.sides = {{kNone, 0, 0}, {0, 0, 0}, {kNone, 1, 1}, {0, 1, 1},
                {kNone, 2, 0}, {0, 2, 0}, {kNone, 3, 0}, {0, 3, 0}};
  mesh.triangles = {{{1, 2, 3}}, {{0, 3, 2}}, {{0, 1, 3}}, {{0, 2, 1}}};
  const std::vector<Region> regions{{0, 1, 1, 0, 1, {0, 0, 0}, {3, 2, 1}}};
  const auto text = "wall\0door\0room.obj\0"sv;
  std::vector<Material> materials(2);
  materials[0].name = 0;
  materials[1].name = 5;
  materials[1].base_color = {1, 0.5f, 0.25f, 1};
  const std::vector<std::array<Index, 3>> corners{
      {kNone, kNone, kNone}, {0, 1, 2}, {kNone, kNone, kNone}, {kNone, kNone, kNone}};
  const std::vector<std::array<float, 2>> texcoords{{0, 0}, {0, 1}, {1, 0}};
  mesh.optional = {optional_section(kRegions, 48, regions),
                   optional_section(kTexts, 1, std::vector<char>(text.begin(), text.end())),
                   optional_section(kMaterials, 64, materials),
                   optional_section(kObjects, 8, std::vector<Object>{{kNone, 10}}),
                   optional_section(kCorners, 12, corners),
                   optional_section(kTexcoords, 8, texcoords)};
  return mesh;
}

/// A lattice mesh with everything that a file can hold: subdivided and dropped triangles, two sources, an
/// origin, a fractional grid, metadata.
inline tetfmt::Mesh full_mesh(int n) {
  LatticeOptions options;
  options.step = 0.25f;
  options.origin = {1e6, -3.5, 0.125};
  tetfmt::Mesh mesh = lattice_mesh(n, options);
  mesh.triangles.push_back({});
  mesh.sources = {static_cast<Index>(mesh.tets.size() / 2), 3};
  mesh.metadata = R"({"title":"lattice"})";
  return mesh;
}

/// The lattice's inner box and what is around it as regions; or only one of them, the other left out.
inline tetfmt::Mesh region_mesh(int n, const std::vector<Index>& kept) {
  LatticeOptions options;
  options.one_triangle_a_face = n == 3;
  tetfmt::Mesh mesh = lattice_mesh(n, options);
  return with_regions(mesh, kept);
}

/// full_mesh with every optional section that there is: its triangles are pieces of others, with materials,
/// objects and values at surface points.
inline tetfmt::Mesh attributed_mesh() {
  tetfmt::Mesh mesh = with_regions(full_mesh(3), {0, 1});
  std::vector<tetfmt::Triangle> inputs(mesh.triangles.begin(), mesh.triangles.begin() + 6);
  std::vector<Index> origins;
  for (Index i = 0; i < mesh.triangles.size(); ++i) origins.push_back(i % 6);
  using namespace std::string_view_literals;
  const auto text = "\0red\0cube\0scene.obj\0heat\0skin.png\0"sv;
  std::vector<tetfmt::Material> materials(2);
  materials[1].name = 1;
  materials[1].base_color_texture = 25;
  materials[1].base_color = {1, 0, 0, 0.5f};
  for (std::size_t i = 0; i < 4; ++i) mesh.sides[i].material = 1;
  const std::vector<tetfmt::Object> objects{{5, 10}, {}};
  const std::vector<Index> triangle_objects{0, 0, 0, 1, 1, 1};
  std::vector<std::array<Index, 3>> corners(6, {0, 1, 2});
  corners[3] = {3, kNone, 1};
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const std::vector<std::array<float, 3>> normals{{0, 0, 1}, {0, 1, 0}, {nan, nan, nan}, {1, 0, 0}};
  const std::vector<std::array<float, 2>> texcoords{{0, 0}, {0, 1}, {1, 0}, {0.25f, 0.75f}};
  const std::vector<std::array<float, 4>> colors(4, {0.5f, 0.25f, 1, 1});
  const std::vector<tetfmt::Property> properties{{20, 6}, {1, 7}};
  const std::vector<double> values{1, 2, 3, 4, 0.1, 0.2, 0.3, 0.4};
  using namespace tetfmt;
  mesh = with_surface_bounds(mesh);
  mesh.optional.push_back(optional_section(kOrigins, 4, origins));
  mesh.optional.push_back(optional_section(kInputTriangles, 12, inputs));
  mesh.optional.push_back(optional_section(kTexts, 1, std::vector<char>(text.begin(), text.end())));
  mesh.optional.push_back(optional_section(kMaterials, 64, materials));
  mesh.optional.push_back(optional_section(kObjects, 8, objects));
  mesh.optional.push_back(optional_section(kTriangleObjects, 4, triangle_objects));
  mesh.optional.push_back(optional_section(kCorners, 12, corners));
  mesh.optional.push_back(optional_section(kNormals, 12, normals));
  mesh.optional.push_back(optional_section(kTexcoords, 8, texcoords));
  mesh.optional.push_back(optional_section(kColors, 16, colors));
  mesh.optional.push_back(optional_section(kProperties, 8, properties));
  mesh.optional.push_back(optional_section(kPropertyValues, 8, values));
  return mesh;
}

/// The T at a byte offset, to be read or changed in place.
template <class T>
T& at(Bytes& bytes, std::uint64_t offset) {
  if (offset > bytes.size() || sizeof(T) > bytes.size() - offset) throw std::out_of_range("at: past the end");
  return *reinterpret_cast<T*>(bytes.data() + offset);
}

inline tetfmt::FileHeader& header(Bytes& bytes) {
  return at<tetfmt::FileHeader>(bytes, 0);
}

/// The entry of a section that is there.
inline tetfmt::SectionEntry& entry(Bytes& bytes, tetfmt::SectionKind kind) {
  for (std::uint32_t i = 0; i < header(bytes).toc_count; ++i) {
    auto& candidate = at<tetfmt::SectionEntry>(bytes, 128 + 64 * std::uint64_t{i});
    if (candidate.kind == kind) return candidate;
  }
  throw std::out_of_range("entry: no such section");
}

/// Element `index` of a section.
template <class T>
T& element(Bytes& bytes, tetfmt::SectionKind kind, std::size_t index) {
  return at<T>(bytes, entry(bytes, kind).offset + index * sizeof(T));
}

/// A section taken out of a file, to be put into another.
struct Part {
  tetfmt::SectionEntry entry;
  Bytes contents;
};

inline std::vector<Part> disassemble(Bytes bytes) {
  std::vector<Part> parts;
  for (std::uint32_t i = 0; i < header(bytes).toc_count; ++i) {
    const auto& found = at<tetfmt::SectionEntry>(bytes, 128 + 64 * std::uint64_t{i});
    const auto begin = bytes.begin() + static_cast<std::ptrdiff_t>(found.offset);
    parts.push_back({found, Bytes(begin, begin + static_cast<std::ptrdiff_t>(found.stored_bytes))});
  }
  return parts;
}

/// Places the parts in their order and computes offsets, stored lengths and hashes. All else is taken as
/// given.
inline Bytes assemble(tetfmt::FileHeader head, std::vector<Part> parts) {
  Bytes bytes(128 + 64 * parts.size());
  for (std::size_t i = 0; i < parts.size(); ++i) {
    bytes.resize((bytes.size() + 63) / 64 * 64);
    parts[i].entry.offset = bytes.size();
    parts[i].entry.stored_bytes = parts[i].contents.size();
    bytes.insert(bytes.end(), parts[i].contents.begin(), parts[i].contents.end());
    at<tetfmt::SectionEntry>(bytes, 128 + 64 * i) = parts[i].entry;
  }
  head.toc_count = static_cast<std::uint32_t>(parts.size());
  head.file_bytes = bytes.size();
  header(bytes) = head;
  tetfmt::rehash(bytes);
  return bytes;
}

/// The file with one more section, last in the table of contents and in the file.
inline Bytes with_section(Bytes bytes, const tetfmt::SectionEntry& added, std::string_view contents) {
  std::vector<Part> parts = disassemble(bytes);
  const auto raw = std::as_bytes(std::span(contents.data(), contents.size()));
  parts.push_back({added, Bytes(raw.begin(), raw.end())});
  return assemble(header(bytes), parts);
}

inline std::set<tetfmt::Code> codes(const tetfmt::Report& report) {
  std::set<tetfmt::Code> found;
  for (const auto& [code, group] : report.issues) found.insert(code);
  return found;
}

/// All first examples, for a failing test's message.
inline std::string text(const tetfmt::Report& report) {
  std::string lines;
  for (const auto& [code, group] : report.issues) lines += tetfmt::to_string(group.examples.front()) + "\n";
  return lines.empty() ? "no issue" : lines;
}

}  // namespace tetfmt_test
