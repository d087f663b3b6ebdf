// SPDX-License-Identifier: AGPL-3.0-or-later
// The DRAC section: corners and point attributes of a surface as one Draco mesh.
//
// The mesh has a face for every input triangle and a point for every surface point, both in their order,
// which Draco's sequential encoding keeps. It has no positions. Attributes, each at most once, all optional
// but the mask:
//   NORMAL     3 x float32, octahedral, kDracoNormalBits: unit length
//   TEX_COORD  2 x float32, kDracoTexcoordBits over the larger of the two ranges
//   COLOR      4 x uint8, normalised, if all of them are multiples of 1/255; or 4 x float32, kDracoColorBits
//              over the largest range
//   GENERIC    1 x uint8: the mask. Bits 0 to 2: this point has no normal, texture coordinates, colour. Bit
//              7: no surface point at all; only the last point may have it, and corners without a surface
//              point name it.
//   GENERIC    1 x int32, float32 or float64, for each property in order: its values, exact. Attribute
//              metadata: "name" (text, left out if empty) and "type" (int: PropertyType).
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "prep/appearance.hpp"

namespace tetprep {

inline constexpr int kDracoNormalBits = 14;    ///< directions err by less than 0.02 degrees
inline constexpr int kDracoTexcoordBits = 20;  ///< values err by at most 2^-21 of their range
inline constexpr int kDracoColorBits = 16;     ///< likewise, 2^-17

/// The section's bytes. Of `appearance`, only corners and what belongs to surface points counts; there must
/// be corners. Normals lose their length, and whatever is not finite (or has length zero) comes back as "has
/// none". The same appearance gives the same bytes. Failure: runtime (Draco refused).
std::vector<std::byte> encode_draco(const Appearance& appearance);

/// The reverse, into the same members of `appearance`: NaN where a point has none. Failure: invalid (damaged,
/// or not as above, indices out of range included), unsupported (this build has no Draco). Messages begin
/// with "DRAC section: ".
void decode_draco(std::span<const std::byte> bytes, Appearance& appearance);

}  // namespace tetprep
