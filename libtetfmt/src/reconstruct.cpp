// SPDX-License-Identifier: MIT
#include "tetfmt/reconstruct.hpp"

#include "report.hpp"
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
  const auto metadata = view.section(kMetadata);
  mesh.metadata.assign(reinterpret_cast<const char*>(metadata.data()), metadata.size());
  return mesh;
}

}  // namespace tetfmt
