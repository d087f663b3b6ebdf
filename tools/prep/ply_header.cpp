// SPDX-License-Identifier: AGPL-3.0-or-later
#include "prep/ply_header.hpp"

#include <algorithm>

#include "prep/text_lines.hpp"

namespace tetprep {
namespace {

using tetfmt::PropertyType;

std::optional<PropertyType> type_of(std::string_view name) {
  constexpr std::pair<std::string_view, PropertyType> kNames[] = {
      {"char", PropertyType::int8},      {"int8", PropertyType::int8},
      {"uchar", PropertyType::uint8},    {"uint8", PropertyType::uint8},
      {"short", PropertyType::int16},    {"int16", PropertyType::int16},
      {"ushort", PropertyType::uint16},  {"uint16", PropertyType::uint16},
      {"int", PropertyType::int32},      {"int32", PropertyType::int32},
      {"uint", PropertyType::uint32},    {"uint32", PropertyType::uint32},
      {"float", PropertyType::float32},  {"float32", PropertyType::float32},
      {"double", PropertyType::float64}, {"float64", PropertyType::float64}};
  for (const auto& [known, type] : kNames)
    if (known == name) return type;
  return std::nullopt;
}

/// The fewest bytes that the elements can take: binary values take what they take (lists: their length),
/// ascii ones a digit and a blank. In double: the counts are the file's, and their products may be anything.
double least_bytes(const PlyHeader& header) {
  double bytes = 0;
  for (const PlyElement& element : header.elements) {
    double each = 0;
    for (const PlyProperty& property : element.properties)
      each += header.format == PlyFormat::ascii
                  ? 2
                  : static_cast<double>(size_of(property.list_count.value_or(property.type)));
    bytes += static_cast<double>(element.count) * each;
  }
  return bytes;
}

}  // namespace

std::size_t PlyElement::find(std::string_view property) const {
  for (std::size_t i = 0; i < properties.size(); ++i)
    if (properties[i].name == property) return i;
  return kNone;
}

bool PlyElement::has_lists() const {
  return std::any_of(properties.begin(), properties.end(),
                     [](const PlyProperty& property) { return property.list_count.has_value(); });
}

std::size_t size_of(PropertyType type) {
  constexpr std::size_t kSizes[] = {1, 1, 2, 2, 4, 4, 4, 8};
  return kSizes[static_cast<std::size_t>(type)];
}

PlyHeader read_ply_header(const SourceFile& file) {
  if (!file.text.starts_with("ply")) file.fail(1, "does not start as a PLY file");
  PlyHeader header;
  PlainLines lines(file.text, false);
  std::string_view line;
  bool formatted = false, ended = false;
  while (!ended && lines.next(line)) {
    const auto fail = [&](const std::string& message) { file.fail(lines.number(), message); };
    const std::string_view keyword = next_word(line);
    if (keyword == "format") {
      const std::string_view name = next_word(line);
      if (name == "ascii")
        header.format = PlyFormat::ascii;
      else if (name == "binary_little_endian")
        header.format = PlyFormat::little_endian;
      else if (name == "binary_big_endian")
        header.format = PlyFormat::big_endian;
      else
        fail(quote(name) + " is not a format of PLY");
      formatted = true;
    } else if (keyword == "element") {
      const std::string_view name = next_word(line);
      const auto count = parse_integer<std::uint64_t>(next_word(line));
      if (!count) fail("expected a name and a number after \"element\"");
      header.elements.push_back({std::string(name), *count, {}});
    } else if (keyword == "property") {
      if (header.elements.empty()) fail("a property before the first element");
      PlyElement& element = header.elements.back();
      const auto take_type = [&] {
        const std::string_view name = next_word(line);
        const auto type = type_of(name);
        if (!type) fail(quote(name) + " is not a type of PLY");
        return *type;
      };
      PlyProperty property;
      std::string_view after = line;
      if (next_word(after) == "list") {
        line = after;
        property.list_count = take_type();
        if (*property.list_count >= PropertyType::float32) fail("a list's length must be of a whole type");
      }
      property.type = take_type();
      property.name = next_word(line);
      if (property.name.empty()) fail("a property without a name");
      if (element.properties.size() < 256 ? element.find(property.name) != PlyElement::kNone : true)
        fail(element.properties.size() < 256
                 ? "property " + quote(property.name) + " twice in element " + quote(element.name)
                 : "more than 256 properties in element " + quote(element.name));
      element.properties.push_back(std::move(property));
    } else if (keyword == "comment" || keyword == "obj_info") {
      if (next_word(line) == "TextureFile" && !trim(line).empty())
        header.textures.emplace_back(trim(line).substr(0, 4096));
    } else if (keyword == "end_header") {
      ended = true;
    }
  }
  header.lines = lines.number();
  header.body = lines.rest();
  if (!ended) file.fail(lines.number(), "the header does not end: cut short, or no PLY file");
  if (!formatted) file.fail(lines.number(), "the header names no format");
  const auto count_of = [&](std::string_view name, std::string_view other) {
    std::uint64_t count = 0;
    for (const PlyElement& element : header.elements)
      if (element.name == name || element.name == other) count = element.count;
    return std::to_string(count);
  };
  if (least_bytes(header) > static_cast<double>(header.body.size()) + 1)  // no blank after the last value
    file.fail(lines.number(), "the header promises " + count_of("vertex", "vertices") + " vertices and " +
                                  count_of("face", "faces") + " faces, but only " +
                                  std::to_string(header.body.size()) +
                                  " bytes follow: cut short, or damaged");
  return header;
}

}  // namespace tetprep
