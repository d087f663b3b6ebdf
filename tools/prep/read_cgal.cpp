// SPDX-License-Identifier: AGPL-3.0-or-later
// OFF, PLY and STL by CGAL's polygon-soup readers. They answer "no" without saying why, and believe what a
// header claims, so each is accompanied by a look at the file that tells the user what is wrong.
#include <CGAL/IO/OFF.h>
#include <CGAL/IO/PLY.h>
#include <CGAL/IO/STL.h>
#include <CGAL/Simple_cartesian.h>

#include <array>
#include <charconv>
#include <cmath>
#include <cstring>
#include <fstream>
#include <memory>
#include <new>
#include <optional>
#include <sstream>

#include "common/parse.hpp"
#include "prep/read_soup.hpp"

namespace tetprep {
namespace {

using CgalPoint = CGAL::Simple_cartesian<double>::Point_3;

struct CgalSoup {
  std::vector<CgalPoint> points;
  std::vector<std::vector<std::size_t>> polygons;
};

PolygonSoup convert(const CgalSoup& in) {
  PolygonSoup out;
  out.points.reserve(in.points.size());
  for (const CgalPoint& p : in.points) out.points.push_back({p.x(), p.y(), p.z()});
  out.ends.reserve(in.polygons.size());
  for (const auto& polygon : in.polygons) {
    out.corners.insert(out.corners.end(), polygon.begin(), polygon.end());
    out.ends.push_back(out.corners.size());
  }
  return out;
}

/// Generous for what a file of this many bytes can hold: a face of 8 bytes costs about 60 in a CgalSoup.
std::uint64_t ceiling_for(const SourceFile& file) {
  return (std::uint64_t{256} << 20) + 64 * file.text.size();
}

/// What CGAL reads from: the file, or a copy of its text where a byte order mark must go.
std::unique_ptr<std::istream> open_stream(const SourceFile& file) {
  if (file.marked) return std::make_unique<std::istringstream>(std::string(file.text));
  return std::make_unique<std::ifstream>(file.path, std::ios::binary);
}

/// Non-blank lines without comments, numbered from 1.
class Lines {
 public:
  explicit Lines(std::string_view text) : rest_(text) {}
  bool next(std::vector<std::string_view>& words) {
    words.clear();
    while (words.empty() && !rest_.empty()) {
      const auto end = rest_.find('\n');
      std::string_view line = rest_.substr(0, end);
      rest_.remove_prefix(end == std::string_view::npos ? rest_.size() : end + 1);
      ++number_;
      line = line.substr(0, line.find('#'));
      while (!(line = trim(line)).empty()) {
        const std::string_view word = line.substr(0, line.find_first_of(" \t\r"));
        words.push_back(word);
        line.remove_prefix(word.size());
      }
    }
    return !words.empty();
  }
  std::size_t number() const { return number_; }
  std::size_t bytes_left() const { return rest_.size(); }

 private:
  std::string_view rest_;
  std::size_t number_ = 0;
};

template <class T>
std::optional<T> integer(std::string_view word) {
  T value{};
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (error != std::errc{} || end != word.data() + word.size()) return std::nullopt;
  return value;
}

/// Throws the first thing that is wrong with an OFF file that CGAL refused.
[[noreturn]] void explain_off(const SourceFile& file) {
  Lines lines(file.text);
  std::vector<std::string_view> words;
  if (!lines.next(words)) file.fail(0, "no mesh in it");
  if (words.size() == 1 && !integer<std::uint64_t>(words[0])) {
    if (words[0].find("OFF") == std::string_view::npos)
      file.fail(lines.number(), "does not start as an OFF file");
    if (!lines.next(words)) file.fail(lines.number(), "ends after its first line");
  } else if (!words.empty() && words[0].find("OFF") != std::string_view::npos) {
    words.erase(words.begin());
  }
  const auto points = words.size() > 1 ? integer<std::uint64_t>(words[0]) : std::nullopt;
  const auto faces = words.size() > 1 ? integer<std::uint64_t>(words[1]) : std::nullopt;
  if (!points || !faces) file.fail(lines.number(), "expected the numbers of points and faces");
  const auto cut_short = [&] {
    file.fail(lines.number(), "ends before all of its " + std::to_string(*points) + " points and " +
                                  std::to_string(*faces) + " faces have come: cut short, or damaged");
  };
  for (std::uint64_t i = 0; i < *points; ++i) {
    if (!lines.next(words)) cut_short();
    if (words.size() < 3) file.fail(lines.number(), "a point needs three coordinates, one point a line");
    for (std::size_t k = 0; k < 3; ++k) {
      const auto value = parse_double(words[k]);
      if (!value || !std::isfinite(*value))
        file.fail(lines.number(), quoted(words[k]) + " is not a finite coordinate");
    }
  }
  for (std::uint64_t i = 0; i < *faces; ++i) {
    if (!lines.next(words)) cut_short();
    const auto corners = integer<std::uint64_t>(words[0]);
    if (!corners || words.size() - 1 < *corners)
      file.fail(lines.number(),
                "expected the number of corners of a face, then its corners, one face a line");
    for (std::uint64_t k = 1; k <= *corners; ++k) {
      const auto corner = integer<std::int64_t>(words[k]);
      if (!corner) file.fail(lines.number(), quoted(words[k]) + " is not a point's number");
      if (*corner < 0 || static_cast<std::uint64_t>(*corner) >= *points)
        file.fail(lines.number(),
                  "face " + std::to_string(i) + " refers to point " + std::to_string(*corner) +
                      " (both counted from 0), but there are only " + std::to_string(*points));
    }
  }
  file.fail(0, "not an OFF file that CGAL can read");
}

struct PlyCounts {
  std::uint64_t vertices = 0, faces = 0;
};

/// Compares what the header promises with the file's size. Throws if they cannot both be true.
PlyCounts check_ply_header(const SourceFile& file) {
  if (!file.text.starts_with("ply")) file.fail(1, "does not start as a PLY file");
  Lines lines(file.text);
  std::vector<std::string_view> words;
  PlyCounts counts;
  bool binary = false, ended = false;
  std::uint64_t elements = 0;
  double bytes = 0;  // double: the counts are the file's, and their product may be anything
  while (!ended && lines.next(words)) {
    if (words[0] == "format" && words.size() > 1) binary = words[1] != "ascii";
    if (words[0] == "element") {
      const auto count = words.size() > 2 ? integer<std::uint64_t>(words[2]) : std::nullopt;
      if (!count) file.fail(lines.number(), "expected a name and a number after \"element\"");
      elements = *count;
      if (words[1] == "vertex" || words[1] == "vertices") counts.vertices = elements;
      if (words[1] == "face" || words[1] == "faces") counts.faces = elements;
    } else if (words[0] == "property" && words.size() > 1) {
      // The least that a value can take: a digit and a blank, or the binary type's size (a list's count).
      const std::string_view type = words[1] == "list" && words.size() > 2 ? words[2] : words[1];
      const bool two = type == "short" || type == "ushort" || type == "int16" || type == "uint16";
      const bool one = type == "char" || type == "uchar" || type == "int8" || type == "uint8";
      const bool eight = type == "double" || type == "float64";
      bytes += static_cast<double>(elements) * (!binary ? 2 : one ? 1 : two ? 2 : eight ? 8 : 4);
    }
    ended = words[0] == "end_header";
  }
  if (!ended) file.fail(lines.number(), "the header does not end: cut short, or no PLY file");
  if (bytes > static_cast<double>(lines.bytes_left()) + 1)  // the last value needs no blank after it
    file.fail(lines.number(), "the header promises " + std::to_string(counts.vertices) + " vertices and " +
                                  std::to_string(counts.faces) + " faces, but only " +
                                  std::to_string(lines.bytes_left()) +
                                  " bytes follow: cut short, or damaged");
  return counts;
}

constexpr std::size_t kStlHeader = 84, kStlTriangle = 50;

/// Whether an STL file is a binary one. Many of those start with "solid" too, so the size decides.
bool is_binary_stl(const SourceFile& file) {
  if (file.text.size() < kStlHeader) return false;
  std::uint32_t count = 0;
  std::memcpy(&count, file.text.data() + kStlHeader - sizeof count, sizeof count);
  return !file.text.starts_with("solid") ||
         file.text.size() == kStlHeader + kStlTriangle * std::uint64_t{count};
}

/// Throws the first vertex of an ascii PLY file with a coordinate that is none. Returns if it finds nothing
/// to blame, or if the file is not laid out in the usual way: vertices first, each on a line of its own.
void explain_ascii_ply(const SourceFile& file) {
  Lines lines(file.text);
  std::vector<std::string_view> words;
  std::uint64_t vertices = 0;
  std::size_t elements = 0, properties = 0;
  std::array<std::optional<std::size_t>, 3> place;  // of x, y and z among a vertex's values
  while (lines.next(words) && words[0] != "end_header") {
    if (words[0] == "format" && words.size() > 1 && words[1] != "ascii") return;
    if (words[0] == "element" && words.size() > 2 && ++elements == 1) {
      if (words[1] != "vertex" && words[1] != "vertices") return;
      vertices = integer<std::uint64_t>(words[2]).value_or(0);
    } else if (words[0] == "property" && words.size() > 2 && elements == 1) {
      if (words[1] == "list") return;
      if (words[2].size() == 1 && words[2][0] >= 'x' && words[2][0] <= 'z')
        place[static_cast<std::size_t>(words[2][0] - 'x')] = properties;
      ++properties;
    }
  }
  for (std::uint64_t i = 0; i < vertices && lines.next(words); ++i) {
    if (words.size() != properties) return;
    for (const auto& position : place) {
      if (!position) return;
      const auto value = parse_double(words[*position]);
      if (!value || !std::isfinite(*value))
        file.fail(lines.number(), "vertex " + std::to_string(i) + " (counted from 0): " +
                                      quoted(words[*position]) + " is not a finite coordinate");
    }
  }
}

}  // namespace

PolygonSoup read_off(const SourceFile& file) {
  CgalSoup soup;
  bool read = false;
  try {
    const MemoryCeiling ceiling(ceiling_for(file));
    const auto opened = open_stream(file);
    std::istream& stream = *opened;
    read = CGAL::IO::read_OFF(stream, soup.points, soup.polygons, CGAL::parameters::verbose(false));
  } catch (const std::exception&) {
  }
  if (!read) explain_off(file);
  return convert(soup);
}

PolygonSoup read_ply(const SourceFile& file) {
  const PlyCounts promised = check_ply_header(file);
  CgalSoup soup;
  bool read = false;
  {
    const MemoryCeiling ceiling(ceiling_for(file));
    const auto opened = open_stream(file);
    std::istream& stream = *opened;
    read = CGAL::IO::read_PLY(stream, soup.points, soup.polygons, CGAL::parameters::verbose(false));
  }
  // The reader's "yes" is not to be relied on: it does not look at how its faces went.
  if (!read || soup.points.size() != promised.vertices || soup.polygons.size() != promised.faces) {
    explain_ascii_ply(file);
    file.fail(0, "could be read only up to vertex " + std::to_string(soup.points.size()) + " of " +
                     std::to_string(promised.vertices) + " and face " + std::to_string(soup.polygons.size()) +
                     " of " + std::to_string(promised.faces) + ": cut short, damaged, or no triangle mesh");
  }
  return convert(soup);
}

PolygonSoup read_stl(const SourceFile& file) {
  CgalSoup soup;
  const bool binary = is_binary_stl(file);
  if (binary) {
    std::uint32_t count = 0;
    std::memcpy(&count, file.text.data() + kStlHeader - sizeof count, sizeof count);
    const std::size_t room = (file.text.size() - kStlHeader) / kStlTriangle;
    if (count > room)
      file.fail(0, "promises " + std::to_string(count) + " triangles, but holds only " +
                       std::to_string(room) + ": cut short, or no STL file");
  } else if (file.text.find("endsolid") == std::string_view::npos) {
    file.fail(0, "has no \"endsolid\": cut short, or no STL file");
  }
  bool read = false;
  {
    const MemoryCeiling ceiling(ceiling_for(file));
    const auto opened = open_stream(file);
    std::istream& stream = *opened;
    read = CGAL::IO::read_STL(stream, soup.points, soup.polygons, CGAL::parameters::verbose(false));
  }
  if (!read) file.fail(0, "not an STL file that CGAL can read");
  return convert(soup);
}

}  // namespace tetprep
