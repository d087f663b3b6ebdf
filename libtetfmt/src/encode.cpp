// SPDX-License-Identifier: MIT
#include "tetfmt/encode.hpp"

#include <algorithm>
#include <cassert>
#include <cstring>

#include "hash.hpp"
#include "structure.hpp"

namespace tetfmt {
namespace {

template <class T>
std::span<const std::byte> as_bytes(const std::vector<T>& values) {
  return std::as_bytes(std::span<const T>(values));
}

Index vertex_xor(const FullTet& tet) {
  return tet.vertices[0] ^ tet.vertices[1] ^ tet.vertices[2] ^ tet.vertices[3];
}

std::vector<std::byte> encode_tets(const std::vector<FullTet>& tets, Layout layout) {
  std::vector<std::byte> bytes(tets.size() * static_cast<std::size_t>(layout));
  std::byte* out = bytes.data();
  for (const FullTet& tet : tets) {
    const auto& n = tet.neighbors;
    if (layout == Layout::tet20) {
      const Tet20 cell = {vertex_xor(tet), n};
      std::memcpy(out, &cell, sizeof(cell));
    } else {
      const Tet16 cell = {vertex_xor(tet), {n[0] ^ n[3], n[1] ^ n[3], n[2] ^ n[3]}};
      std::memcpy(out, &cell, sizeof(cell));
    }
    out += static_cast<std::size_t>(layout);
  }
  return bytes;
}

std::vector<HullFace> hull_faces(const std::vector<FullTet>& tets) {
  std::vector<HullFace> faces;
  for (std::size_t t = 0; t < tets.size(); ++t) {
    for (std::size_t k = 0; k < 4; ++k) {
      if (tets[t].neighbors[k] != kHull) continue;
      HullFace face = {static_cast<Index>(t), {}};
      std::copy_if(tets[t].vertices.begin(), tets[t].vertices.end(), face.vertices.begin(),
                   [&](Index id) { return id != tets[t].vertices[k]; });
      faces.push_back(face);
    }
  }
  std::sort(faces.begin(), faces.end());
  return faces;
}

std::vector<SourceTet> source_tets(const Mesh& mesh) {
  std::vector<SourceTet> sources;
  for (const Index t : mesh.sources) sources.push_back({t, mesh.tets[t].vertices, mesh.tets[t].neighbors, 0});
  return sources;
}

template <class T>
T& at(std::vector<std::byte>& bytes, std::uint64_t offset) {
  return *reinterpret_cast<T*>(bytes.data() + offset);
}

}  // namespace

std::vector<std::byte> encode(const Mesh& mesh, Layout layout) {
  assert(!mesh.tets.empty() && !mesh.sources.empty() && mesh.sides.size() % 2 == 0);
  const std::vector<SourceTet> sources = source_tets(mesh);
  const std::vector<HullFace> hull = hull_faces(mesh.tets);
  const std::vector<std::byte> tets = encode_tets(mesh.tets, layout);

  // What a reader touches first comes first; the arrays that a walk alternates between follow.
  struct Section {
    SectionKind kind;
    std::span<const std::byte> bytes;
    std::uint32_t stride = 0;
  };
  std::vector<Section> sections = {
      {kSources, as_bytes(sources)},        {kHullFaces, as_bytes(hull)},
      {kVertices, as_bytes(mesh.vertices)}, {kTets, tets},
      {kSides, as_bytes(mesh.sides)},       {kTriangles, as_bytes(mesh.triangles)}};
  for (const OptionalSection& section : mesh.optional)
    sections.push_back({section.kind, section.bytes, section.stride});
  if (!mesh.metadata.empty()) {
    sections.push_back({kMetadata, std::as_bytes(std::span(mesh.metadata.data(), mesh.metadata.size()))});
  }

  FileHeader header;
  header.toc_count = static_cast<std::uint32_t>(sections.size());
  header.tet_stride = static_cast<std::uint32_t>(layout);
  header.vertex_count = static_cast<std::uint32_t>(mesh.vertices.size());
  header.tet_count = static_cast<std::uint32_t>(mesh.tets.size());
  header.side_count = static_cast<std::uint32_t>(mesh.sides.size());
  header.triangle_count = static_cast<std::uint32_t>(mesh.triangles.size());
  header.hull_count = static_cast<std::uint32_t>(hull.size());
  header.source_count = static_cast<std::uint32_t>(sources.size());
  header.origin = mesh.origin;
  header.grid_exponent = grid_exponent(mesh.vertices);
  const bool partial =
      std::any_of(mesh.sides.begin(), mesh.sides.end(), [](const Side& side) { return side.tet == kNone; });
  if (partial) header.flags |= kPartial;

  std::vector<SectionEntry> entries;
  std::uint64_t end = sizeof(FileHeader) + sections.size() * sizeof(SectionEntry);
  for (const Section& section : sections) {
    SectionEntry entry;
    entry.kind = section.kind;
    entry.flags = detail::usual_flags(section.kind);
    entry.stride = section.stride != 0 ? section.stride : detail::known_stride(section.kind, header);
    entry.offset = detail::align_section(end);
    entry.stored_bytes = entry.raw_bytes = section.bytes.size();
    entry.count = entry.raw_bytes / entry.stride;
    end = entry.offset + entry.stored_bytes;
    entries.push_back(entry);
  }
  header.file_bytes = end;

  std::vector<std::byte> bytes(end);
  std::memcpy(bytes.data(), &header, sizeof(header));
  std::memcpy(bytes.data() + sizeof(header), entries.data(), entries.size() * sizeof(SectionEntry));
  for (std::size_t i = 0; i < sections.size(); ++i) {
    // An empty vector's data() may be null, which memcpy must not be given.
    if (!sections[i].bytes.empty())
      std::memcpy(bytes.data() + entries[i].offset, sections[i].bytes.data(), sections[i].bytes.size());
  }
  rehash(bytes);
  return bytes;
}

void rehash(std::vector<std::byte>& bytes) {
  if (bytes.size() < sizeof(FileHeader)) return;
  auto& header = at<FileHeader>(bytes, 0);
  const std::uint64_t toc_bytes = std::uint64_t{header.toc_count} * sizeof(SectionEntry);
  const std::span<const std::byte> all = bytes;
  if (toc_bytes <= bytes.size() - sizeof(FileHeader)) {
    for (std::uint32_t i = 0; i < header.toc_count; ++i) {
      auto& entry = at<SectionEntry>(bytes, sizeof(FileHeader) + i * sizeof(SectionEntry));
      if (entry.offset > bytes.size() || entry.stored_bytes > bytes.size() - entry.offset) continue;
      entry.hash = detail::hash(all.subspan(entry.offset, entry.stored_bytes));
    }
    header.toc_hash = detail::hash(all.subspan(sizeof(FileHeader), toc_bytes));
  }
  header.header_hash = detail::hash(all.first(offsetof(FileHeader, header_hash)));
}

}  // namespace tetfmt
