// SPDX-License-Identifier: MIT
// Bytes to typed arrays, without a copy.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "tetfmt/error.hpp"
#include "tetfmt/layout.hpp"

namespace tetfmt {

/// What a reader is willing to accept, on top of the format's own bounds.
struct Limits {
  std::uint64_t max_tets = kMaxCount;
  std::uint64_t max_vertices = kMaxCount;
};

/// A file whose structure was found sound: every span lies inside the bytes. Nothing else is known: indices
/// and references may be anything, so code that follows them must check each one (see TrustedView).
/// The bytes must outlive the view, which copies none of them.
class FileView {
 public:
  /// Checks Level::structure, O(sections + hull faces + regions), allocates nothing that grows with the file.
  /// `bytes` must be aligned to 8 bytes, as mappings and vectors are. Returns the first problem found.
  static Result<FileView> open(std::span<const std::byte> bytes, const Limits& limits = {});

  const FileHeader& header() const { return *reinterpret_cast<const FileHeader*>(bytes_.data()); }
  std::span<const SectionEntry> sections() const { return sections_; }
  Layout layout() const { return static_cast<Layout>(header().tet_stride); }
  std::span<const std::byte> bytes() const { return bytes_; }

  std::span<const Vec3f> vertices() const { return vertices_; }
  /// Empty unless layout() is tet20 (tet16).
  std::span<const Tet20> tets20() const { return tets20_; }
  std::span<const Tet16> tets16() const { return tets16_; }
  Index tet_count() const { return header().tet_count; }
  std::span<const SourceTet> sources() const { return sources_; }
  std::span<const Side> sides() const { return sides_; }
  std::span<const Triangle> triangles() const { return triangles_; }
  std::span<const HullFace> hull() const { return hull_; }
  /// The input's triangles, whose numbers hits report: triangles(), unless the writer had to cut some up.
  std::span<const Triangle> input_triangles() const { return input_triangles_; }
  /// Of each of triangles(), the input triangle that it is a piece of. Empty: they are the same.
  std::span<const Index> origins() const { return origins_; }
  /// Ascending in the tets that they hold; empty if the file does not tell.
  std::span<const Region> regions() const { return regions_; }
  /// The position in regions() of the one that holds `tet`; kNone if none does, or the file does not tell.
  /// O(log regions).
  Index region_of(Index tet) const;
  /// True if tetrahedra were left out, so that some sides have none.
  bool partial() const { return (header().flags & kPartial) != 0; }
  /// A section's entry; null if the file has none of this kind. O(sections).
  const SectionEntry* find(SectionKind kind) const;
  /// The stored bytes of a section; empty if the file has none of this kind.
  std::span<const std::byte> section(SectionKind kind) const;
  /// The box around the hull's vertices (of a partial file, its regions): around everything, if the file is
  /// valid. O(1).
  const Bounds& bounds() const { return bounds_; }
  /// A box that holds every constrained face, if the file is valid: the surface's own, where the file tells
  /// it (BNDS), else bounds(). O(1).
  const Bounds& surface_bounds() const { return surface_bounds_; }
  /// Materials that sides may name: the MATL section's count, or 1 (a default) without one.
  std::uint64_t material_count() const;

 private:
  FileView() = default;
  std::span<const std::byte> bytes_;
  std::span<const SectionEntry> sections_;
  std::span<const Vec3f> vertices_;
  std::span<const Tet20> tets20_;
  std::span<const Tet16> tets16_;
  std::span<const SourceTet> sources_;
  std::span<const Side> sides_;
  std::span<const Triangle> triangles_;
  std::span<const HullFace> hull_;
  std::span<const Triangle> input_triangles_;
  std::span<const Index> origins_;
  std::span<const Region> regions_;
  Bounds bounds_, surface_bounds_;
};

}  // namespace tetfmt
