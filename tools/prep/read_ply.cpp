// SPDX-License-Identifier: AGPL-3.0-or-later
// PLY, ascii and binary of both byte orders (Turk, "The PLY polygon file format", 1994): polygons, and
// whatever the file says of its vertices.
//
// Not by CGAL's or Draco's reader: CGAL's takes a second for a million ascii triangles, drops what is not a
// point or a face, and does not look at how reading its faces went; Draco's has no big-endian files and keeps
// neither double coordinates nor unknown properties.
#include <algorithm>
#include <cmath>
#include <cstring>
#include <utility>

#include "prep/ply_header.hpp"
#include "prep/text_lines.hpp"

namespace tetprep {
namespace {

using tetfmt::PropertyType;

/// `work` with a value of the C++ type that `type` stands for.
template <class Work>
auto with_type(PropertyType type, const Work& work) {
  switch (type) {
    case PropertyType::int8:
      return work(std::int8_t{});
    case PropertyType::uint8:
      return work(std::uint8_t{});
    case PropertyType::int16:
      return work(std::int16_t{});
    case PropertyType::uint16:
      return work(std::uint16_t{});
    case PropertyType::int32:
      return work(std::int32_t{});
    case PropertyType::uint32:
      return work(std::uint32_t{});
    case PropertyType::float32:
      return work(float{});
    case PropertyType::float64:
      break;
  }
  return work(double{});
}

/// Values of a binary body, one after the other. Cuts at the end of the file throw.
class BinaryBody {
 public:
  BinaryBody(const SourceFile& file, const PlyHeader& header)
      : file_(file), rest_(header.body), swap_(header.format == PlyFormat::big_endian) {}

  void start(std::string_view element, std::uint64_t number) { element_ = element, number_ = number; }
  void finish() {}
  std::size_t line() const { return 0; }

  double number(PropertyType type) {
    return with_type(type, [&](auto zero) { return static_cast<double>(take<decltype(zero)>()); });
  }
  std::int64_t integer(PropertyType type) {
    if (type >= PropertyType::float32) return whole(number(type));
    return with_type(type, [&](auto zero) { return static_cast<std::int64_t>(take<decltype(zero)>()); });
  }
  void skip(PropertyType type, std::uint64_t count) {
    if (count > rest_.size() / size_of(type)) cut_short();
    rest_.remove_prefix(static_cast<std::size_t>(count) * size_of(type));
  }
  [[noreturn]] void fail(const std::string& message) const {
    file_.fail(0, counted(element_, number_) + ": " + message);
  }

  /// How many values of a list may still come.
  std::uint64_t room(PropertyType type) const { return rest_.size() / size_of(type); }
  [[noreturn]] void cut_short() const { fail("the file ends in it: cut short, or damaged"); }

 private:
  template <class T>
  T take() {
    if (rest_.size() < sizeof(T)) cut_short();
    char bytes[sizeof(T)];
    std::memcpy(bytes, rest_.data(), sizeof bytes);
    rest_.remove_prefix(sizeof bytes);
    if (swap_) std::reverse(bytes, bytes + sizeof bytes);
    T value{};
    std::memcpy(&value, bytes, sizeof value);
    return value;
  }
  std::int64_t whole(double value) const {
    if (std::abs(value) <= 9e15 && value == std::floor(value)) return static_cast<std::int64_t>(value);
    fail(tetprep::number(value) + " is not a whole number");
  }

  const SourceFile& file_;
  std::string_view rest_;
  bool swap_;
  std::string_view element_;
  std::uint64_t number_ = 0;
};

/// Values of an ascii body: each element on a line of its own.
class TextBody {
 public:
  TextBody(const SourceFile& file, const PlyHeader& header)
      : file_(file), lines_(header.body, false), before_(header.lines) {}

  void start(std::string_view element, std::uint64_t number) {
    element_ = element, number_ = number;
    if (!lines_.next(rest_)) fail("the file ends before it: cut short, or damaged");
  }
  void finish() {
    if (!(rest_ = trim(rest_)).empty())
      fail("more on its line than its properties: " + quote(rest_.substr(0, rest_.find(' '))));
  }
  std::size_t line() const { return before_ + lines_.number(); }

  /// Rounded to the type that the header gives it, as the program that wrote it had it.
  double number(PropertyType type) {
    const std::string_view word = take();
    const auto value = parse_double(word);
    if (value && type == PropertyType::float32) return static_cast<double>(nearest_float(word, *value));
    if (value) return *value;
    fail(quote(word) + " is not a number");
  }
  std::int64_t integer(PropertyType) {
    const std::string_view word = take();
    const auto value = parse_integer<std::int64_t>(word);
    if (!value) fail(quote(word) + " is not a whole number");
    return *value;
  }
  void skip(PropertyType, std::uint64_t count) {
    for (std::uint64_t i = 0; i < count; ++i) take();
  }
  [[noreturn]] void fail(const std::string& message) const {
    file_.fail(line(), counted(element_, number_) + ": " + message);
  }
  std::uint64_t room(PropertyType) const { return rest_.size() / 2 + 1; }
  [[noreturn]] void cut_short() const { fail("its line ends too early"); }

 private:
  std::string_view take() {
    const std::string_view word = next_word(rest_);
    if (word.empty()) cut_short();
    return word;
  }
  /// Not by way of double: rounding twice may miss the nearest.
  static float nearest_float(std::string_view word, double value) {
    if (word[0] == '+') word.remove_prefix(1);
    float result = 0;
    const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), result);
    return error == std::errc{} ? result : static_cast<float>(value);
  }

  const SourceFile& file_;
  PlainLines lines_;
  std::size_t before_;
  std::string_view rest_;
  std::string_view element_;
  std::uint64_t number_ = 0;
};

/// What colours of a type are divided by; 0: such a type holds no colours.
double color_scale(PropertyType type) {
  switch (type) {
    case PropertyType::uint8:
      return 255;
    case PropertyType::uint16:
      return 65535;
    case PropertyType::float32:
    case PropertyType::float64:
      return 1;
    default:
      return 0;
  }
}

std::size_t find_scalar(const PlyElement& element, std::string_view name) {
  const std::size_t place = element.find(name);
  return place != PlyElement::kNone && element.properties[place].list_count ? PlyElement::kNone : place;
}

std::size_t find_list(const PlyElement& element, std::string_view name) {
  const std::size_t place = element.find(name);
  return place != PlyElement::kNone && !element.properties[place].list_count ? PlyElement::kNone : place;
}

/// Positions, among an element's properties, of a colour's components; the fourth may be missing.
struct ColorPlaces {
  std::array<std::size_t, 4> at{};
  std::size_t count = 0;
};

ColorPlaces color_places(const PlyElement& element) {
  constexpr const char* kNames[][4] = {{"red", "green", "blue", "alpha"},
                                       {"diffuse_red", "diffuse_green", "diffuse_blue", "diffuse_alpha"},
                                       {"r", "g", "b", "a"}};
  for (const auto& names : kNames) {
    ColorPlaces places;
    for (const char* name : names) {
      const std::size_t place = find_scalar(element, name);
      if (place == PlyElement::kNone || color_scale(element.properties[place].type) == 0) break;
      places.at[places.count++] = place;
    }
    if (places.count >= 3) return places;
  }
  return {};
}

std::array<float, 4> color_of(const PlyElement& element, const ColorPlaces& places,
                              const std::vector<double>& row) {
  std::array<float, 4> color{0, 0, 0, 1};
  for (std::size_t i = 0; i < places.count; ++i)
    color[i] = static_cast<float>(row[places.at[i]] / color_scale(element.properties[places.at[i]].type));
  return color;
}

template <class Body>
class PlyReader {
 public:
  PlyReader(const SourceFile& file, const PlyHeader& header)
      : file_(file), header_(header), body_(file, header), warnings_(file.path) {}

  PolygonSoup read() {
    bool vertices = false, faces = false;
    for (const PlyElement& element : header_.elements) {
      if (element.name == "vertex" || element.name == "vertices") {
        if (std::exchange(vertices, true)) file_.fail(header_.lines, "two elements of vertices");
        read_vertices(element);
      } else if (element.name == "face" || element.name == "faces") {
        if (std::exchange(faces, true)) file_.fail(header_.lines, "two elements of faces");
        if (!vertices) file_.unsupported(header_.lines, "faces that come before the vertices are not read");
        read_faces(element);
      } else if (element.name == "tristrips" && element.count > 0) {
        file_.unsupported(header_.lines,
                          "triangle strips (element \"tristrips\") are not read: save it with faces");
      } else {
        for (std::uint64_t i = 0; i < element.count && !element.properties.empty(); ++i) {
          start(element, i);
          for (const PlyProperty& property : element.properties) skip(property);
          body_.finish();
        }
      }
    }
    finish_materials();
    warnings_.append_to(soup_.warnings);
    return std::move(soup_);
  }

 private:
  void start(const PlyElement& element, std::uint64_t number) { body_.start(element.name, number); }

  std::uint64_t length(const PlyProperty& property) {
    const std::int64_t count = body_.integer(*property.list_count);
    if (count < 0) body_.fail("a list of " + std::to_string(count) + " values");
    if (static_cast<std::uint64_t>(count) > body_.room(property.type)) body_.cut_short();
    return static_cast<std::uint64_t>(count);
  }

  void skip(const PlyProperty& property) {
    body_.skip(property.type, property.list_count ? length(property) : 1);
  }

  /// The scalar properties of one element, in `row`; `other` takes the lists.
  template <class Other>
  void read_row(const PlyElement& element, std::vector<double>& row, const Other& other) {
    row.resize(element.properties.size());
    for (std::size_t i = 0; i < row.size(); ++i) {
      if (element.properties[i].list_count)
        other(i);
      else
        row[i] = body_.number(element.properties[i].type);
    }
  }

  void read_vertices(const PlyElement& element) {
    std::vector<bool> taken(element.properties.size(), false);
    const auto places = [&](std::initializer_list<const char*> names) {
      std::vector<std::size_t> found;
      for (const char* name : names) {
        const std::size_t place = find_scalar(element, name);
        if (place != PlyElement::kNone && !taken[place]) found.push_back(place);
      }
      if (found.size() != names.size()) found.clear();
      for (const std::size_t place : found) taken[place] = true;
      return found;
    };
    const auto position = places({"x", "y", "z"});
    if (position.empty()) file_.fail(header_.lines, "vertices without x, y and z");
    const auto normal = places({"nx", "ny", "nz"});
    std::vector<std::size_t> texcoord;
    for (const auto& names : {std::initializer_list<const char*>{"s", "t"},
                              {"u", "v"},
                              {"texture_u", "texture_v"},
                              {"texture_s", "texture_t"}})
      if (texcoord.empty()) texcoord = places(names);
    const ColorPlaces color = color_places(element);
    for (std::size_t i = 0; i < color.count; ++i) taken[color.at[i]] = true;

    std::vector<std::pair<std::size_t, std::size_t>> others;  // place, number among the soup's properties
    for (std::size_t i = 0; i < element.properties.size(); ++i) {
      const PlyProperty& property = element.properties[i];
      if (property.list_count)
        warnings_.add(header_.lines, "vertex property " + quote(property.name) + " is a list: skipped");
      if (property.list_count || taken[i]) continue;
      others.emplace_back(i, soup_.properties.size());
      soup_.properties.push_back({property.name, property.type, {}});
    }

    // The header has been weighed against the file's size: these are no more than it warrants.
    const auto count = static_cast<std::size_t>(element.count);
    soup_.points.reserve(count);
    if (!normal.empty()) soup_.normals.rows.reserve(count);
    if (!texcoord.empty()) soup_.texcoords.rows.reserve(count);
    if (color.count > 0) soup_.colors.rows.reserve(count);
    for (PropertyChannel& property : soup_.properties) property.values.rows.reserve(count);
    std::vector<double> row;
    const auto as_float = [&](std::size_t place) { return static_cast<float>(row[place]); };
    for (std::size_t i = 0; i < count; ++i) {
      start(element, i);
      read_row(element, row, [&](std::size_t list) { skip(element.properties[list]); });
      body_.finish();
      soup_.points.push_back({row[position[0]], row[position[1]], row[position[2]]});
      if (body_.line() > 0) soup_.point_lines.push_back(body_.line());
      if (!normal.empty())
        soup_.normals.rows.push_back({as_float(normal[0]), as_float(normal[1]), as_float(normal[2])});
      if (!texcoord.empty()) soup_.texcoords.rows.push_back({as_float(texcoord[0]), as_float(texcoord[1])});
      if (color.count > 0) soup_.colors.rows.push_back(color_of(element, color, row));
      for (const auto& [place, property] : others)
        soup_.properties[property].values.rows.push_back(row[place]);
    }
  }

  void read_faces(const PlyElement& element) {
    if (element.count == 0) return;
    std::size_t corners = find_list(element, "vertex_indices");
    if (corners == PlyElement::kNone) corners = find_list(element, "vertex_index");
    if (corners == PlyElement::kNone)
      file_.fail(header_.lines, "faces without a list \"vertex_indices\" or \"vertex_index\"");
    // MeshLab's: texture coordinates of each corner, and which of several textures a face has.
    const std::size_t wedges = find_list(element, "texcoord");
    const std::size_t texture = find_scalar(element, "texnumber");
    const bool has_wedges = wedges != PlyElement::kNone;
    const bool vertex_colors = !soup_.colors.rows.empty();
    const ColorPlaces color = vertex_colors ? ColorPlaces{} : color_places(element);
    if (has_wedges) soup_.texcoords = {};  // the corners' own say more than the vertices'

    const auto count = static_cast<std::size_t>(element.count);
    soup_.ends.reserve(count);
    std::vector<double> row;
    std::vector<float> wedge;
    for (std::size_t i = 0; i < count; ++i) {
      start(element, i);
      wedge.clear();
      read_row(element, row, [&](std::size_t place) {
        const PlyProperty& list = element.properties[place];
        if (place == corners) {
          for (std::uint64_t left = length(list); left > 0; --left) corner(body_.integer(list.type));
        } else if (place == wedges) {
          for (std::uint64_t left = length(list); left > 0; --left)
            wedge.push_back(static_cast<float>(body_.number(list.type)));
        } else {
          skip(list);
        }
      });
      body_.finish();
      const std::size_t begin = soup_.ends.empty() ? 0 : soup_.ends.back();
      soup_.ends.push_back(soup_.corners.size());
      if (body_.line() > 0) soup_.lines.push_back(body_.line());
      if (has_wedges) add_wedges(begin, wedge);
      if (color.count > 0) {
        soup_.colors.of_corner.resize(soup_.corners.size(), static_cast<Index>(soup_.colors.rows.size()));
        soup_.colors.rows.push_back(color_of(element, color, row));
      }
      if (texture != PlyElement::kNone) soup_.face_materials.push_back(texture_number(row[texture]));
    }
  }

  void corner(std::int64_t point) {
    if (point < 0) body_.fail("refers to point " + std::to_string(point) + " (counted from 0)");
    soup_.corners.push_back(static_cast<std::uint64_t>(point));
  }

  /// A face's list of texture coordinates: two for each corner, or none.
  void add_wedges(std::size_t begin, const std::vector<float>& wedge) {
    auto& [rows, of_corner] = soup_.texcoords;
    const std::size_t corners = soup_.corners.size() - begin;
    if (!wedge.empty() && wedge.size() != 2 * corners)
      body_.fail(std::to_string(wedge.size()) + " texture coordinates for " + std::to_string(corners) +
                 " corners");
    of_corner.resize(begin, kNone);
    for (std::size_t i = 0; i + 1 < wedge.size(); i += 2) {
      of_corner.push_back(static_cast<Index>(rows.size()));
      rows.push_back({wedge[i], wedge[i + 1]});
    }
    of_corner.resize(soup_.corners.size(), kNone);
  }

  Index texture_number(double number) const {
    const bool known = number >= 0 && number < static_cast<double>(header_.textures.size());
    return known ? static_cast<Index>(number) : kNone;
  }

  void finish_materials() {
    for (const std::string& texture : header_.textures) {
      look_for_texture(file_.path, texture, 0, warnings_);
      Material material;
      material.base_color_texture = texture;
      material.values.base_color = {1, 1, 1, 1};  // the texture's colours as they are
      soup_.materials.push_back(std::move(material));
    }
  }

  const SourceFile& file_;
  const PlyHeader& header_;
  Body body_;
  Warnings warnings_;
  PolygonSoup soup_;
};

}  // namespace

PolygonSoup read_ply(const SourceFile& file) {
  const PlyHeader header = read_ply_header(file);
  if (header.format == PlyFormat::ascii) return PlyReader<TextBody>(file, header).read();
  return PlyReader<BinaryBody>(file, header).read();
}

}  // namespace tetprep
