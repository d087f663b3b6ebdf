// SPDX-License-Identifier: AGPL-3.0-or-later
// JSON held against a published schema.
#pragma once

#include <regex.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace tetfmt_test {

/// The part of JSON Schema 2020-12 that our schemas use. A keyword that is not known here is an error, so a
/// schema cannot outgrow this check unnoticed.
class SchemaChecker {
 public:
  explicit SchemaChecker(nlohmann::json root) : root_(std::move(root)) {}
  std::vector<std::string> errors(const nlohmann::json& value) {
    errors_.clear();
    check(value, root_, "$");
    return errors_;
  }

 private:
  static bool is_type(const nlohmann::json& value, const std::string& type) {
    if (type == "object") return value.is_object();
    if (type == "array") return value.is_array();
    if (type == "string") return value.is_string();
    if (type == "integer") return value.is_number_integer();
    if (type == "number") return value.is_number();
    if (type == "boolean") return value.is_boolean();
    if (type == "null") return value.is_null();
    throw std::runtime_error("unknown type " + type);
  }

  /// By POSIX: GCC warns about std::regex under sanitizers.
  static bool matches(const std::string& pattern, const std::string& text) {
    regex_t compiled;
    if (regcomp(&compiled, pattern.c_str(), REG_EXTENDED | REG_NOSUB) != 0)
      throw std::runtime_error("bad pattern");
    const bool found = regexec(&compiled, text.c_str(), 0, nullptr, 0) == 0;
    regfree(&compiled);
    return found;
  }

  void require(bool holds, const std::string& where, const std::string& what) {
    if (!holds) errors_.push_back(where + ": " + what);
  }

  void check(const nlohmann::json& value, const nlohmann::json& schema, const std::string& where) {
    if (schema.contains("type") && !is_type(value, schema.at("type"))) {
      require(false, where, "type");
      return;  // the other keywords suppose it
    }
    for (const auto& [keyword, rule] : schema.items()) {
      if (keyword.starts_with("$") && keyword != "$ref") continue;
      if (keyword == "title" || keyword == "description" || keyword == "default" || keyword == "type")
        continue;
      if (keyword == "$ref") {
        check(value, root_.at(nlohmann::json::json_pointer(rule.get<std::string>().substr(1))), where);
      } else if (keyword == "const") {
        require(value == rule, where, "const");
      } else if (keyword == "enum") {
        require(std::find(rule.begin(), rule.end(), value) != rule.end(), where, "enum");
      } else if (keyword == "required") {
        for (const nlohmann::json& name : rule)
          require(value.contains(name.get<std::string>()), where, "required " + name.dump());
      } else if (keyword == "properties") {
        for (const auto& [name, member] : value.items()) {
          if (rule.contains(name)) check(member, rule.at(name), where + "." + name);
        }
      } else if (keyword == "additionalProperties") {
        for (const auto& [name, member] : value.items()) {
          if (schema.contains("properties") && schema.at("properties").contains(name)) continue;
          if (rule.is_object()) {
            check(member, rule, where + "." + name);
          } else {
            require(false, where, "unknown member " + name);
          }
        }
      } else if (keyword == "items") {
        for (std::size_t i = 0; i < value.size(); ++i)
          check(value[i], rule, where + "[" + std::to_string(i) + "]");
      } else if (keyword == "minItems") {
        require(value.size() >= rule.get<std::size_t>(), where, keyword);
      } else if (keyword == "maxItems") {
        require(value.size() <= rule.get<std::size_t>(), where, keyword);
      } else if (keyword == "minLength") {
        require(value.get<std::string>().size() >= rule.get<std::size_t>(), where, keyword);
      } else if (keyword == "minimum") {
        require(value.get<double>() >= rule.get<double>(), where, keyword);
      } else if (keyword == "maximum") {
        require(value.get<double>() <= rule.get<double>(), where, keyword);
      } else if (keyword == "pattern") {
        require(matches(rule.get<std::string>(), value.get<std::string>()), where, keyword);
      } else if (keyword == "oneOf") {
        std::size_t fitting = 0;
        for (const nlohmann::json& alternative : rule) {
          SchemaChecker probe(root_);
          probe.check(value, alternative, where);
          fitting += probe.errors_.empty();
        }
        require(fitting == 1, where, keyword);
      } else {
        throw std::runtime_error("unknown keyword " + keyword);
      }
    }
  }

  nlohmann::json root_;
  std::vector<std::string> errors_;
};

}  // namespace tetfmt_test
