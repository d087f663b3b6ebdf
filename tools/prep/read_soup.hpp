// SPDX-License-Identifier: AGPL-3.0-or-later
// What the readers of single formats share. read_soup() itself is declared in prep.hpp.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "prep/prep.hpp"

namespace tetprep {

/// One kind of value (normals, say), and which of them each corner has.
template <class T>
struct Channel {
  std::vector<T> rows;  ///< empty: the file has none of this kind. NaN throughout: a row says nothing
  std::vector<Index>
      of_corner;  ///< row of each corner, kNone: none. Empty: a corner's row is its point's number
};

struct PropertyChannel {
  std::string name;
  tetfmt::PropertyType type = tetfmt::PropertyType::float32;
  Channel<double> values;
};

/// What a mesh file says before polygons are triangulated. Corners may name points that do not exist; all
/// other numbers in it are in range, and rows that go by points are as many as the points.
struct PolygonSoup {
  std::vector<Point> points;
  std::vector<std::uint64_t> corners;    ///< of all polygons, one after the other; may be out of range
  std::vector<std::size_t> ends;         ///< of each polygon in `corners`
  std::vector<std::size_t> lines;        ///< where each polygon stands in the file, from 1; may be empty
  std::vector<std::size_t> point_lines;  ///< the same for points

  Channel<std::array<float, 3>> normals;
  Channel<std::array<float, 2>> texcoords;
  Channel<std::array<float, 4>> colors;
  std::vector<PropertyChannel> properties;

  std::vector<Material> materials;
  std::vector<Index> face_materials;  ///< of each polygon, kNone: it has none; empty: all the first
  std::vector<std::string> objects;   ///< their names; empty: there is one, without a name
  std::vector<Index> face_objects;    ///< of each polygon; empty: all the first
  std::vector<std::string> warnings;
};

/// A file in memory. `text` is `path`'s whole contents, less a byte order mark at the start.
struct SourceFile {
  const std::string& path;
  std::string_view text;

  /// Throws Failure (invalid) "path:line: message" (without the line if it is 0).
  [[noreturn]] void fail(std::size_t line, const std::string& message) const;
  /// The same for contents that may be sound, but cannot be used.
  [[noreturn]] void unsupported(std::size_t line, const std::string& message) const;
};

/// What is read over in one file. Only the first few are kept: a damaged file may have one on every line.
class Warnings {
 public:
  explicit Warnings(std::string path) : path_(std::move(path)) {}
  void add(std::size_t line, const std::string& message);  ///< line 0: the file as a whole
  /// Appends "path:line: message", and a line on those that were not kept.
  void append_to(std::vector<std::string>& list) const;

 private:
  std::string path_;
  std::vector<std::string> kept_;
  std::size_t count_ = 0;
};

/// Where a file that `path` names is to be looked for: in `path`'s folder or below. Empty if `name` leads out
/// of it. Backslashes count as slashes.
std::string path_beside(const std::string& path, std::string_view name);

/// Warns if a texture is not there. Textures are named, not read.
void look_for_texture(const std::string& path, std::string_view name, std::size_t line, Warnings& warnings);

/// A word of the file, for a message.
std::string quote(std::string_view word);

/// "face 7 (counted from 0)"
std::string counted(std::string_view what, std::uint64_t number);

/// read_soup() of a file that is in memory already; files that it refers to are looked for beside `path`.
TriangleSoup parse_soup(const std::string& path, std::string_view contents);

PolygonSoup read_obj(const SourceFile& file);
PolygonSoup read_off(const SourceFile& file);
PolygonSoup read_ply(const SourceFile& file);
PolygonSoup read_stl(const SourceFile& file);
PolygonSoup read_drc(const SourceFile& file);
PolygonSoup read_gltf(const SourceFile& file);  ///< .gltf and .glb

/// Checks indices and coordinates, and cuts polygons into triangles: without new points, in the polygon's own
/// orientation, and so that a planar polygon's triangles do not overlap. Each combination of a corner's
/// values becomes one surface point, numbered as they are met. Takes time in proportion to the corners.
TriangleSoup triangulate(const SourceFile& file, PolygonSoup polygons);

/// Lets the process grow by at most `bytes` more while it lives: packaged readers believe the counts that a
/// file claims, and a lie must end in bad_alloc, not in a machine without memory.
class MemoryCeiling {
 public:
  explicit MemoryCeiling(std::uint64_t bytes);
  ~MemoryCeiling();
  MemoryCeiling(const MemoryCeiling&) = delete;
  MemoryCeiling& operator=(const MemoryCeiling&) = delete;

 private:
  std::uint64_t old_limit_;
};

}  // namespace tetprep
