// SPDX-License-Identifier: AGPL-3.0-or-later
// What the readers of single formats share. read_soup() itself is declared in prep.hpp.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "prep/prep.hpp"

namespace tetprep {

/// What a mesh file says before polygons are triangulated. Nothing is checked yet.
struct PolygonSoup {
  std::vector<Point> points;
  std::vector<std::uint64_t> corners;    ///< of all polygons, one after the other; may be out of range
  std::vector<std::size_t> ends;         ///< of each polygon in `corners`
  std::vector<std::size_t> lines;        ///< where each polygon stands in the file, from 1; may be empty
  std::vector<std::size_t> point_lines;  ///< the same for points
};

/// A file in memory. `text` is `path`'s whole contents, less a byte order mark at the start.
struct SourceFile {
  const std::string& path;
  std::string_view text;
  bool marked = false;  ///< there was a byte order mark

  /// Throws Failure (invalid) "path:line: message" (without the line if it is 0).
  [[noreturn]] void fail(std::size_t line, const std::string& message) const;
};

/// A word of the file, for a message.
std::string quoted(std::string_view word);

PolygonSoup read_obj(const SourceFile& file);
PolygonSoup read_off(const SourceFile& file);
PolygonSoup read_ply(const SourceFile& file);
PolygonSoup read_stl(const SourceFile& file);
PolygonSoup read_drc(const SourceFile& file);

/// Checks indices and coordinates, and cuts polygons into triangles: without new points, in the polygon's own
/// orientation, and so that a planar polygon's triangles do not overlap.
TriangleSoup triangulate(const SourceFile& file, const PolygonSoup& polygons);

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
