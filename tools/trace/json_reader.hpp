// SPDX-License-Identifier: AGPL-3.0-or-later
// JSON that people write, read strictly: every complaint names file, place, what is expected and what was
// found.
#pragma once

#include <functional>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "trace/image.hpp"
#include "trace/vector.hpp"

namespace tetprep {

/// A value and the way to it ("$.camera.eye"). All members throw Failure (invalid) if the value is not what
/// they are asked for. Must not outlive the JsonFile that it is from.
class JsonValue {
 public:
  JsonValue(const nlohmann::json& value, const std::string& file, std::string path)
      : value_(value), file_(file), path_(std::move(path)) {}

  /// A reader for each key that may be there.
  using Members = std::vector<std::pair<std::string_view, std::function<void(const JsonValue&)>>>;
  /// Calls the readers of the keys that are there, in the order of `members`. A key that has none is an
  /// error, which suggests the most similar one.
  void read_members(const Members& members) const;
  /// Calls `use` with every key and value of an object, in the order of the keys.
  void each_member(const std::function<void(const std::string&, const JsonValue&)>& use) const;
  /// At least `least` elements.
  std::vector<JsonValue> items(std::size_t least = 0) const;

  double number(double low, double high) const;
  int integer(int low, int high) const;
  bool flag() const;
  /// Not empty.
  std::string text() const;
  /// The position of the text in `choices`.
  std::size_t choice(const std::vector<std::string_view>& choices) const;
  /// Three numbers of size 1e30 at most: their products of three stay finite in double.
  Vec3 vector() const;
  /// A grey level, three linear components from 0 to `most`, or "#rrggbb" as screens show it.
  Rgb color(double most) const;

  /// "FILE: PATH", as messages have it.
  std::string where() const { return file_ + ": " + path_; }

  bool is_object() const { return value_.is_object(); }
  bool is_null() const { return value_.is_null(); }
  bool is_text() const { return value_.is_string(); }

  /// Throws: "FILE: PATH: expected EXPECTED, found VALUE".
  [[noreturn]] void expected(const std::string& what) const;
  /// Throws: "FILE: PATH: PROBLEM".
  [[noreturn]] void refuse(const std::string& problem) const;

 private:
  JsonValue child(const nlohmann::json& value, const std::string& step) const {
    return {value, file_, path_ + step};
  }
  const nlohmann::json& value_;
  const std::string& file_;
  std::string path_;
};

/// A JSON file in memory.
class JsonFile {
 public:
  /// Throws Failure: io if it cannot be read; invalid if it is no JSON, names a key twice, nests deeper than
  /// 64 levels or is larger than 16 MB.
  explicit JsonFile(const std::string& path);
  JsonValue root() const { return {value_, path_, "$"}; }

 private:
  std::string path_;
  nlohmann::json value_;
};

/// The element of `names` that takes the fewest changes of letters to become `wrong`; empty if none is near.
std::string_view nearest_name(std::string_view wrong, const std::vector<std::string_view>& names);

}  // namespace tetprep
