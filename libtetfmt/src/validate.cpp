// SPDX-License-Identifier: MIT
#include "tetfmt/validate.hpp"

#include "check_attributes.hpp"
#include "geometry.hpp"
#include "hash.hpp"
#include "regions.hpp"
#include "report.hpp"
#include "structure.hpp"
#include "topology.hpp"

namespace tetfmt {
namespace {

void check_hashes(const FileView& view, Report& report) {
  const FileHeader& header = view.header();
  const auto check = [&](Code code, std::uint64_t where, std::span<const std::byte> bytes,
                         std::uint64_t expected) {
    const std::uint64_t found = detail::hash(bytes);
    if (found == expected) return;
    detail::add_issue(report, code, where, [&] {
      return "the bytes hash to " + detail::str(found) + ", the file says " + detail::str(expected);
    });
  };
  check(Code::header_hash, 120, view.bytes().first(offsetof(FileHeader, header_hash)), header.header_hash);
  check(Code::toc_hash, 112, std::as_bytes(view.sections()), header.toc_hash);
  for (const SectionEntry& entry : view.sections())
    check(Code::section_hash, entry.offset, view.bytes().subspan(entry.offset, entry.stored_bytes),
          entry.hash);
}

}  // namespace

Report validate(std::span<const std::byte> bytes, Level level, const Limits& limits) {
  // Structures are read in place. Bytes that lie where that is not allowed (in the middle of a message, say)
  // are moved first.
  if (reinterpret_cast<std::uintptr_t>(bytes.data()) % alignof(FileHeader) != 0) {
    const std::vector<std::byte> aligned(bytes.begin(), bytes.end());
    return validate(aligned, level, limits);
  }
  Report report;
  detail::check_structure(bytes, limits, report);
  if (level == Level::structure || !report.valid()) return report;

  const FileView view = *FileView::open(bytes, limits);
  report.level = Level::checksum;
  check_hashes(view, report);
  if (level == Level::checksum) return report;

  report.level = Level::topology;
  Report topology_report;
  const detail::Topology topology = detail::check_topology(view, topology_report);
  bool sound = topology_report.valid();
  detail::check_attributes(view, topology_report);
  if (sound) detail::check_regions(view, topology, topology_report);
  sound = topology_report.valid();
  report.issues.merge(topology_report.issues);
  if (level == Level::topology || !sound) return report;

  report.level = Level::geometry;
  Report geometry_report;
  detail::check_geometry(view, topology, geometry_report);
  if (geometry_report.valid()) detail::check_region_measures(view, topology, geometry_report);
  report.issues.merge(geometry_report.issues);
  return report;
}

Result<TrustedView> TrustedView::validated(std::span<const std::byte> bytes, Level level,
                                           const Limits& limits) {
  // Less than topology would not make unchecked traversal safe, whatever the caller asked for.
  const Report report = validate(bytes, std::max(level, Level::topology), limits);
  if (!report.valid()) return detail::first_issue(report);
  return TrustedView(*FileView::open(bytes, limits));
}

}  // namespace tetfmt
