// SPDX-License-Identifier: MIT
// The bytes of a tet file, as structures that are read in place. spec/format.md is the authority;
// this header follows it field by field, and the static_asserts pin every size.
#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>

#include "tetfmt/types.hpp"

namespace tetfmt {

static_assert(std::endian::native == std::endian::little, "tet files are little-endian and mapped in place");

/// How a cell is stored. The value is the cell's size in bytes, as written in the header.
enum class Layout : std::uint32_t {
  tet20 = 20,  ///< xor of the vertex ids, four neighbours
  tet16 = 16,  ///< xor of the vertex ids, three xor-ed neighbours
};

/// High bit first, then CR LF, Ctrl-Z, LF: a transfer in text mode breaks it visibly.
inline constexpr std::array<std::uint8_t, 8> kMagic = {0x89, 'T', 'E', 'T', 0x0D, 0x0A, 0x1A, 0x0A};
inline constexpr std::uint16_t kMajor = 1;
inline constexpr std::uint16_t kMinor = 0;
inline constexpr std::size_t kSectionAlignment = 64;
/// Header and table of contents fit in this many bytes, so that one ranged read opens a file.
inline constexpr std::size_t kOpeningBytes = 16384;
/// An outside ray enters through a linear search of the hull list; the bound keeps that search short
/// and the validator's convexity check affordable.
inline constexpr Index kMaxHullFaces = 4096;
/// Vertex coordinates are k * 2^grid_exponent with |k| at most this: exact in float32.
inline constexpr std::int64_t kMaxGridCoordinate = std::int64_t{1} << 24;

/// No count of a file exceeds this: the largest side index would read as kHull.
inline constexpr std::uint64_t kMaxCount = 0x7FFFFFFE;

/// Header flag: tetrahedra that rays of the scene cannot enter were left out. Some sides then have no
/// tetrahedron (Side::tet is kNone), and there may be no hull.
inline constexpr std::uint32_t kPartial = 1;

struct FileHeader {
  std::array<std::uint8_t, 8> magic = kMagic;
  std::uint16_t major = kMajor;
  std::uint16_t minor = kMinor;
  std::uint32_t header_bytes = 128;
  std::uint64_t file_bytes = 0;
  std::uint64_t toc_offset = 128;
  std::uint32_t toc_count = 0;
  std::uint32_t tet_stride = 0;  ///< 20 or 16, see Layout
  std::uint32_t vertex_count = 0;
  std::uint32_t tet_count = 0;
  std::uint32_t side_count = 0;             ///< even: two sides a constrained face
  std::uint32_t triangle_count = 0;         ///< triangles of the input surface, kept or not
  std::uint32_t hull_count = 0;             ///< hull faces, at most kMaxHullFaces
  std::uint32_t source_count = 0;           ///< source tets, at least 1
  std::array<double, 3> origin{};           ///< model = origin + local
  std::int32_t grid_exponent = 0;           ///< local coordinates are integers times 2^grid_exponent
  std::uint32_t flags = 0;                  ///< kPartial or 0
  std::array<std::uint64_t, 2> reserved{};  ///< zero in 1.0
  std::uint64_t toc_hash = 0;               ///< XXH3-64 of the table of contents
  std::uint64_t header_hash = 0;            ///< XXH3-64 of bytes 0 to 119
};
static_assert(sizeof(FileHeader) == 128 && offsetof(FileHeader, header_hash) == 120);

/// Four characters, first in the lowest byte, so that a hex dump reads "VERT".
enum class SectionKind : std::uint32_t {};
constexpr SectionKind section_kind(const char (&text)[5]) {
  std::uint32_t value = 0;
  for (int i = 3; i >= 0; --i) value = value << 8 | static_cast<std::uint8_t>(text[i]);
  return SectionKind{value};
}
inline constexpr SectionKind kVertices = section_kind("VERT");
inline constexpr SectionKind kTets = section_kind("TETS");
inline constexpr SectionKind kSources = section_kind("SRCE");
inline constexpr SectionKind kSides = section_kind("SIDE");
inline constexpr SectionKind kTriangles = section_kind("TRIA");
inline constexpr SectionKind kHullFaces = section_kind("HULL");
// Optional sections: a reader that knows none of them still finds every hit.
inline constexpr SectionKind kMetadata = section_kind("META");       ///< UTF-8 JSON
inline constexpr SectionKind kRegions = section_kind("REGN");        ///< Region
inline constexpr SectionKind kSurfaceBounds = section_kind("BNDS");  ///< SurfaceBounds, one
inline constexpr SectionKind kOrigins = section_kind("ORIG");  ///< Index: input triangle, of each triangle
inline constexpr SectionKind kInputTriangles =
    section_kind("SURF");                                        ///< Triangle: the input's, with ORIG only
inline constexpr SectionKind kTexts = section_kind("TEXT");      ///< zero-terminated UTF-8 strings
inline constexpr SectionKind kMaterials = section_kind("MATL");  ///< Material
inline constexpr SectionKind kObjects = section_kind("OBJT");    ///< Object
inline constexpr SectionKind kTriangleObjects =
    section_kind("TOBJ");  ///< Index: object, of each input triangle
inline constexpr SectionKind kCorners =
    section_kind("CORN");  ///< 3 Index: surface points, of each input triangle
inline constexpr SectionKind kNormals = section_kind("NORM");         ///< 3 floats, of each surface point
inline constexpr SectionKind kTexcoords = section_kind("TEXC");       ///< 2 floats
inline constexpr SectionKind kColors = section_kind("COLR");          ///< 4 floats: red, green, blue, alpha
inline constexpr SectionKind kProperties = section_kind("PROP");      ///< Property
inline constexpr SectionKind kPropertyValues = section_kind("PVAL");  ///< doubles, property after property
inline constexpr SectionKind kDracoSurface = section_kind("DRAC");    ///< instead of CORN to PVAL

inline constexpr std::uint16_t kSectionVersion = 1;
inline constexpr std::uint16_t kRequired = 1;    ///< flag: a reader that does not know this kind must refuse
inline constexpr std::uint16_t kSafeToCopy = 2;  ///< flag: still true after other sections were rewritten

struct SectionEntry {
  SectionKind kind{};
  std::uint16_t version = kSectionVersion;
  std::uint16_t flags = 0;
  std::uint32_t codec = 0;   ///< 0: raw, the only one of 1.0
  std::uint32_t stride = 0;  ///< bytes an element
  std::uint64_t offset = 0;
  std::uint64_t stored_bytes = 0;
  std::uint64_t raw_bytes = 0;  ///< count * stride
  std::uint64_t count = 0;
  std::uint64_t hash = 0;  ///< XXH3-64 of the stored bytes
  std::uint64_t reserved = 0;
};
static_assert(sizeof(SectionEntry) == 64);

/// neighbors[k] faces the k-th SMALLEST vertex id: renumbering vertices without re-sorting the slots
/// corrupts the mesh even when every xor is recomputed.
struct Tet20 {
  Index vertex_xor = 0;
  std::array<Ref, 4> neighbors{};
};
static_assert(sizeof(Tet20) == 20);

/// neighbor_xor[k] = N[k] ^ N[3], of whole references, side bits included.
struct Tet16 {
  Index vertex_xor = 0;
  std::array<Ref, 3> neighbor_xor{};
};
static_assert(sizeof(Tet16) == 16);

/// A tetrahedron in full, from which all others are recovered by walking.
struct SourceTet {
  Index tet = 0;
  std::array<Index, 4> vertices{};
  std::array<Ref, 4> neighbors{};
  std::uint32_t reserved = 0;
};
static_assert(sizeof(SourceTet) == 40);

/// One side of a constrained face. Side 2k is in front (its tet lies where the triangle's normal points),
/// side 2k + 1 behind; both name the same triangle and material.
struct Side {
  Index tet = 0;  ///< kNone: the space there was left out (kPartial); its twin has a tetrahedron
  Index triangle = 0;
  Index material = 0;
};
static_assert(sizeof(Side) == 12);

/// A triangle of the input surface by its three corners, in the input's order; the normal is
/// (b - a) x (c - a). All three kNone: the triangle has no faces of its own in this file, because it was
/// degenerate or repeated an earlier triangle.
struct Triangle {
  std::array<Index, 3> vertices{kNone, kNone, kNone};
  bool dropped() const { return vertices[0] == kNone; }
};
static_assert(sizeof(Triangle) == 12);

/// A face of the convex hull and the tetrahedron inside of it; vertices ascend. The list ascends
/// lexicographically.
struct HullFace {
  Index tet = 0;
  std::array<Index, 3> vertices{};
  friend auto operator<=>(const HullFace&, const HullFace&) = default;
};
static_assert(sizeof(HullFace) == 16);

/// A space that surfaces close off from the others: a run of tetrahedra, connected through free faces.
struct Region {
  Index first_tet = 0, tet_count = 0;
  Index id =
      0;  ///< ascending, at most kMaxCount; 0 is the space around everything, the one that the hull bounds
  std::uint32_t reserved = 0;
  double volume = 0;   ///< in cubic model units: the double nearest to the sum of the tetrahedra
  Vec3f lower, upper;  ///< bounds of its vertices, local coordinates
};
static_assert(sizeof(Region) == 48);

/// The box around all triangles: a ray that misses it meets nothing.
struct SurfaceBounds {
  Vec3f lower, upper;  ///< local coordinates
};
static_assert(sizeof(SurfaceBounds) == 24);

/// Offset of a zero-terminated string in TEXT; kNone: no text.
using TextRef = std::uint32_t;

/// What a surface is made of, as far as the input says. Colours and factors as the input gives them, 0 to 1
/// unless emission.
struct Material {
  std::array<float, 4> base_color = {0.8f, 0.8f, 0.8f, 1};  ///< red, green, blue, opacity
  std::array<float, 3> emission{};
  float metallic = 0, roughness = 1;
  float ior = 1.5f;        ///< index of refraction
  float transmission = 0;  ///< share of light that passes through
  TextRef name = kNone;
  TextRef base_color_texture = kNone;  ///< path or URI as the input gives it
  std::array<std::uint32_t, 3> reserved{};
};
static_assert(sizeof(Material) == 64);

/// A named part of the input: an OBJ object or group, a glTF node, or a whole file.
struct Object {
  TextRef name = kNone;    ///< as the input gives it
  TextRef source = kNone;  ///< the input file's name, without folders
};
static_assert(sizeof(Object) == 8);

/// A further value of each surface point, such as a PLY vertex property.
struct Property {
  TextRef name = kNone;
  std::uint32_t type = 0;  ///< of the input: PropertyType
};
static_assert(sizeof(Property) == 8);
enum class PropertyType : std::uint32_t { int8, uint8, int16, uint16, int32, uint32, float32, float64 };

}  // namespace tetfmt
