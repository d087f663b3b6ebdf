// SPDX-License-Identifier: AGPL-3.0-or-later
#include "cli/mesh_files.hpp"

#include <cstdio>
#include <cstdlib>
#include <functional>
#include <sstream>

#include "cli/cli_support.hpp"

namespace tetfmt_test {
namespace {

template <class T>
double take(std::istream& in) {
  T value{};
  in.read(reinterpret_cast<char*>(&value), sizeof value);
  return static_cast<double>(value);
}

}  // namespace

Ply read_ply(const std::string& path) {
  static const std::map<std::string, std::function<double(std::istream&)>> kTypes = {
      {"char", take<std::int8_t>},     {"uchar", take<std::uint8_t>}, {"short", take<std::int16_t>},
      {"ushort", take<std::uint16_t>}, {"int", take<std::int32_t>},   {"uint", take<std::uint32_t>},
      {"float", take<float>},          {"double", take<double>}};
  std::istringstream in(read_bytes(path));
  Ply ply;
  std::vector<std::string> order;
  std::string line, format;
  while (std::getline(in, line) && line != "end_header") {
    std::istringstream words(line);
    std::string word, type, name;
    words >> word >> type;
    if (word == "comment") ply.comments.push_back(line.substr(8));
    if (word == "format") format = type;
    if (word == "element") {
      order.push_back(type);
      words >> ply.elements[type].count;
    }
    if (word == "property") {
      if (type == "list") words >> name >> type;  // uchar int
      std::string last;
      words >> last;
      ply.elements[order.back()].properties.emplace_back(name.empty() ? type : "list", last);
    }
  }
  EXPECT_TRUE(format == "ascii" || format == "binary_little_endian") << format;
  const auto value = [&](const std::string& type) {
    if (format != "ascii") return kTypes.at(type)(in);
    std::string word;
    in >> word;
    return type == "float" ? static_cast<double>(std::strtof(word.c_str(), nullptr))
                           : std::strtod(word.c_str(), nullptr);
  };
  for (const std::string& name : order) {
    PlyElement& element = ply.elements[name];
    for (std::size_t i = 0; i < element.count; ++i) {
      for (const auto& [type, property] : element.properties) {
        if (type != "list") {
          element.columns[property].push_back(value(type));
          continue;
        }
        std::vector<double> list(static_cast<std::size_t>(value("uchar")));
        for (double& entry : list) entry = value("int");
        element.lists.push_back(list);
      }
    }
  }
  if (format == "ascii") in >> std::ws;
  EXPECT_EQ(in.good() ? in.peek() : EOF, EOF) << "more than the header says";
  return ply;
}

Obj read_obj(const std::string& path) {
  Obj obj;
  std::istringstream in(read_bytes(path));
  std::string line, material, object;
  while (std::getline(in, line)) {
    std::istringstream words(line);
    std::string keyword;
    words >> keyword;
    const std::string rest = line.size() > keyword.size() ? line.substr(keyword.size() + 1) : "";
    std::vector<double> numbers;
    if (keyword == "v" || keyword == "vt" || keyword == "vn") {
      for (double x = 0; words >> x;) numbers.push_back(x);
      (keyword == "v" ? obj.v : keyword == "vt" ? obj.vt : obj.vn).push_back(numbers);
    } else if (keyword == "f") {
      Obj::Face face{{}, material, object};
      for (std::string word; words >> word;) {
        Obj::Corner corner;
        if (std::sscanf(word.c_str(), "%d/%d/%d", &corner.v, &corner.vt, &corner.vn) == 1)
          std::sscanf(word.c_str(), "%d//%d", &corner.v, &corner.vn);
        face.corners.push_back(corner);
      }
      obj.faces.push_back(face);
    } else if (keyword == "usemtl") {
      material = rest;
    } else if (keyword == "o" || keyword == "g") {
      object = rest;
      obj.grouping += keyword;
    } else if (keyword == "mtllib") {
      obj.library = rest;
    }
  }
  return obj;
}

}  // namespace tetfmt_test
