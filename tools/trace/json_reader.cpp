// SPDX-License-Identifier: AGPL-3.0-or-later
#include "trace/json_reader.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <limits>
#include <numeric>
#include <set>

#include "common/failure.hpp"
#include "common/parse.hpp"

namespace tetprep {
namespace {

using nlohmann::json;

constexpr std::size_t kMaxBytes = 16u << 20;
constexpr int kMaxDepth = 64;
constexpr double kMaxCoordinate = 1e30;

/// What a message can show of a value.
std::string shown(const json& value) {
  constexpr std::size_t kLongest = 48;
  if (value.is_object()) return "an object";
  if (value.is_array() && value.size() > 8) return "a list of " + std::to_string(value.size());
  std::string text = value.dump(-1, ' ', false, json::error_handler_t::replace);
  if (text.size() > kLongest) text = text.substr(0, kLongest) + "...";
  return text;
}

std::string read_text(const std::string& path) {
  std::error_code error;
  if (std::filesystem::is_directory(path, error))
    throw Failure(ExitCode::io, path + ": is a folder; name a scene file");
  std::ifstream file(path, std::ios::binary);
  if (!file) throw Failure(ExitCode::io, path + ": cannot be opened; check the path and its permissions");
  std::string text(kMaxBytes + 1, '\0');
  file.read(text.data(), static_cast<std::streamsize>(text.size()));
  if (file.bad()) throw Failure(ExitCode::io, path + ": cannot be read");
  text.resize(static_cast<std::size_t>(file.gcount()));
  if (text.size() > kMaxBytes) throw Failure(ExitCode::invalid, path + ": larger than 16 MB: no scene file");
  return text;
}

std::size_t letter_changes(std::string_view a, std::string_view b) {  // Levenshtein 1966
  std::vector<std::size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), std::size_t{0});
  for (std::size_t i = 0; i < a.size(); ++i) {
    std::size_t diagonal = row[0];
    row[0] = i + 1;
    for (std::size_t j = 0; j < b.size(); ++j) {
      const std::size_t above = row[j + 1];
      row[j + 1] = std::min({above + 1, row[j] + 1, diagonal + (a[i] != b[j])});
      diagonal = above;
    }
  }
  return row.back();
}

}  // namespace

std::string_view nearest_name(std::string_view wrong, const std::vector<std::string_view>& names) {
  if (wrong.size() > 64) return {};
  std::string_view best;
  std::size_t least = std::max<std::size_t>(wrong.size() / 2, 1) + 1;
  for (const std::string_view name : names) {
    const std::size_t changes = letter_changes(wrong, name);
    if (changes < least) least = changes, best = name;
  }
  return best;
}

JsonFile::JsonFile(const std::string& path) : path_(path) {
  const std::string text = read_text(path);
  // The parser keeps the last of equal keys, and says nothing.
  std::vector<std::set<std::string>> keys;
  const auto watch = [&](int depth, json::parse_event_t event, json& parsed) {
    if (depth > kMaxDepth)
      throw Failure(ExitCode::invalid, path + ": nested deeper than 64 levels: no scene file");
    if (event == json::parse_event_t::object_start) keys.emplace_back();
    if (event == json::parse_event_t::object_end) keys.pop_back();
    if (event == json::parse_event_t::key && !keys.back().insert(parsed.get<std::string>()).second)
      throw Failure(ExitCode::invalid,
                    path + ": the key " + shown(parsed) + " stands twice in one object; keep one of them");
    return true;
  };
  try {
    value_ = json::parse(text, watch);
  } catch (const json::exception& error) {
    std::string what = error.what();
    if (const auto end = what.find("] "); what.starts_with("[") && end != std::string::npos)
      what.erase(0, end + 2);
    throw Failure(ExitCode::invalid, path + ": not JSON: " + what);
  }
}

void JsonValue::refuse(const std::string& problem) const {
  throw Failure(ExitCode::invalid, where() + ": " + problem);
}

void JsonValue::expected(const std::string& what) const {
  refuse("expected " + what + ", found " + shown(value_));
}

void JsonValue::read_members(const Members& members) const {
  std::vector<std::string_view> names;
  for (const auto& member : members) names.push_back(member.first);
  each_member([&](const std::string& key, const JsonValue&) {
    if (std::find(names.begin(), names.end(), key) != names.end()) return;
    const std::string_view near = nearest_name(key, names);
    std::string problem = "unknown key " + shown(key);
    if (!near.empty()) {
      problem += "; did you mean \"" + std::string(near) + "\"?";
    } else {
      problem += "; known are";
      for (const std::string_view name : names) problem += " " + std::string(name);
    }
    refuse(problem);
  });
  for (const auto& [name, read] : members) {
    const auto found = value_.find(name);
    if (found != value_.end()) read(child(*found, "." + std::string(name)));
  }
}

void JsonValue::each_member(const std::function<void(const std::string&, const JsonValue&)>& use) const {
  if (!value_.is_object()) expected("an object {...}");
  for (const auto& [key, value] : value_.items()) use(key, child(value, "." + key));
}

std::vector<JsonValue> JsonValue::items(std::size_t least) const {
  if (!value_.is_array()) expected("a list [...]");
  if (value_.size() < least) expected("a list of at least " + std::to_string(least));
  std::vector<JsonValue> result;
  for (std::size_t i = 0; i < value_.size(); ++i)
    result.push_back(child(value_[i], "[" + std::to_string(i) + "]"));
  return result;
}

double JsonValue::number(double low, double high) const {
  const std::string wanted = "a number from " + tetprep::number(low) + " to " + tetprep::number(high);
  if (!value_.is_number()) expected(wanted);
  const auto result = value_.get<double>();
  if (!(result >= low && result <= high)) expected(wanted);
  return result;
}

int JsonValue::integer(int low, int high) const {
  const std::string wanted = "a whole number from " + std::to_string(low) + " to " + std::to_string(high);
  if (!value_.is_number()) expected(wanted);
  const auto result = value_.get<double>();
  if (!(result >= low && result <= high) || result != std::floor(result)) expected(wanted);
  return static_cast<int>(result);
}

bool JsonValue::flag() const {
  if (!value_.is_boolean()) expected("true or false");
  return value_.get<bool>();
}

std::string JsonValue::text() const {
  if (!value_.is_string() || value_.get_ref<const std::string&>().empty()) expected("a text");
  auto result = value_.get<std::string>();
  if (result.find('\0') != std::string::npos) expected("a text without zeros");
  return result;
}

std::size_t JsonValue::choice(const std::vector<std::string_view>& choices) const {
  std::string wanted;
  for (std::size_t i = 0; i < choices.size(); ++i) {
    if (value_.is_string() && value_.get_ref<const std::string&>() == choices[i]) return i;
    wanted += (i == 0 ? "" : i + 1 < choices.size() ? ", " : " or ") + ('"' + std::string(choices[i]) + '"');
  }
  expected(wanted);
}

Vec3 JsonValue::vector() const {
  const std::string wanted = "three numbers [x, y, z], each up to 1e30";
  if (!value_.is_array() || value_.size() != 3) expected(wanted);
  std::array<double, 3> result{};
  for (std::size_t i = 0; i < 3; ++i) {
    if (!value_[i].is_number()) expected(wanted);
    result[i] = value_[i].get<double>();
    if (!(std::abs(result[i]) <= kMaxCoordinate)) expected(wanted);
  }
  return vec3(result);
}

Rgb JsonValue::color(double most) const {
  const std::string range = "0 to " + tetprep::number(most);
  if (value_.is_string()) {
    const auto& text = value_.get_ref<const std::string&>();
    const auto hexadecimal = [](char c) {
      return (c >= '0' && c <= '9') || (c >= 'a' && c <= 'f') || (c >= 'A' && c <= 'F');
    };
    if (text.size() == 7 && text[0] == '#' && std::all_of(text.begin() + 1, text.end(), hexadecimal)) {
      const unsigned long bits = std::stoul(text.substr(1), nullptr, 16);
      return from_screen(static_cast<double>(bits >> 16), static_cast<double>(bits >> 8 & 255),
                         static_cast<double>(bits & 255));
    }
  }
  const std::string wanted = "a colour: a number, [r, g, b] of numbers " + range + ", or \"#rrggbb\"";
  const auto component = [&](const json& value) {
    if (!value.is_number()) expected(wanted);
    const auto result = value.get<double>();
    if (!(result >= 0 && result <= most)) expected(wanted);
    return result;
  };
  if (value_.is_number()) {
    const double grey = component(value_);
    return {grey, grey, grey};
  }
  if (!value_.is_array() || value_.size() != 3) expected(wanted);
  return {component(value_[0]), component(value_[1]), component(value_[2])};
}

}  // namespace tetprep
