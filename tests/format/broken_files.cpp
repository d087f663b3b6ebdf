// SPDX-License-Identifier: AGPL-3.0-or-later
#include "broken_files.hpp"

#include <cmath>
#include <limits>

namespace tetfmt_test {
namespace {

using tetfmt::Code;
using tetfmt::Layout;
using tetfmt::Mesh;

/// A valid Tet20 lattice file, edited as bytes, hashes recomputed.
Bytes edited(const std::function<void(Bytes&)>& edit) {
  Bytes bytes = tetfmt::encode(full_mesh(3), Layout::tet20);
  edit(bytes);
  tetfmt::rehash(bytes);
  return bytes;
}

/// A valid lattice mesh, edited before it is encoded.
Bytes remeshed(const std::function<void(Mesh&)>& edit) {
  Mesh mesh = full_mesh(3);
  edit(mesh);
  return tetfmt::encode(mesh, Layout::tet20);
}

tetfmt::OptionalSection& part(Mesh& mesh, tetfmt::SectionKind kind) {
  for (tetfmt::OptionalSection& section : mesh.optional)
    if (section.kind == kind) return section;
  throw std::out_of_range("part: no such section");
}

void drop(Mesh& mesh, tetfmt::SectionKind kind) {
  std::erase_if(mesh.optional, [&](const auto& section) { return section.kind == kind; });
}

/// A 32-bit word of an optional section.
std::uint32_t& word(Mesh& mesh, tetfmt::SectionKind kind, std::size_t index) {
  return at<std::uint32_t>(part(mesh, kind).bytes, 4 * index);
}

/// A valid mesh with every optional section, edited before it is encoded.
Bytes attributed(const std::function<void(Mesh&)>& edit) {
  Mesh mesh = attributed_mesh();
  edit(mesh);
  return tetfmt::encode(mesh, Layout::tet20);
}

/// The same, its region table edited.
Bytes regioned(const std::function<void(std::vector<tetfmt::Region>&)>& edit) {
  return attributed([&](Mesh& mesh) {
    auto& bytes = part(mesh, tetfmt::kRegions).bytes;
    std::vector<tetfmt::Region> table(bytes.size() / sizeof(tetfmt::Region));
    std::memcpy(table.data(), bytes.data(), bytes.size());
    edit(table);
    part(mesh, tetfmt::kRegions) = optional_section(tetfmt::kRegions, sizeof(tetfmt::Region), table);
  });
}

tetfmt::Tet20& cell(Bytes& bytes, Index t) {
  return element<tetfmt::Tet20>(bytes, tetfmt::kTets, t);
}

/// A tet that the walk enters first from tet 3, the second source, and the ids at their shared face.
struct Step {
  Index tet;
  Index apex, on_face;
};
Step step_from_source() {
  const Mesh mesh = full_mesh(3);
  const Index source = mesh.sources[1];
  for (std::size_t k = 0; k < 4; ++k) {
    const tetfmt::Ref ref = mesh.tets[source].neighbors[k];
    if (!tetfmt::is_tet(ref)) continue;
    const auto& v = mesh.tets[source].vertices;
    for (const Index id : mesh.tets[ref].vertices)
      if (std::find(v.begin(), v.end(), id) == v.end()) return {ref, id, v[k == 0 ? 1 : 0]};
  }
  throw std::logic_error("tet 3 has no free face");
}

/// A cell with two free neighbours, and their slots.
struct TwoSlots {
  Index tet;
  std::size_t first, second;
};
TwoSlots two_free_slots() {
  const Mesh mesh = full_mesh(3);
  for (Index t = 4; t < mesh.tets.size(); ++t) {
    if (t == mesh.sources[0]) continue;
    std::vector<std::size_t> slots;
    for (std::size_t k = 0; k < 4; ++k)
      if (tetfmt::is_tet(mesh.tets[t].neighbors[k])) slots.push_back(k);
    if (slots.size() >= 2) return {t, slots[0], slots[1]};
  }
  throw std::logic_error("no such tet");
}

}  // namespace

const std::vector<BrokenFile>& broken_files() {
  using namespace tetfmt;
  static const std::vector<BrokenFile> all = {
      {Code::too_short, "no bytes", [] { return Bytes(); }},
      {Code::too_short, "127 bytes",
       [] {
         Bytes bytes = encode(one_tet(), Layout::tet20);
         bytes.resize(127);
         return bytes;
       }},
      {Code::bad_magic, "CR LF became LF", [] { return edited([](Bytes& b) { b.erase(b.begin() + 4); }); }},
      {Code::bad_magic, "high bit cleared", [] { return edited([](Bytes& b) { b[0] = std::byte{9}; }); }},
      {Code::unsupported_major, "version 2", [] { return edited([](Bytes& b) { header(b).major = 2; }); }},
      {Code::header_field, "header_bytes", [] { return edited([](Bytes& b) { ++header(b).header_bytes; }); }},
      {Code::header_field, "toc_offset", [] { return edited([](Bytes& b) { header(b).toc_offset = 192; }); }},
      {Code::header_field, "stride", [] { return edited([](Bytes& b) { header(b).tet_stride = 24; }); }},
      {Code::header_field, "no tets", [] { return edited([](Bytes& b) { header(b).tet_count = 0; }); }},
      {Code::header_field, "odd sides", [] { return edited([](Bytes& b) { --header(b).side_count; }); }},
      {Code::header_field, "no source", [] { return edited([](Bytes& b) { header(b).source_count = 0; }); }},
      {Code::header_field, "grid", [] { return edited([](Bytes& b) { header(b).grid_exponent = 104; }); }},
      {Code::header_field, "flags", [] { return edited([](Bytes& b) { header(b).flags = 2; }); }},
      {Code::missing_section, "partial without regions",
       [] { return edited([](Bytes& b) { header(b).flags = 1; }); }},
      {Code::header_field, "reserved", [] { return edited([](Bytes& b) { header(b).reserved[1] = 1; }); }},
      {Code::file_length, "one byte missing", [] { return edited([](Bytes& b) { b.pop_back(); }); }},
      {Code::file_length, "a byte that no section has",
       [] {
         return edited([](Bytes& b) {
           b.push_back(std::byte{0});
           header(b).file_bytes = b.size();
         });
       }},
      {Code::toc_range, "255 sections",
       [] {
         Bytes bytes = encode(full_mesh(7), Layout::tet20);
         header(bytes).toc_count = 255;
         rehash(bytes);
         return bytes;
       }},
      {Code::toc_range, "more sections than bytes",
       [] {
         Bytes bytes = encode(two_tets(), Layout::tet20);
         header(bytes).toc_count = 13;
         rehash(bytes);
         return bytes;
       }},
      {Code::section_field, "not required",
       [] { return edited([](Bytes& b) { entry(b, kVertices).flags = 0; }); }},
      {Code::section_field, "flag", [] { return edited([](Bytes& b) { entry(b, kVertices).flags = 5; }); }},
      {Code::section_field, "META required",
       [] { return edited([](Bytes& b) { entry(b, kMetadata).flags = 1; }); }},
      {Code::section_field, "two BNDS in one",
       [] { return attributed([](Mesh& m) { part(m, kSurfaceBounds).bytes.resize(48); }); }},
      {Code::section_field, "REGN safe to copy",
       [] {
         Bytes bytes = encode(attributed_mesh(), Layout::tet20);
         entry(bytes, kRegions).flags = kSafeToCopy;
         rehash(bytes);
         return bytes;
       }},
      {Code::section_field, "version", [] { return edited([](Bytes& b) { entry(b, kSides).version = 2; }); }},
      {Code::section_field, "stride",
       [] {
         return edited([](Bytes& b) {
           entry(b, kVertices).stride = 24;
           entry(b, kVertices).count /= 2;
         });
       }},
      {Code::section_field, "reserved",
       [] { return edited([](Bytes& b) { entry(b, kSides).reserved = 1; }); }},
      {Code::section_offset, "64 too far",
       [] { return edited([](Bytes& b) { entry(b, kSides).offset += 64; }); }},
      {Code::section_offset, "overlap", [] { return edited([](Bytes& b) { entry(b, kSides).offset = 0; }); }},
      {Code::section_offset, "a hole, all else right",
       [] {
         return edited([](Bytes& b) {
           auto& meta = entry(b, kMetadata);
           b.insert(b.begin() + static_cast<std::ptrdiff_t>(meta.offset), 64, std::byte{0});
           entry(b, kMetadata).offset += 64;
           header(b).file_bytes = b.size();
         });
       }},
      {Code::section_offset, "not aligned, all else right",
       [] {
         return edited([](Bytes& b) {
           const auto before = entry(b, kTriangles);
           const std::uint64_t end = before.offset + before.stored_bytes, start = entry(b, kMetadata).offset;
           if (end == start) throw std::logic_error("there is no padding to remove");
           entry(b, kMetadata).offset = end;
           b.erase(b.begin() + static_cast<std::ptrdiff_t>(end),
                   b.begin() + static_cast<std::ptrdiff_t>(start));
           header(b).file_bytes = b.size();
         });
       }},
      {Code::section_length, "count", [] { return edited([](Bytes& b) { ++entry(b, kTets).count; }); }},
      {Code::section_length, "product overflows",
       [] {
         return edited([](Bytes& b) {
           // 2^62 * 20 is 0 in 64 bits, so this product comes out right.
           entry(b, kTets).count += std::uint64_t{1} << 62;
         });
       }},
      {Code::section_length, "beyond the file",
       [] {
         return edited([](Bytes& b) {
           auto& meta = entry(b, kMetadata);
           meta.count = meta.raw_bytes = meta.stored_bytes = meta.stored_bytes + 1;
         });
       }},
      {Code::section_length, "sum overflows",
       [] {
         return edited([](Bytes& b) {
           auto& meta = entry(b, kMetadata);
           meta.count = meta.raw_bytes = meta.stored_bytes = ~std::uint64_t{0} - meta.offset + 2;
         });
       }},
      {Code::duplicate_section, "two SIDE",
       [] {
         Bytes bytes = encode(two_tets(), Layout::tet20);
         std::vector<Part> parts = disassemble(bytes);
         parts.push_back(parts[4]);
         return assemble(header(bytes), parts);
       }},
      {Code::missing_section, "no HULL",
       [] {
         Bytes bytes = encode(two_tets(), Layout::tet20);
         std::vector<Part> parts = disassemble(bytes);
         parts.erase(parts.begin() + 1);
         return assemble(header(bytes), parts);
       }},
      {Code::unknown_required_section, "PAGE",
       [] {
         SectionEntry page;
         page.kind = section_kind("PAGE");
         page.flags = kRequired;
         page.stride = 1;
         return with_section(encode(two_tets(), Layout::tet20), page, "");
       }},
      {Code::unsupported_codec, "codec 1",
       [] { return edited([](Bytes& b) { entry(b, kTets).codec = 1; }); }},
      {Code::padding, "after SRCE",
       [] {
         return edited([](Bytes& b) {
           const auto& source = entry(b, kSources);
           b[source.offset + source.stored_bytes] = std::byte{1};
         });
       }},
      {Code::count_mismatch, "triangles",
       [] { return edited([](Bytes& b) { --header(b).triangle_count; }); }},
      {Code::count_mismatch, "vertices", [] { return edited([](Bytes& b) { ++header(b).vertex_count; }); }},
      {Code::limit, "hull of 4097", [] { return edited([](Bytes& b) { header(b).hull_count = 4097; }); }},
      {Code::limit, "2^31 tets", [] { return edited([](Bytes& b) { header(b).tet_count = 0x80000000; }); }},
      {Code::limit, "sources", [] { return edited([](Bytes& b) { header(b).source_count = 163; }); }},
      {Code::header_hash, "origin",
       [] {
         Bytes bytes = encode(two_tets(), Layout::tet20);
         header(bytes).origin[0] += 1;
         return bytes;
       }},
      {Code::toc_hash, "flags",
       [] {
         Bytes bytes = encode(two_tets(), Layout::tet20);
         entry(bytes, kVertices).flags |= kSafeToCopy;
         return bytes;
       }},
      {Code::section_hash, "a vertex",
       [] {
         Bytes bytes = encode(two_tets(), Layout::tet20);
         element<Vec3f>(bytes, kVertices, 1).z += 0.25f;
         return bytes;
       }},

      {Code::reference_range, "tet", [] { return edited([](Bytes& b) { cell(b, 7).neighbors[2] = 162; }); }},
      {Code::reference_range, "side",
       [] { return edited([](Bytes& b) { cell(b, 7).neighbors[2] = side_ref(24); }); }},
      {Code::reference_range, "a side's tet",
       [] { return edited([](Bytes& b) { element<Side>(b, kSides, 5).tet = 162; }); }},
      {Code::vertex_range, "high bit",
       [] { return edited([](Bytes& b) { cell(b, 7).vertex_xor ^= 0x80000000; }); }},
      {Code::repeated_vertex, "apex on the face",
       [] {
         return edited([](Bytes& b) {
           const Step step = step_from_source();
           cell(b, step.tet).vertex_xor ^= step.apex ^ step.on_face;
         });
       }},
      {Code::self_neighbor, "itself",
       [] {
         return edited([](Bytes& b) {
           cell(b, two_free_slots().tet).neighbors[two_free_slots().first] = two_free_slots().tet;
         });
       }},
      {Code::duplicate_neighbor, "twice",
       [] {
         return edited([](Bytes& b) {
           const TwoSlots at = two_free_slots();
           cell(b, at.tet).neighbors[at.first] = cell(b, at.tet).neighbors[at.second];
         });
       }},
      {Code::asymmetric, "one-sided",
       [] {
         return edited(
             [](Bytes& b) { cell(b, two_free_slots().tet).neighbors[two_free_slots().first] = kHull; });
       }},
      {Code::asymmetric, "two tets claim the same neighbour, and the walk comes from the wrong one",
       [] {
         Mesh mesh = one_tet();
         mesh.vertices.insert(mesh.vertices.end(), {{0, 0, -1}, {0, 0, -2}});
         mesh.tets = {{{0, 1, 2, 3}, {kHull, kHull, kHull, 2}},
                      {{0, 1, 2, 4}, {kHull, kHull, kHull, 0}},
                      {{0, 1, 2, 5}, {kHull, kHull, kHull, 0}}};
         mesh.sources = {1};
         return encode(mesh, Layout::tet20);
       }},
      {Code::face_mismatch, "slots exchanged",
       [] {
         return edited([](Bytes& b) {
           const TwoSlots at = two_free_slots();
           std::swap(cell(b, at.tet).neighbors[at.first], cell(b, at.tet).neighbors[at.second]);
         });
       }},
      {Code::source_mismatch, "reserved",
       [] { return edited([](Bytes& b) { element<SourceTet>(b, kSources, 0).reserved = 1; }); }},
      {Code::source_mismatch, "absent tet",
       [] { return edited([](Bytes& b) { element<SourceTet>(b, kSources, 0).tet = 162; }); }},
      {Code::source_mismatch, "another tet",
       [] { return edited([](Bytes& b) { ++element<SourceTet>(b, kSources, 0).tet; }); }},
      {Code::source_mismatch, "ids not ascending",
       [] {
         return edited([](Bytes& b) {
           auto& v = element<SourceTet>(b, kSources, 0).vertices;
           std::swap(v[0], v[1]);
         });
       }},
      {Code::source_mismatch, "neighbour",
       [] { return edited([](Bytes& b) { element<SourceTet>(b, kSources, 1).neighbors[3] ^= 1; }); }},
      {Code::source_mismatch, "same tet, other ids of the same xor",
       [] {
         return edited([](Bytes& b) {
           element<SourceTet>(b, kSources, 1) = element<SourceTet>(b, kSources, 0);
           auto& v = element<SourceTet>(b, kSources, 1).vertices;
           const Index x = v[0] ^ v[1] ^ v[2] ^ v[3];
           for (Index a = 0; a < 4; ++a)
             for (Index d = 60; d < 64; ++d)
               if (const Index c = x ^ a ^ d ^ 20; c > 20 && c < d && a != v[0]) v = {a, 20, c, d};
         });
       }},
      {Code::unreachable, "an island",
       [] {
         Mesh mesh = one_tet();  // tet 1 refers to tet 2 and back; nothing refers to either
         mesh.tets.push_back({{0, 1, 2, 3}, {2, 2, 2, 2}});
         mesh.tets.push_back({{0, 1, 2, 3}, {1, 1, 1, 1}});
         return encode(mesh, Layout::tet20);
       }},
      {Code::orphan_vertex, "a fifth vertex",
       [] {
         Mesh mesh = one_tet();
         mesh.vertices.push_back({0.25f, 0.25f, 0.25f});
         return encode(mesh, Layout::tet20);
       }},
      {Code::hull_mismatch, "order",
       [] {
         return edited([](Bytes& b) {
           std::swap(element<HullFace>(b, kHullFaces, 3), element<HullFace>(b, kHullFaces, 4));
         });
       }},
      {Code::hull_mismatch, "another face",
       [] { return edited([](Bytes& b) { ++element<HullFace>(b, kHullFaces, 107).vertices[2]; }); }},
      {Code::hull_mismatch, "the same face twice",
       [] {
         return edited(
             [](Bytes& b) { element<HullFace>(b, kHullFaces, 3) = element<HullFace>(b, kHullFaces, 4); });
       }},
      {Code::hull_mismatch, "a face too many",
       [] {
         Bytes bytes = encode(two_tets(), Layout::tet20);
         std::vector<Part> parts = disassemble(bytes);
         const HullFace inner = {0, {0, 2, 4}};  // between the second and the third entry
         const auto raw = std::as_bytes(std::span(&inner, 1));
         parts[1].contents.insert(parts[1].contents.begin() + 32, raw.begin(), raw.end());
         parts[1].entry.count = 7;
         parts[1].entry.raw_bytes = 7 * sizeof(HullFace);
         header(bytes).hull_count = 7;
         return assemble(header(bytes), parts);
       }},

      {Code::non_finite, "NaN",
       [] { return remeshed([](Mesh& m) { m.vertices[5].y = std::numeric_limits<float>::quiet_NaN(); }); }},
      {Code::non_finite, "infinity",
       [] {
         return edited(
             [](Bytes& b) { element<Vec3f>(b, kVertices, 5).x = -std::numeric_limits<float>::infinity(); });
       }},
      {Code::non_finite, "origin", [] { return remeshed([](Mesh& m) { m.origin[1] = std::nan(""); }); }},
      {Code::off_grid, "between grid points",
       [] { return edited([](Bytes& b) { element<Vec3f>(b, kVertices, 5).y += 0.125f; }); }},
      {Code::off_grid, "too far",
       [] { return edited([](Bytes& b) { element<Vec3f>(b, kVertices, 63).y = 0x1.000002p22f; }); }},
      {Code::grid_not_canonical, "finer than need be",
       [] { return edited([](Bytes& b) { --header(b).grid_exponent; }); }},
      {Code::flat, "coplanar",
       [] {
         Mesh mesh = one_tet();
         mesh.vertices[3] = {1, 1, 0};
         return encode(mesh, Layout::tet20);
       }},
      {Code::inverted, "both above",
       [] {
         Mesh mesh = two_tets();
         mesh.vertices[3].z = 1.25f;
         return encode(mesh, Layout::tet20);
       }},
      {Code::hull_not_convex, "a dent",
       [] {
         Mesh mesh = two_tets();
         mesh.vertices[1].x = 20;
         return encode(mesh, Layout::tet20);
       }},
      {Code::overlap, "the same place twice",
       [] {
         Mesh mesh = one_tet();
         mesh.vertices.insert(mesh.vertices.end(), {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}});
         mesh.tets.push_back({{4, 5, 6, 7}, {kHull, kHull, kHull, kHull}});
         mesh.sources = {0, 1};
         return encode(mesh, Layout::tet20);
       }},

      {Code::side_tet, "the next tet",
       [] { return edited([](Bytes& b) { element<Side>(b, kSides, 4).tet ^= 1; }); }},
      {Code::side_unreferenced, "a pair that no tet knows",
       [] { return remeshed([](Mesh& m) {
              m.sides.insert(m.sides.end(), {{0, 0, 0}, {1, 0, 0}});
            }); }},
      {Code::side_unreferenced, "one side, two faces",
       [] {
         Mesh mesh = two_tets();
         mesh.tets[1].neighbors[0] = side_ref(0);
         return encode(mesh, Layout::tet20);
       }},
      {Code::twin_mismatch, "triangle", [] { return remeshed([](Mesh& m) { m.sides[3].triangle ^= 1; }); }},
      {Code::twin_mismatch, "material", [] { return remeshed([](Mesh& m) { m.sides[3].material ^= 1; }); }},
      {Code::triangle_range, "absent",
       [] { return remeshed([](Mesh& m) { m.sides[2].triangle = m.sides[3].triangle = 13; }); }},
      {Code::triangle_range, "dropped",
       [] { return remeshed([](Mesh& m) { m.sides[2].triangle = m.sides[3].triangle = 12; }); }},
      {Code::triangle_corner, "twice",
       [] { return remeshed([](Mesh& m) { m.triangles[2].vertices[1] = m.triangles[2].vertices[2]; }); }},
      {Code::triangle_corner, "out of range",
       [] { return remeshed([](Mesh& m) { m.triangles[2].vertices[0] = 64; }); }},
      {Code::triangle_corner, "half absent",
       [] { return remeshed([](Mesh& m) { m.triangles[2].vertices[0] = kNone; }); }},
      {Code::triangle_corner, "half dropped",
       [] { return remeshed([](Mesh& m) { m.triangles[12].vertices[2] = 0; }); }},
      {Code::material_range, "no such material",
       [] { return remeshed([](Mesh& m) { m.sides[2].material = m.sides[3].material = 1; }); }},
      {Code::off_triangle, "another triangle",
       [] {
         return remeshed([](Mesh& m) {
           for (const std::size_t side : {0u, 1u}) m.sides[side].triangle = (m.sides[side].triangle + 5) % 12;
         });
       }},
      {Code::wrong_side, "corners the other way round",
       [] {
         return remeshed([](Mesh& m) { std::swap(m.triangles[4].vertices[1], m.triangles[4].vertices[2]); });
       }},
      {Code::not_covered, "a triangle without faces",
       [] { return remeshed([](Mesh& m) {
              m.triangles[12].vertices = {0, 1, 5};
            }); }},
      {Code::not_covered, "a degenerate triangle without faces",
       [] { return remeshed([](Mesh& m) {
              m.triangles[12].vertices = {0, 1, 2};
            }); }},
      {Code::not_covered, "one of four faces missing",
       [] {
         Mesh mesh = lattice_mesh(4);
         // Take the last face out of its surface: its two tets become free neighbours.
         const auto last = static_cast<Index>(mesh.sides.size() - 2);
         const Index front = mesh.sides[last].tet, back = mesh.sides[last + 1].tet;
         for (Ref& ref : mesh.tets[front].neighbors)
           if (ref == side_ref(last)) ref = back;
         for (Ref& ref : mesh.tets[back].neighbors)
           if (ref == side_ref(last + 1)) ref = front;
         mesh.sides.resize(last);
         return encode(mesh, Layout::tet20);
       }},
      {Code::partial_mismatch, "nothing was left out",
       [] {
         Bytes bytes = encode(region_mesh(3, {0, 1}), Layout::tet20);
         header(bytes).flags = 1;
         rehash(bytes);
         return bytes;
       }},
      {Code::partial_mismatch, "a face without any tet",
       [] {
         Mesh mesh = region_mesh(3, {0});
         mesh.sides.insert(mesh.sides.end(), {{kNone, 0, 0}, {kNone, 0, 0}});
         return encode(mesh, Layout::tet20);
       }},
      {Code::reference_range, "a side without a tet in a whole file",
       [] {
         Bytes bytes = encode(region_mesh(3, {0}), Layout::tet20);
         header(bytes).flags = 0;
         rehash(bytes);
         return bytes;
       }},
      {Code::crossing, "two rooms that cross",
       [] { return encode(joined(region_mesh(4, {1}), region_mesh(4, {1}), 1), Layout::tet20); }},
      {Code::crossing, "two rooms in one place",
       [] { return encode(joined(region_mesh(3, {1}), region_mesh(3, {1}), 0), Layout::tet20); }},
      {Code::crossing, "two rooms that touch along a wall",
       [] {
         // One room twice; one is moved by its width in x by hand, so that they share no ids.
         Mesh mesh = joined(region_mesh(3, {1}), region_mesh(3, {1}), 0);
         for (std::size_t i = mesh.vertices.size() / 2; i < mesh.vertices.size(); ++i)
           mesh.vertices[i].x += 1;
         return encode(mesh, Layout::tet20);
       }},
      {Code::overlap, "a room inside another",
       [] { return encode(joined(region_mesh(7, {1}), region_mesh(3, {1}), 2), Layout::tet20); }},
      {Code::overlap, "a room inside what is around another",
       [] {
         LatticeOptions corner;
         corner.high = 3;
         const Mesh around = with_regions(lattice_mesh(9, corner), {0});
         return encode(joined(around, region_mesh(3, {1}), 3), Layout::tet20);
       }},
      {Code::region_table, "a gap",
       [] { return regioned([](std::vector<Region>& r) { ++r[1].first_tet, --r[1].tet_count; }); }},
      {Code::region_table, "too short",
       [] { return regioned([](std::vector<Region>& r) { r.pop_back(); }); }},
      {Code::region_table, "no entries", [] { return regioned([](std::vector<Region>& r) { r.clear(); }); }},
      {Code::region_table, "past the end",
       [] { return regioned([](std::vector<Region>& r) { ++r[1].tet_count; }); }},
      {Code::region_table, "without tets",
       [] {
         return regioned([](std::vector<Region>& r) {
           r.push_back(r[1]);
           r[2].id = 2;
           r[2].first_tet += r[2].tet_count;
           r[2].tet_count = 0;
         });
       }},
      {Code::region_table, "ids descend",
       [] { return regioned([](std::vector<Region>& r) { r[0].id = 1; }); }},
      {Code::region_table, "reserved",
       [] { return regioned([](std::vector<Region>& r) { r[1].reserved = 1; }); }},
      {Code::region_extent, "a tet in the wrong region",
       [] {
         return regioned([](std::vector<Region>& r) {
           --r[0].tet_count;
           --r[1].first_tet;
           ++r[1].tet_count;
         });
       }},
      {Code::region_extent, "two spaces as one",
       [] {
         return regioned([](std::vector<Region>& r) {
           r[0].tet_count += r[1].tet_count;
           r.pop_back();
         });
       }},
      {Code::region_extent, "the hull is not in region 0",
       [] { return regioned([](std::vector<Region>& r) { r[0].id = 1, r[1].id = 2; }); }},
      {Code::region_measure, "volume",
       [] { return regioned([](std::vector<Region>& r) { r[1].volume = std::nextafter(r[1].volume, 0); }); }},
      {Code::region_measure, "bounds",
       [] { return regioned([](std::vector<Region>& r) { r[0].upper.y += 1; }); }},
      {Code::surface_bounds, "too small",
       [] {
         return attributed(
             [](Mesh& m) { std::swap(word(m, kSurfaceBounds, 0), word(m, kSurfaceBounds, 3)); });
       }},
      {Code::surface_bounds, "too large",
       [] {
         return attributed([](Mesh& m) { word(m, kSurfaceBounds, 4) = std::bit_cast<std::uint32_t>(1e9f); });
       }},
      {Code::attribute_count, "ORIG without SURF",
       [] { return attributed([](Mesh& m) { drop(m, kInputTriangles); }); }},
      {Code::attribute_count, "SURF without ORIG",
       [] { return attributed([](Mesh& m) { drop(m, kOrigins); }); }},
      {Code::attribute_count, "ORIG too short",
       [] { return attributed([](Mesh& m) { part(m, kOrigins).bytes.resize(4); }); }},
      {Code::attribute_count, "TOBJ too short",
       [] { return attributed([](Mesh& m) { part(m, kTriangleObjects).bytes.resize(20); }); }},
      {Code::attribute_count, "TOBJ without OBJT",
       [] { return attributed([](Mesh& m) { drop(m, kObjects); }); }},
      {Code::attribute_count, "CORN too long",
       [] { return attributed([](Mesh& m) { part(m, kCorners).bytes.resize(84); }); }},
      {Code::attribute_count, "NORM without CORN",
       [] { return attributed([](Mesh& m) { drop(m, kCorners); }); }},
      {Code::attribute_count, "TEXC too short",
       [] { return attributed([](Mesh& m) { part(m, kTexcoords).bytes.resize(24); }); }},
      {Code::attribute_count, "DRAC beside what it stands for",
       [] { return attributed([](Mesh& m) {
              m.optional.push_back({kDracoSurface, 1, Bytes(8)});
            }); }},
      {Code::attribute_count, "PROP without PVAL",
       [] { return attributed([](Mesh& m) { drop(m, kPropertyValues); }); }},
      {Code::attribute_count, "PVAL without PROP",
       [] { return attributed([](Mesh& m) { drop(m, kProperties); }); }},
      {Code::attribute_count, "PVAL too short",
       [] { return attributed([](Mesh& m) { part(m, kPropertyValues).bytes.resize(56); }); }},
      {Code::attribute_index, "ORIG", [] { return attributed([](Mesh& m) { word(m, kOrigins, 3) = 6; }); }},
      {Code::attribute_index, "SURF",
       [] { return attributed([](Mesh& m) { word(m, kInputTriangles, 4) = 64; }); }},
      {Code::attribute_index, "TOBJ",
       [] { return attributed([](Mesh& m) { word(m, kTriangleObjects, 5) = 2; }); }},
      {Code::attribute_index, "CORN", [] { return attributed([](Mesh& m) { word(m, kCorners, 2) = 4; }); }},
      {Code::text, "not terminated",
       [] { return attributed([](Mesh& m) { part(m, kTexts).bytes.pop_back(); }); }},
      {Code::text, "material's name",
       [] { return attributed([](Mesh& m) { word(m, kMaterials, 27) = 34; }); }},
      {Code::text, "texture",
       [] { return attributed([](Mesh& m) { word(m, kMaterials, 28) = 0x80000000; }); }},
      {Code::text, "object", [] { return attributed([](Mesh& m) { word(m, kObjects, 1) = 40; }); }},
      {Code::text, "property", [] { return attributed([](Mesh& m) { word(m, kProperties, 0) = 40; }); }},
      {Code::text, "no texts at all", [] { return attributed([](Mesh& m) { drop(m, kTexts); }); }},
      {Code::attribute_field, "material",
       [] { return attributed([](Mesh& m) { word(m, kMaterials, 31) = 1; }); }},
      {Code::attribute_field, "property",
       [] { return attributed([](Mesh& m) { word(m, kProperties, 3) = 8; }); }},
  };
  return all;
}

}  // namespace tetfmt_test
