// SPDX-License-Identifier: MIT
#include "structure.hpp"

#include <algorithm>
#include <array>
#include <limits>

#include "report.hpp"

namespace tetfmt::detail {
namespace {

constexpr std::array kRequiredKinds = {kSources, kHullFaces, kVertices, kTets, kSides, kTriangles};

struct OptionalKind {
  SectionKind kind;
  std::uint32_t stride;
  std::uint16_t flags;  ///< the reference writer's
};
/// What only speaks of input triangles is still true when tetrahedra and vertices are rewritten.
constexpr OptionalKind kOptionalKinds[] = {{kMetadata, 1, kSafeToCopy},
                                           {kRegions, sizeof(Region), 0},
                                           {kSurfaceBounds, sizeof(SurfaceBounds), 0},
                                           {kOrigins, sizeof(Index), 0},
                                           {kInputTriangles, sizeof(Triangle), 0},
                                           {kTexts, 1, kSafeToCopy},
                                           {kMaterials, sizeof(Material), kSafeToCopy},
                                           {kObjects, sizeof(Object), kSafeToCopy},
                                           {kTriangleObjects, sizeof(Index), kSafeToCopy},
                                           {kCorners, 3 * sizeof(Index), kSafeToCopy},
                                           {kNormals, 3 * sizeof(float), kSafeToCopy},
                                           {kTexcoords, 2 * sizeof(float), kSafeToCopy},
                                           {kColors, 4 * sizeof(float), kSafeToCopy},
                                           {kProperties, sizeof(Property), kSafeToCopy},
                                           {kPropertyValues, sizeof(double), kSafeToCopy},
                                           {kDracoSurface, 1, kSafeToCopy}};

const OptionalKind* optional_kind(SectionKind kind) {
  const auto* const end = std::end(kOptionalKinds);
  const auto* const found = std::find_if(
      std::begin(kOptionalKinds), end, [&](const OptionalKind& candidate) { return candidate.kind == kind; });
  return found == end ? nullptr : found;
}

std::string kind_text(SectionKind kind) {
  std::string text = "'....'";
  for (unsigned i = 0; i < 4; ++i) {
    const char c = static_cast<char>(static_cast<std::uint32_t>(kind) >> (8 * i));
    if (c >= ' ' && c <= '~') text[i + 1] = c;
  }
  return text;
}

/// True if everything after the header may be looked at.
bool check_header(std::span<const std::byte> bytes, const Limits& limits, Report& report) {
  if (bytes.size() < sizeof(FileHeader)) {
    add_issue(report, Code::too_short, bytes.size(), [&] {
      return "the file has " + str(bytes.size()) + " bytes, a header needs 128: not a tet file, or cut short";
    });
    return false;
  }
  const auto& header = *reinterpret_cast<const FileHeader*>(bytes.data());
  if (header.magic != kMagic) {
    add_issue(report, Code::bad_magic, 0, [&] {
      const bool mangled = std::equal(kMagic.begin() + 1, kMagic.begin() + 4, header.magic.begin() + 1);
      return std::string("the first 8 bytes are not those of a tet file") +
             (mangled ? ", but nearly: transfer it again in binary mode" : "");
    });
    return false;
  }
  if (header.major != kMajor) {
    add_issue(report, Code::unsupported_major, 8, [&] {
      return "format " + str(header.major) + "." + str(header.minor) + ", this reader knows " + str(kMajor) +
             ".x: use a newer version";
    });
    return false;
  }

  bool sound = true;
  const auto bad = [&](std::uint64_t where, const char* field, std::int64_t value, const char* allowed) {
    sound = false;
    add_issue(report, Code::header_field, where,
              [&] { return std::string(field) + " is " + std::to_string(value) + ", must be " + allowed; });
  };
  if (header.header_bytes != 128) bad(12, "header_bytes", header.header_bytes, "128");
  if (header.toc_offset != 128) bad(24, "toc_offset", header.toc_offset, "128");
  if (header.tet_stride != 20 && header.tet_stride != 16)
    bad(36, "tet_stride", header.tet_stride, "20 or 16");
  if (header.tet_count == 0) bad(44, "tet_count", 0, "at least 1");
  if (header.side_count % 2 != 0) bad(48, "side_count", header.side_count, "even");
  if (header.source_count == 0) bad(60, "source_count", 0, "at least 1");
  if (header.grid_exponent < -149 || header.grid_exponent > 103)
    bad(88, "grid_exponent", header.grid_exponent, "from -149 to 103");
  if (header.minor <= kMinor) {  // a newer minor version may have given these a meaning
    if (header.flags & ~kPartial) bad(92, "flags", header.flags, "0 or 1");
    for (std::size_t i = 0; i < header.reserved.size(); ++i)
      if (header.reserved[i] != 0) bad(96 + 8 * i, "reserved", header.reserved[i], "0");
  }

  const auto limit = [&](std::uint64_t where, const char* field, std::uint64_t value, std::uint64_t most) {
    if (value <= most) return;
    sound = false;
    add_issue(report, Code::limit, where,
              [&] { return std::string(field) + " is " + str(value) + ", the limit is " + str(most); });
  };
  limit(40, "vertex_count", header.vertex_count, std::min(kMaxCount, limits.max_vertices));
  limit(44, "tet_count", header.tet_count, std::min(kMaxCount, limits.max_tets));
  limit(48, "side_count", header.side_count, kMaxCount);
  limit(52, "triangle_count", header.triangle_count, kMaxCount);
  limit(56, "hull_count", header.hull_count, kMaxHullFaces);
  limit(60, "source_count", header.source_count, header.tet_count);

  if (header.file_bytes != bytes.size()) {
    add_issue(report, Code::file_length, 16, [&] {
      return "the header says " + str(header.file_bytes) + " bytes, the file has " + str(bytes.size()) +
             (header.file_bytes > bytes.size() ? ": it was cut short" : ": something was appended");
    });
    return false;
  }
  const std::uint64_t toc_bytes = std::uint64_t{header.toc_count} * sizeof(SectionEntry);
  if (toc_bytes + 128 > std::min<std::uint64_t>(kOpeningBytes, bytes.size())) {
    add_issue(report, Code::toc_range, 32, [&] {
      return str(header.toc_count) + " sections do not fit in the first 16384 bytes or in the file";
    });
    return false;
  }
  return sound;
}

void check_entry(const SectionEntry& entry, std::uint64_t where, const FileHeader& header, Report& report) {
  const auto bad = [&](const char* what, std::uint64_t value) {
    add_issue(report, Code::section_field, where, [&] {
      return "section " + kind_text(entry.kind) + ": " + what + " " + str(value) + " is not allowed";
    });
  };
  const bool required = is_required(entry.kind);
  const bool known = required || optional_kind(entry.kind) != nullptr;
  if (!known && (entry.flags & kRequired)) {
    add_issue(report, Code::unknown_required_section, where, [&] {
      return "section " + kind_text(entry.kind) + " is marked as required and unknown to this version";
    });
  }
  if (required != ((entry.flags & kRequired) != 0) && known) bad("flags", entry.flags);
  if (known && !required && (entry.flags & kSafeToCopy & ~usual_flags(entry.kind))) bad("flags", entry.flags);
  if (header.minor <= kMinor) {
    if (entry.flags & ~(kRequired | kSafeToCopy)) bad("flags", entry.flags);
    if (entry.reserved != 0) bad("reserved", entry.reserved);
  }
  if (known && entry.version != kSectionVersion) bad("version", entry.version);
  if (entry.codec != 0 && (known || (entry.flags & kRequired))) {
    add_issue(report, Code::unsupported_codec, where,
              [&] { return "section " + kind_text(entry.kind) + " uses codec " + str(entry.codec); });
  }
  const std::uint32_t stride = known_stride(entry.kind, header);
  // Without a stride, nothing would tie the count (of materials, say) to the bytes that are there.
  if (entry.stride == 0 || (stride != 0 && entry.stride != stride)) bad("stride", entry.stride);

  if (entry.kind == kSurfaceBounds && entry.count != 1) bad("count", entry.count);

  // count * stride by division: the product itself may overflow.
  const bool agrees = entry.stride == 0 ? entry.raw_bytes == 0
                                        : entry.raw_bytes % entry.stride == 0 &&
                                              entry.raw_bytes / entry.stride == entry.count;
  if (!agrees || (entry.codec == 0 && entry.stored_bytes != entry.raw_bytes)) {
    add_issue(report, Code::section_length, where, [&] {
      return "section " + kind_text(entry.kind) + ": " + str(entry.count) + " elements of " +
             str(entry.stride) + " bytes do not make " + str(entry.raw_bytes) + " raw and " +
             str(entry.stored_bytes) + " stored bytes";
    });
  }
}

void check_counts(std::span<const SectionEntry> sections, const FileHeader& header, Report& report) {
  struct Pair {
    SectionKind kind;
    std::uint64_t where, count;
  };
  const Pair pairs[] = {{kVertices, 40, header.vertex_count}, {kTets, 44, header.tet_count},
                        {kSides, 48, header.side_count},      {kTriangles, 52, header.triangle_count},
                        {kHullFaces, 56, header.hull_count},  {kSources, 60, header.source_count}};
  for (const Pair& pair : pairs) {
    for (const SectionEntry& entry : sections) {
      if (entry.kind != pair.kind || entry.count == pair.count) continue;
      add_issue(report, Code::count_mismatch, pair.where, [&] {
        return "the header counts " + str(pair.count) + ", section " + kind_text(pair.kind) + " holds " +
               str(entry.count);
      });
    }
  }
}

}  // namespace

bool is_required(SectionKind kind) {
  return std::find(kRequiredKinds.begin(), kRequiredKinds.end(), kind) != kRequiredKinds.end();
}

std::uint16_t usual_flags(SectionKind kind) {
  const OptionalKind* const optional = optional_kind(kind);
  return optional ? optional->flags : is_required(kind) ? kRequired : kSafeToCopy;
}

std::uint32_t known_stride(SectionKind kind, const FileHeader& header) {
  switch (kind) {
    case kVertices:
      return sizeof(Vec3f);
    case kTets:
      return header.tet_stride;
    case kSources:
      return sizeof(SourceTet);
    case kSides:
      return sizeof(Side);
    case kTriangles:
      return sizeof(Triangle);
    case kHullFaces:
      return sizeof(HullFace);
    default:
      break;
  }
  const OptionalKind* const optional = optional_kind(kind);
  return optional ? optional->stride : 0;
}

std::span<const SectionEntry> table_of_contents(std::span<const std::byte> bytes) {
  const auto& header = *reinterpret_cast<const FileHeader*>(bytes.data());
  return {reinterpret_cast<const SectionEntry*>(bytes.data() + sizeof(FileHeader)), header.toc_count};
}

void check_structure(std::span<const std::byte> bytes, const Limits& limits, Report& report) {
  if (!check_header(bytes, limits, report)) return;
  const auto& header = *reinterpret_cast<const FileHeader*>(bytes.data());
  const auto sections = table_of_contents(bytes);

  std::uint64_t end = sizeof(FileHeader) + sections.size_bytes();
  for (std::size_t i = 0; i < sections.size(); ++i) {
    const SectionEntry& entry = sections[i];
    const std::uint64_t where = sizeof(FileHeader) + i * sizeof(SectionEntry);
    check_entry(entry, where, header, report);

    const auto same_kind = [&](const SectionEntry& other) { return other.kind == entry.kind; };
    if (std::any_of(sections.begin(), sections.begin() + static_cast<std::ptrdiff_t>(i), same_kind)) {
      add_issue(report, Code::duplicate_section, where,
                [&] { return "section " + kind_text(entry.kind) + " appears more than once"; });
    }
    if (entry.offset != align_section(end)) {
      add_issue(report, Code::section_offset, where, [&] {
        return "section " + kind_text(entry.kind) + " starts at " + str(entry.offset) + ", must start at " +
               str(align_section(end));
      });
      return;  // every later offset would be wrong with it
    }
    if (entry.offset > bytes.size() || entry.stored_bytes > bytes.size() - entry.offset) {
      add_issue(report, Code::section_length, where, [&] {
        return "section " + kind_text(entry.kind) + " of " + str(entry.stored_bytes) + " bytes at " +
               str(entry.offset) + " leaves the file of " + str(bytes.size());
      });
      return;
    }
    for (std::uint64_t at = end; at < entry.offset; ++at) {
      if (bytes[at] == std::byte{0}) continue;
      add_issue(report, Code::padding, at, [&] { return std::string("a padding byte is not zero"); });
      break;
    }
    end = entry.offset + entry.stored_bytes;
  }
  if (end != bytes.size()) {
    add_issue(report, Code::file_length, end,
              [&] { return "the last section ends at " + str(end) + ", the file at " + str(bytes.size()); });
  }
  const auto demand = [&](SectionKind kind) {
    if (std::any_of(sections.begin(), sections.end(), [&](const auto& entry) { return entry.kind == kind; }))
      return;
    add_issue(report, Code::missing_section, 128,
              [&] { return "required section " + kind_text(kind) + " is missing"; });
  };
  for (const SectionKind kind : kRequiredKinds) demand(kind);
  // Without a hull, nothing else would tell where the mesh is.
  if (header.flags & kPartial) demand(kRegions);
  check_counts(sections, header, report);
}

}  // namespace tetfmt::detail
