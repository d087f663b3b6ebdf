// SPDX-License-Identifier: AGPL-3.0-or-later
#include <algorithm>
#include <boost/locale/utf.hpp>
#include <iterator>
#include <map>
#include <span>

#include "common/failure.hpp"
#include "prep/appearance.hpp"
#include "prep/draco_surface.hpp"

namespace tetprep {
namespace {

/// `text` if it is UTF-8, or else as if it were Latin-1: then every byte is a code point, and none is lost.
std::string as_utf8(const std::string& text) {
  using Utf8 = boost::locale::utf::utf_traits<char>;
  bool valid = true;
  for (auto place = text.begin(); valid && place != text.end();) {
    const auto point = Utf8::decode(place, text.end());
    valid = point != boost::locale::utf::illegal && point != boost::locale::utf::incomplete;
  }
  if (valid) return text;
  std::string converted;
  for (const char c : text) Utf8::encode(static_cast<unsigned char>(c), std::back_inserter(converted));
  return converted;
}

/// TEXT: every string once, in the order in which they were first needed.
class Texts {
 public:
  tetfmt::TextRef add(const std::string& string) {
    std::string text = as_utf8(string);
    std::erase(text, '\0');  // it would end the string
    if (text.empty()) return kNone;
    const auto [place, is_new] = places_.try_emplace(text, static_cast<tetfmt::TextRef>(bytes_.size()));
    if (is_new) {
      const auto raw = std::as_bytes(std::span(text.c_str(), text.size() + 1));
      if (bytes_.size() + raw.size() >= kNone)
        throw Failure(ExitCode::unsupported,
                      "the names of materials, objects and properties take over 4 GiB");
      bytes_.insert(bytes_.end(), raw.begin(), raw.end());
    }
    return place->second;
  }
  const std::vector<std::byte>& bytes() const { return bytes_; }

 private:
  std::map<std::string, tetfmt::TextRef> places_;
  std::vector<std::byte> bytes_;
};

/// Sections that say something, in the order in which they are added.
class Sections {
 public:
  template <class T>
  void add(tetfmt::SectionKind kind, const std::vector<T>& elements) {
    add(kind, sizeof(T), std::as_bytes(std::span(elements)));
  }
  void add(tetfmt::SectionKind kind, std::size_t stride, std::span<const std::byte> bytes) {
    if (!bytes.empty())
      sections_.push_back({kind, static_cast<std::uint32_t>(stride), {bytes.begin(), bytes.end()}});
  }
  std::vector<tetfmt::OptionalSection> take() { return std::move(sections_); }

 private:
  std::vector<tetfmt::OptionalSection> sections_;
};

std::vector<tetfmt::Material> stored_materials(const std::vector<Material>& materials, Texts& texts) {
  std::vector<tetfmt::Material> stored;
  for (const Material& material : materials) {
    stored.push_back(material.values);
    stored.back().name = texts.add(material.name);
    stored.back().base_color_texture = texts.add(material.base_color_texture);
    stored.back().reserved = {};
  }
  return stored;
}

std::vector<tetfmt::Object> stored_objects(const std::vector<Object>& objects, Texts& texts) {
  if (objects.size() == 1 && objects.front().name.empty()) return {};
  std::vector<tetfmt::Object> stored;
  for (const Object& object : objects) stored.push_back({texts.add(object.name), texts.add(object.source)});
  return stored;
}

bool has_point_values(const Appearance& appearance) {
  return appearance.surface_points > 0 && !appearance.corners.empty() &&
         !(appearance.normals.empty() && appearance.texcoords.empty() && appearance.colors.empty() &&
           appearance.properties.empty());
}

Appearance normals_of(const Appearance& appearance) {
  Appearance normals;
  normals.surface_points = appearance.surface_points;
  normals.corners = appearance.corners;
  normals.normals = appearance.normals;
  return normals;
}

}  // namespace

std::vector<tetfmt::OptionalSection> to_sections(const Appearance& appearance, KeepAttributes keep,
                                                 bool draco) {
  if (keep == KeepAttributes::none) return {};
  if (keep == KeepAttributes::normals &&
      !(appearance.texcoords.empty() && appearance.colors.empty() && appearance.properties.empty() &&
        appearance.materials.empty() && appearance.objects.empty()))
    return to_sections(normals_of(appearance), KeepAttributes::all, draco);

  const bool points = has_point_values(appearance);
  const bool raw_points = points && !draco;
  Texts texts;
  const auto materials = stored_materials(appearance.materials, texts);
  const auto objects = stored_objects(appearance.objects, texts);
  std::vector<tetfmt::Property> properties;
  std::vector<double> values;
  if (raw_points) {
    for (const PointProperty& property : appearance.properties) {
      properties.push_back({texts.add(property.name), static_cast<std::uint32_t>(property.type)});
      values.insert(values.end(), property.values.begin(), property.values.end());
    }
  }

  Sections sections;
  sections.add(tetfmt::kTexts, 1, texts.bytes());
  sections.add(tetfmt::kMaterials, materials);
  sections.add(tetfmt::kObjects, objects);
  if (objects.size() > 1) sections.add(tetfmt::kTriangleObjects, appearance.triangle_object);
  if (raw_points) {
    sections.add(tetfmt::kCorners, appearance.corners);
    sections.add(tetfmt::kNormals, appearance.normals);
    sections.add(tetfmt::kTexcoords, appearance.texcoords);
    sections.add(tetfmt::kColors, appearance.colors);
    sections.add(tetfmt::kProperties, properties);
    sections.add(tetfmt::kPropertyValues, values);
  } else if (points) {
    sections.add(tetfmt::kDracoSurface, 1, encode_draco(appearance));
  }
  return sections.take();
}

}  // namespace tetprep
