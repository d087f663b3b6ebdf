// SPDX-License-Identifier: MIT
#include "tetfmt/view.hpp"

#include <algorithm>
#include <cassert>

#include "report.hpp"
#include "structure.hpp"

namespace tetfmt {
namespace {

template <class T>
std::span<const T> typed(std::span<const std::byte> bytes) {
  return {reinterpret_cast<const T*>(bytes.data()), bytes.size() / sizeof(T)};
}

}  // namespace

Result<FileView> FileView::open(std::span<const std::byte> bytes, const Limits& limits) {
  assert(reinterpret_cast<std::uintptr_t>(bytes.data()) % alignof(FileHeader) == 0);
  Report report;
  detail::check_structure(bytes, limits, report);
  if (!report.valid()) return detail::first_issue(report);

  FileView view;
  view.bytes_ = bytes;
  view.sections_ = detail::table_of_contents(bytes);
  view.vertices_ = typed<Vec3f>(view.section(kVertices));
  if (view.layout() == Layout::tet20) view.tets20_ = typed<Tet20>(view.section(kTets));
  if (view.layout() == Layout::tet16) view.tets16_ = typed<Tet16>(view.section(kTets));
  view.sources_ = typed<SourceTet>(view.section(kSources));
  view.sides_ = typed<Side>(view.section(kSides));
  view.triangles_ = typed<Triangle>(view.section(kTriangles));
  view.hull_ = typed<HullFace>(view.section(kHullFaces));
  view.origins_ = typed<Index>(view.section(kOrigins));
  view.input_triangles_ =
      view.find(kInputTriangles) ? typed<Triangle>(view.section(kInputTriangles)) : view.triangles_;
  view.regions_ = typed<Region>(view.section(kRegions));
  if (view.partial()) {
    for (const Region& region : view.regions_) {
      view.bounds_.add(region.lower);
      view.bounds_.add(region.upper);
    }
  } else {
    for (const HullFace& face : view.hull_) {
      for (const Index id : face.vertices) {
        if (id < view.vertices_.size()) view.bounds_.add(view.vertices_[id]);
      }
    }
  }
  view.surface_bounds_ = view.bounds_;
  if (const auto bounds = typed<SurfaceBounds>(view.section(kSurfaceBounds)); !bounds.empty()) {
    view.surface_bounds_ = {};
    view.surface_bounds_.add(bounds[0].lower);
    view.surface_bounds_.add(bounds[0].upper);
  }
  return view;
}

const SectionEntry* FileView::find(SectionKind kind) const {
  for (const SectionEntry& entry : sections_)
    if (entry.kind == kind) return &entry;
  return nullptr;
}

std::span<const std::byte> FileView::section(SectionKind kind) const {
  const SectionEntry* const entry = find(kind);
  return entry ? bytes_.subspan(entry->offset, entry->stored_bytes) : std::span<const std::byte>{};
}

Index FileView::region_of(Index tet) const {
  const auto after = std::upper_bound(regions_.begin(), regions_.end(), tet,
                                      [](Index t, const Region& region) { return t < region.first_tet; });
  if (after == regions_.begin()) return kNone;
  const Region& region = *(after - 1);
  return tet - region.first_tet < region.tet_count ? static_cast<Index>(after - 1 - regions_.begin()) : kNone;
}

std::uint64_t FileView::material_count() const {
  const SectionEntry* const entry = find(kMaterials);
  return entry ? entry->count : 1;
}

}  // namespace tetfmt
