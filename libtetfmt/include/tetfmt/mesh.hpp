// SPDX-License-Identifier: MIT
// A tetrahedral mesh with nothing compressed: what the encoder takes and what reconstruction gives back.
#pragma once

#include <array>
#include <cstddef>
#include <string>
#include <vector>

#include "tetfmt/layout.hpp"
#include "tetfmt/types.hpp"

namespace tetfmt {

/// A tetrahedron by its four vertex ids, ascending, and what lies across the face opposite each.
struct FullTet {
  std::array<Index, 4> vertices{};
  std::array<Ref, 4> neighbors{};
  friend bool operator==(const FullTet&, const FullTet&) = default;
};

/// An optional section, ready to be stored.
struct OptionalSection {
  SectionKind kind{};
  std::uint32_t stride = 1;      ///< bytes an element
  std::vector<std::byte> bytes;  ///< a multiple of `stride`
};

/// Everything that a file's required sections say, in the order in which it will be stored.
/// What must hold is what Level::geometry proves of a file (spec/format.md, "What must hold").
struct Mesh {
  std::array<double, 3> origin{};         ///< model = origin + local
  std::vector<Vec3f> vertices;            ///< local coordinates, on a common power-of-two grid
  std::vector<FullTet> tets;              ///< at least one
  std::vector<Side> sides;                ///< twins 2k (front) and 2k + 1 (back); one of them may have no tet
  std::vector<Triangle> triangles;        ///< the surface: in input order, or as ORIG says
  std::vector<Index> sources = {0};       ///< tets to start from; together they reach every tet
  std::string metadata;                   ///< UTF-8 JSON or empty; stored as it is
  std::vector<OptionalSection> optional;  ///< in the order in which they are stored, after the others
};

/// The largest e such that every coordinate is an integer multiple of 2^e (0 when all are zero).
/// Coordinates must be finite. O(n).
int grid_exponent(const std::vector<Vec3f>& vertices);

}  // namespace tetfmt
