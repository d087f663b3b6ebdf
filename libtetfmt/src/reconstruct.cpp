// SPDX-License-Identifier: MIT
#include "tetfmt/reconstruct.hpp"

#include "report.hpp"
#include "structure.hpp"
#include "topology.hpp"

namespace tetfmt {

Result<Mesh> reconstruct(const FileView& view) {
  Report report;
  detail::Topology topology = detail::check_topology(view, report);
  if (!report.valid()) return detail::first_issue(report);

  Mesh mesh;
  mesh.origin = view.header().origin;
  mesh.vertices.assign(view.vertices().begin(), view.vertices().end());
  mesh.tets = std::move(topology.tets);
  mesh.sides.assign(view.sides().begin(), view.sides().end());
  mesh.triangles.assign(view.triangles().begin(), view.triangles().end());
  mesh.sources.clear();
  for (const SourceTet& source : view.sources()) mesh.sources.push_back(source.tet);
  for (const SectionEntry& entry : view.sections()) {
    if (detail::is_required(entry.kind) || entry.kind == kMetadata) continue;
    // Of what nobody here understands, only that is kept which says that it stays true.
    const bool known = detail::known_stride(entry.kind, view.header()) != 0;
    if (entry.codec != 0 || (!known && (entry.flags & kSafeToCopy) == 0)) continue;
    const auto bytes = view.section(entry.kind);
    mesh.optional.push_back({entry.kind, entry.stride, {bytes.begin(), bytes.end()}});
  }
  const auto metadata = view.section(kMetadata);
  mesh.metadata.assign(reinterpret_cast<const char*>(metadata.data()), metadata.size());
  return mesh;
}

}  // namespace tetfmt
