// SPDX-License-Identifier: AGPL-3.0-or-later
// STL, ascii and binary. Facet normals follow from the corners and are not kept; nor are the two attribute
// bytes of binary facets, which programs use in ways that contradict each other.
//
// Not by CGAL: its reader sorts all corners to find equal ones (six times slower), answers "no" without
// saying why, and reads over what it does not understand.
#include <algorithm>
#include <cctype>
#include <cstring>

#include "prep/interner.hpp"
#include "prep/read_soup.hpp"
#include "prep/text_lines.hpp"

namespace tetprep {
namespace {

constexpr std::size_t kHeader = 84, kFacet = 50;

/// Equal corners become one point: STL names each corner's coordinates in full.
class Corners {
 public:
  void add(const Point& point) {
    soup.corners.push_back(numbers_.add(reinterpret_cast<const char*>(point.data())));
    if (numbers_.size() > soup.points.size()) soup.points.push_back(point);
  }
  PolygonSoup soup;

 private:
  Interner numbers_{sizeof(Point)};
};

std::uint32_t promised(const SourceFile& file) {
  std::uint32_t count = 0;
  std::memcpy(&count, file.text.data() + kHeader - sizeof count, sizeof count);
  return count;
}

/// Many binary files start with "solid" too, so the size decides.
bool is_binary(const SourceFile& file) {
  if (file.text.size() < kHeader) return false;
  return !file.text.starts_with("solid") ||
         file.text.size() == kHeader + kFacet * std::uint64_t{promised(file)};
}

PolygonSoup read_binary(const SourceFile& file) {
  const std::uint32_t count = promised(file);
  const std::size_t room = (file.text.size() - kHeader) / kFacet;
  if (count > room)
    file.fail(0, "promises " + std::to_string(count) + " triangles, but holds only " + std::to_string(room) +
                     ": cut short, or no STL file");
  Corners corners;
  corners.soup.corners.reserve(3 * std::size_t{count});
  corners.soup.ends.reserve(count);
  for (std::size_t i = 0; i < count; ++i) {
    std::array<float, 12> values{};  // the facet's normal, then its corners
    std::memcpy(values.data(), file.text.data() + kHeader + i * kFacet, sizeof values);
    for (std::size_t k = 3; k < 12; k += 3)
      corners.add({static_cast<double>(values[k]), static_cast<double>(values[k + 1]),
                   static_cast<double>(values[k + 2])});
    corners.soup.ends.push_back(corners.soup.corners.size());
  }
  return std::move(corners.soup);
}

std::string lower(std::string_view word) {
  std::string result(word);
  std::transform(result.begin(), result.end(), result.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return result;
}

/// Each "solid" is an object.
PolygonSoup read_ascii(const SourceFile& file) {
  const auto cut_short = [&] { file.fail(0, "has no \"endsolid\": cut short, or no STL file"); };
  if (file.text.find("endsolid") == std::string_view::npos &&
      file.text.find("ENDSOLID") == std::string_view::npos)
    cut_short();
  Corners corners;
  PolygonSoup& soup = corners.soup;
  PlainLines lines(file.text, false);
  std::string_view line;
  bool ended = false;
  while (lines.next(line)) {
    for (std::string_view word; !(word = next_word(line)).empty();) {
      const std::string keyword = word.size() < 10 ? lower(word) : std::string();
      if (keyword == "vertex") {
        Point point{};
        for (double& x : point) {
          const std::string_view number = next_word(line);
          const auto value = parse_double(number);
          if (!value) file.fail(lines.number(), quote(number) + " is not a coordinate");
          x = *value;
        }
        corners.add(point);
      } else if (keyword == "endloop") {
        const std::size_t begin = soup.ends.empty() ? 0 : soup.ends.back();
        if (soup.corners.size() - begin != 3)
          file.fail(lines.number(),
                    "a facet with " + std::to_string(soup.corners.size() - begin) + " corners, not 3");
        if (soup.objects.empty()) soup.objects.emplace_back();
        soup.ends.push_back(soup.corners.size());
        soup.lines.push_back(lines.number());
        soup.face_objects.push_back(static_cast<Index>(soup.objects.size() - 1));
      } else if (keyword == "solid") {
        soup.objects.emplace_back(trim(line));
        line = {};
        ended = false;
      } else if (keyword == "endsolid") {
        line = {};
        ended = true;
      } else if (keyword == "normal") {
        for (int i = 0; i < 3; ++i) next_word(line);  // whatever it says
      } else if (keyword == "color") {
        line = {};
      } else if (keyword != "facet" && keyword != "outer" && keyword != "loop" && keyword != "endfacet") {
        file.fail(lines.number(), quote(word) + " has no meaning in an STL file");
      }
    }
  }
  if (!ended) cut_short();
  return std::move(soup);
}

}  // namespace

PolygonSoup read_stl(const SourceFile& file) {
  return is_binary(file) ? read_binary(file) : read_ascii(file);
}

}  // namespace tetprep
