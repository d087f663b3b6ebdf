// SPDX-License-Identifier: AGPL-3.0-or-later
// Wavefront OBJ: polygons with normals, texture coordinates, vertex colours, objects, groups and materials.
// Lines, points and smoothing groups are skipped; free-form surfaces too, with a warning.
//
// Not by tinyobjloader: its own number parser misses the nearest double for two of three 17-digit numbers,
// which would move coordinates that lie on a grid; it reads "nan", "x" and a missing coordinate as 0 without
// a word, takes 4294967297 for 1, and reports no line for an index that is out of range.
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>
#include <map>
#include <optional>
#include <set>

#include "prep/read_mtl.hpp"
#include "prep/read_soup.hpp"
#include "prep/text_lines.hpp"
#include "tetfmt/mapped_file.hpp"

namespace tetprep {
namespace {

constexpr float kNoValue = std::numeric_limits<float>::quiet_NaN();

class ObjReader {
 public:
  explicit ObjReader(const SourceFile& file) : file_(file), lines_(file.text), warnings_(file.path) {}

  PolygonSoup read() {
    std::string_view line;
    while (lines_.next(line)) {
      line = line.substr(0, line.find('#'));
      const std::string_view keyword = next_word(line);
      if (keyword == "v") {
        vertex(line);
      } else if (keyword == "vt") {
        texcoord(line);
      } else if (keyword == "vn") {
        normal(line);
      } else if (keyword == "f" || keyword == "fo") {
        face(line);
      } else if (keyword == "usemtl") {
        material_name_ = trim(line);
        material_line_ = lines_.number();
        material_.reset();
      } else if (keyword == "mtllib") {
        library(trim(line));
      } else if (keyword == "o") {
        object_name_ = trim(line);
        object_.reset();
      } else if (keyword == "g") {
        group_name_.clear();
        for (std::string_view word; !(word = next_word(line)).empty();)
          group_name_ += (group_name_.empty() ? "" : " ") + std::string(word);
        object_.reset();
      } else if (!free_form_ && (keyword == "curv" || keyword == "curv2" || keyword == "surf")) {
        free_form_ = true;
        warnings_.add(lines_.number(), "free-form curves and surfaces are skipped: only polygons are read");
      }
    }
    check_rows(texcoord_corners_, soup_.texcoords, "texture coordinate");
    check_rows(normal_corners_, soup_.normals, "normal");
    finish_colors();
    look_up_materials();
    warnings_.append_to(soup_.warnings);
    for (const Warnings& warnings : library_warnings_) warnings.append_to(soup_.warnings);
    return std::move(soup_);
  }

 private:
  [[noreturn]] void fail(const std::string& message) const { file_.fail(lines_.number(), message); }

  double number_in(std::string_view word, std::string_view what) const {
    const auto value = parse_double(word);
    if (!value) fail(quote(word) + " is not a " + std::string(what));
    return *value;
  }

  void vertex(std::string_view line) {
    Point point{};
    for (double& coordinate : point) {
      const std::string_view word = next_word(line);
      if (word.empty()) fail("a vertex needs three coordinates");
      coordinate = number_in(word, "coordinate");
    }
    soup_.points.push_back(point);
    soup_.point_lines.push_back(lines_.number());

    // One further number is a weight; three or four are a colour, as MeshLab and others write it.
    std::array<float, 4> color{kNoValue, kNoValue, kNoValue, 1};
    std::size_t count = 0;
    for (std::string_view word; !(word = next_word(line)).empty(); ++count) {
      const auto value = parse_double(word);
      if (!value || !std::isfinite(*value) || count == 4) {
        warnings_.add(lines_.number(), quote(word) + " after a vertex's coordinates: skipped");
        count = 0;
        break;
      }
      color[count] = static_cast<float>(*value);
    }
    auto& colors = soup_.colors.rows;
    if (count < 3) {
      if (colors.empty()) return;
      color.fill(kNoValue);
    }
    colors.resize(soup_.points.size() - 1, {kNoValue, kNoValue, kNoValue, kNoValue});
    colors.push_back(color);
  }

  void texcoord(std::string_view line) {
    std::array<float, 2> row{};
    for (std::size_t i = 0; i < 2; ++i) {
      const std::string_view word = next_word(line);
      if (word.empty() && i == 0) fail("\"vt\" needs a number");
      if (!word.empty()) row[i] = static_cast<float>(number_in(word, "texture coordinate"));
    }
    soup_.texcoords.rows.push_back(row);
  }

  void normal(std::string_view line) {
    std::array<float, 3> row{};
    for (float& x : row) {
      const std::string_view word = next_word(line);
      if (word.empty()) fail("a normal needs three numbers");
      x = static_cast<float>(number_in(word, "number"));
    }
    soup_.normals.rows.push_back(row);
  }

  /// The row, from 0, that `digits` in `word` names among `known` rows so far. A positive number may name a
  /// row further down: those are checked at the end.
  std::uint64_t index_in(std::string_view word, std::string_view digits, std::size_t known,
                         const char* what) const {
    const auto index = parse_integer<std::int64_t>(digits);
    if (!index) fail(quote(word) + " is not a face corner");
    if (*index == 0) fail(std::string(what) + " index 0: OBJ counts from 1");
    if (*index > 0) return static_cast<std::uint64_t>(*index) - 1;
    if (*index < -static_cast<std::int64_t>(known))
      fail(std::string(what) + " index " + std::to_string(*index) + ", but only " + std::to_string(known) +
           " precede this line");
    return known - static_cast<std::uint64_t>(-*index);
  }

  void face(std::string_view line) {
    for (std::string_view word; !(word = next_word(line)).empty();) {
      const auto first = word.find('/');
      soup_.corners.push_back(index_in(word, word.substr(0, first), soup_.points.size(), "vertex"));
      if (first == std::string_view::npos) continue;
      const std::string_view rest = word.substr(first + 1);
      const auto second = rest.find('/');
      attribute(word, rest.substr(0, second), texcoord_corners_, soup_.texcoords, "texture coordinate");
      if (second != std::string_view::npos)
        attribute(word, rest.substr(second + 1), normal_corners_, soup_.normals, "normal");
    }
    soup_.ends.push_back(soup_.corners.size());
    soup_.lines.push_back(lines_.number());
    if (!object_) object_ = object_number();
    soup_.face_objects.push_back(*object_);
    if (!material_) material_ = material_number();
    soup_.face_materials.push_back(*material_);
  }

  template <class T>
  void attribute(std::string_view word, std::string_view digits, std::vector<std::size_t>& lines,
                 Channel<T>& channel, const char* what) {
    if (digits.empty()) return;
    const std::uint64_t row = index_in(word, digits, channel.rows.size(), what);
    if (row >= kNone) fail(quote(word) + ": " + what + " index out of range");
    if (row >= channel.rows.size()) lines.push_back(soup_.corners.size() - 1);
    channel.of_corner.resize(soup_.corners.size(), kNone);
    channel.of_corner.back() = static_cast<Index>(row);
  }

  /// `ahead`: corners that named a row further down.
  template <class T>
  void check_rows(const std::vector<std::size_t>& ahead, Channel<T>& channel, const char* what) const {
    for (const std::size_t corner : ahead) {
      if (channel.of_corner[corner] < channel.rows.size()) continue;
      const auto face = static_cast<std::size_t>(
          std::upper_bound(soup_.ends.begin(), soup_.ends.end(), corner) - soup_.ends.begin());
      file_.fail(soup_.lines[face], std::string(what) + " index " +
                                        std::to_string(std::uint64_t{channel.of_corner[corner]} + 1) +
                                        ", but there are only " + std::to_string(channel.rows.size()));
    }
    // No corner names any: not "by points", but none at all.
    if (channel.of_corner.empty()) channel.rows.clear();
    if (!channel.rows.empty()) channel.of_corner.resize(soup_.corners.size(), kNone);
  }

  void finish_colors() {
    auto& colors = soup_.colors.rows;
    if (colors.empty()) return;
    colors.resize(soup_.points.size(), {kNoValue, kNoValue, kNoValue, kNoValue});
    float most = 0;
    for (const auto& color : colors)
      for (const float x : color) most = std::max(most, x);
    if (most <= 1) return;
    warnings_.add(0, "vertex colours reach " + number(static_cast<double>(most)) + ": taken as 0 to 255");
    for (auto& color : colors) {
      const bool no_alpha = color[3] == 1;
      for (float& x : color) x /= 255;
      if (no_alpha) color[3] = 1;
    }
  }

  Index object_number() {
    const auto [place, is_new] =
        objects_.try_emplace({object_name_, group_name_}, static_cast<Index>(soup_.objects.size()));
    if (is_new) {
      const bool both = !object_name_.empty() && !group_name_.empty();
      soup_.objects.push_back(object_name_ + (both ? "/" : "") + group_name_);
    }
    return place->second;
  }

  Index material_number() {
    if (material_name_.empty()) return kNone;
    const auto [place, is_new] =
        materials_.try_emplace(material_name_, static_cast<Index>(soup_.materials.size()));
    if (is_new) {
      soup_.materials.push_back({material_name_, {}, {}});
      material_lines_.push_back(material_line_);
    }
    return place->second;
  }

  /// At the end: a "mtllib" may come after the "usemtl" that needs it.
  void look_up_materials() {
    for (std::size_t i = 0; i < soup_.materials.size(); ++i) {
      const auto known = library_.find(soup_.materials[i].name);
      if (known != library_.end())
        soup_.materials[i] = known->second;
      else
        warnings_.add(material_lines_[i], "no material file defines " + quote(soup_.materials[i].name) +
                                              ": its name alone is kept");
    }
  }

  /// The rest of a mtllib line: one name that may hold blanks, or several names.
  void library(std::string_view rest) {
    if (rest.empty()) return warnings_.add(lines_.number(), "\"mtllib\" without a file name: skipped");
    if (open_library(rest)) return;
    std::size_t words = 0;
    for (std::string_view left = rest, word; !(word = next_word(left)).empty(); ++words) {
      if (words == 0 && word.size() == rest.size()) break;
      if (!open_library(word)) missing_library(word);
    }
    if (words == 0) missing_library(rest);
  }

  void missing_library(std::string_view name) {
    const bool outside = path_beside(file_.path, name).empty();
    warnings_.add(lines_.number(), "material file " + quote(name) +
                                       (outside ? " is outside of this file's folder: not read"
                                                : " cannot be read: its materials are missing"));
  }

  bool open_library(std::string_view name) {
    const std::string path = path_beside(file_.path, name);
    std::error_code error;
    if (path.empty() || !std::filesystem::is_regular_file(path, error)) return false;
    if (!read_libraries_.insert(path).second) return true;
    const auto opened = tetfmt::MappedFile::open(path);
    if (!opened) return false;
    const auto bytes = opened->bytes();
    read_mtl(path, {reinterpret_cast<const char*>(bytes.data()), bytes.size()}, library_,
             library_warnings_.emplace_back(path));
    return true;
  }

  const SourceFile& file_;
  LogicalLines lines_;
  PolygonSoup soup_;
  Warnings warnings_;
  std::vector<Warnings> library_warnings_;
  std::vector<std::size_t> texcoord_corners_, normal_corners_;  ///< those that named rows further down

  std::string object_name_, group_name_;
  std::map<std::pair<std::string, std::string>, Index> objects_;
  std::optional<Index> object_;  ///< of the faces that follow, once one has come

  MaterialLibrary library_;
  std::set<std::string> read_libraries_;
  std::string material_name_;
  std::size_t material_line_ = 0;            ///< of its "usemtl"
  std::optional<Index> material_;            ///< of the faces that follow, once one has come
  std::map<std::string, Index> materials_;   ///< those in the soup
  std::vector<std::size_t> material_lines_;  ///< where those were first used
  bool free_form_ = false;
};

}  // namespace

PolygonSoup read_obj(const SourceFile& file) {
  return ObjReader(file).read();
}

}  // namespace tetprep
