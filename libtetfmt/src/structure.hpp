// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <span>

#include "tetfmt/validate.hpp"
#include "tetfmt/view.hpp"

namespace tetfmt::detail {

/// Level::structure: header, table of contents, lengths, padding. O(sections). Adds what is wrong to
/// `report`.
void check_structure(std::span<const std::byte> bytes, const Limits& limits, Report& report);

/// The table of contents. Only for bytes whose header and toc_count were found sound.
std::span<const SectionEntry> table_of_contents(std::span<const std::byte> bytes);

/// First multiple of the section alignment at or after `offset`.
constexpr std::uint64_t align_section(std::uint64_t offset) {
  return (offset + kSectionAlignment - 1) / kSectionAlignment * kSectionAlignment;
}

/// The stride of a kind that this version knows, 0 for all others.
std::uint32_t known_stride(SectionKind kind, const FileHeader& header);
bool is_required(SectionKind kind);
/// The flags that the reference writer gives a section.
std::uint16_t usual_flags(SectionKind kind);

}  // namespace tetfmt::detail
