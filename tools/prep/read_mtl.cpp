// SPDX-License-Identifier: AGPL-3.0-or-later
// Wavefront MTL.
//
// Not by tinyobjloader: it takes a missing or mistyped number for 0 without a word, its number parser misses
// the nearest float, and its warnings about materials name no line.
#include "prep/read_mtl.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <set>

#include "prep/text_lines.hpp"

namespace tetprep {
namespace {

class MtlReader {
 public:
  MtlReader(const std::string& path, std::string_view text, MaterialLibrary& library, Warnings& warnings)
      : path_(path), lines_(text), library_(library), warnings_(warnings) {}

  void read() {
    std::string_view line;
    while (lines_.next(line)) {
      line = line.substr(0, line.find('#'));
      const std::string_view keyword = next_word(line);
      if (keyword.empty()) continue;
      if (keyword == "newmtl") {
        start(trim(line));
      } else if (!started_) {
        warn(quote(keyword) + " before the first \"newmtl\": skipped");
      } else {
        statement(keyword, line);
      }
    }
    store();
    if (!left_out_.empty()) {
      std::string names;
      for (const std::string& name : left_out_) names += (names.empty() ? "" : ", ") + name;
      warnings_.add(0, "texture maps other than map_Kd are left out: " + names);
    }
  }

 private:
  void warn(const std::string& message) { warnings_.add(lines_.number(), message); }

  void start(std::string_view name) {
    store();
    started_ = true;
    current_ = {};
    current_.name = name;
    opacity_.reset();
    exponent_.reset();
    roughness_given_ = false;
    filter_.reset();
    illumination_ = 0;
    if (name.empty()) warn("a material without a name");
    if (library_.contains(name))
      warn("material " + quote(name) + " is here a second time: the first one counts");
  }

  void store() {
    if (!started_) return;
    tetfmt::Material& values = current_.values;
    if (opacity_) values.base_color[3] = *opacity_;
    if (exponent_ && !roughness_given_)
      values.roughness = static_cast<float>(std::sqrt(std::sqrt(2 / (static_cast<double>(*exponent_) + 2))));
    const bool lets_light_through =
        illumination_ == 4 || illumination_ == 6 || illumination_ == 7 || illumination_ == 9;
    if (filter_ && lets_light_through) values.transmission = *filter_;
    library_.emplace(current_.name, current_);
  }

  void statement(std::string_view keyword, std::string_view rest) {
    tetfmt::Material& values = current_.values;
    if (keyword == "Kd") {
      if (const auto color = color_of(keyword, rest, 1))
        std::copy(color->begin(), color->end(), values.base_color.begin());
    } else if (keyword == "Ke") {
      if (const auto color = color_of(keyword, rest, std::numeric_limits<float>::max()))
        values.emission = *color;
    } else if (keyword == "Tf") {
      if (const auto color = color_of(keyword, rest, 1))
        filter_ = ((*color)[0] + (*color)[1] + (*color)[2]) / 3;
    } else if (keyword == "d") {
      std::string_view after = rest;
      if (next_word(after) == "-halo") rest = after;
      if (const auto value = number_of(keyword, rest, 0, 1)) opacity_ = *value, opacity_by_d_ = true;
    } else if (keyword == "Tr") {
      const auto value = number_of(keyword, rest, 0, 1);
      if (value && !(opacity_ && opacity_by_d_)) opacity_ = 1 - *value, opacity_by_d_ = false;
    } else if (keyword == "Ns") {
      if (const auto value = number_of(keyword, rest, 0, kAny)) exponent_ = *value;
    } else if (keyword == "Pr") {
      if (const auto value = number_of(keyword, rest, 0, 1))
        values.roughness = *value, roughness_given_ = true;
    } else if (keyword == "Pm") {
      if (const auto value = number_of(keyword, rest, 0, 1)) values.metallic = *value;
    } else if (keyword == "Ni") {
      if (const auto value = number_of(keyword, rest, 0.001f, kAny)) values.ior = *value;
    } else if (keyword == "illum") {
      if (const auto value = number_of(keyword, rest, 0, 10)) illumination_ = static_cast<int>(*value);
    } else if (keyword == "map_Kd") {
      texture(rest);
    } else if (keyword.starts_with("map_") || keyword == "bump" || keyword == "norm" || keyword == "disp" ||
               keyword == "decal" || keyword == "refl") {
      if (left_out_.size() < 10) left_out_.emplace(keyword.substr(0, 20));
    } else if (keyword != "Ka" && keyword != "Ks" && keyword != "sharpness" && keyword != "Ps" &&
               keyword != "Pc" && keyword != "Pcr" && keyword != "aniso" && keyword != "anisor") {
      warn("unknown statement " + quote(keyword) + ": skipped");
    }
  }

  std::optional<float> number_of(std::string_view keyword, std::string_view rest, float least, float most) {
    const std::string_view word = next_word(rest);
    const auto value = parse_double(word);
    if (!value || !std::isfinite(*value)) {
      warn(std::string(keyword) + " needs a number, not " + quote(word) + ": skipped");
      return std::nullopt;
    }
    return within(keyword, word, *value, least, most);
  }

  float within(std::string_view keyword, std::string_view word, double value, float least, float most) {
    if (value >= static_cast<double>(least) && value <= static_cast<double>(most))
      return static_cast<float>(value);
    const float nearest = value < static_cast<double>(least) ? least : most;
    warn(std::string(keyword) + " " + quote(word) + " is out of range: taken as " +
         number(static_cast<double>(nearest)));
    return nearest;
  }

  /// Three numbers, or one that stands for all three.
  std::optional<std::array<float, 3>> color_of(std::string_view keyword, std::string_view rest, float most) {
    std::array<float, 3> color{};
    std::size_t count = 0;
    for (std::string_view word; count < 3 && !(word = next_word(rest)).empty(); ++count) {
      const auto value = parse_double(word);
      if (!value || !std::isfinite(*value)) {
        const bool other = word == "spectral" || word == "xyz";
        warn(std::string(keyword) + " needs three numbers, not " + quote(word) +
             (other ? " (colours that are not red, green and blue are not read)" : "") + ": skipped");
        return std::nullopt;
      }
      color[count] = within(keyword, word, *value, 0, most);
    }
    if (count == 1) return std::array<float, 3>{color[0], color[0], color[0]};
    if (count == 3) return color;
    warn(std::string(keyword) + " needs three numbers, but has " + std::to_string(count) + ": skipped");
    return std::nullopt;
  }

  /// "[options] file name"; the name may hold blanks.
  void texture(std::string_view rest) {
    // Options and how many words follow each; the last two of -o, -s and -t may be missing.
    constexpr std::pair<std::string_view, int> kOptions[] = {
        {"-blendu", 1}, {"-blendv", 1}, {"-cc", 1},     {"-clamp", 1},   {"-mm", 2}, {"-o", 3},
        {"-s", 3},      {"-t", 3},      {"-texres", 1}, {"-imfchan", 1}, {"-bm", 1}, {"-boost", 1}};
    for (rest = trim(rest); rest.starts_with('-');) {
      std::string_view after = rest;
      const std::string_view option = next_word(after);
      const auto* known = std::find_if(std::begin(kOptions), std::end(kOptions),
                                       [&](const auto& candidate) { return candidate.first == option; });
      if (known == std::end(kOptions)) break;  // a file name that starts like this
      for (int i = 0; i < known->second; ++i) {
        std::string_view next = after;
        const std::string_view word = next_word(next);
        if (known->second == 3 && i > 0 && !parse_double(word)) break;
        after = next;
      }
      rest = trim(after);
    }
    if (rest.empty()) return warn("map_Kd without a file name: skipped");
    current_.base_color_texture = rest;
    look_for_texture(path_, rest, lines_.number(), warnings_);
  }

  static constexpr float kAny = std::numeric_limits<float>::max();
  const std::string& path_;
  LogicalLines lines_;
  MaterialLibrary& library_;
  Warnings& warnings_;

  bool started_ = false;
  Material current_;
  std::optional<float> opacity_, exponent_, filter_;
  bool opacity_by_d_ = false, roughness_given_ = false;
  int illumination_ = 0;
  std::set<std::string> left_out_;
};

}  // namespace

void read_mtl(const std::string& path, std::string_view text, MaterialLibrary& library, Warnings& warnings) {
  constexpr std::string_view kMark = "\xEF\xBB\xBF";
  if (text.starts_with(kMark)) text.remove_prefix(kMark.size());
  MtlReader(path, text, library, warnings).read();
}

}  // namespace tetprep
