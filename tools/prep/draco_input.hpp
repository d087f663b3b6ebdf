// SPDX-License-Identifier: AGPL-3.0-or-later
// Meshes that Draco compressed, as files of their own or inside of others.
#pragma once

#include <draco/mesh/mesh.h>

#include <array>
#include <memory>
#include <string>
#include <string_view>

#include "prep/read_soup.hpp"

namespace tetprep {

/// `where`: put in front of messages, for a mesh inside of another file. Failure: invalid. Damaged data may
/// name points that do not exist.
std::unique_ptr<draco::Mesh> decode_draco_mesh(const SourceFile& file, std::string_view bytes,
                                               const std::string& where);

/// How much memory decoding may take: a regular mesh takes less than a bit a triangle, so the size of the
/// data bounds little; a lie must still not take the machine down.
std::uint64_t draco_ceiling(std::uint64_t bytes);

/// The first four components of row `row` (in range) of an attribute, 0 for those that it does not have.
std::array<double, 4> draco_row(const draco::PointAttribute& attribute, std::uint32_t row);

/// What whole numbers of an attribute are to be divided by if they stand for fractions and Draco does not
/// know.
double draco_scale(const draco::PointAttribute& attribute);

}  // namespace tetprep
