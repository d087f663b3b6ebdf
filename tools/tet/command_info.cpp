// SPDX-License-Identifier: AGPL-3.0-or-later
// `tet info`: what is in a file.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <memory>
#include <nlohmann/json.hpp>

#include "common/output.hpp"
#include "common/parse.hpp"
#include "common/tet_file.hpp"
#include "tet/command.hpp"
#include "tetfmt/attributes.hpp"

namespace tetprep {
namespace {

using Json = nlohmann::ordered_json;
using Point = std::array<double, 3>;

struct InfoOptions {
  std::string file;
  bool json = false;
};

std::string kind_text(tetfmt::SectionKind kind) {
  std::string text;
  for (int i = 0; i < 4; ++i) text += static_cast<char>(static_cast<std::uint32_t>(kind) >> 8 * i & 0xFF);
  return text;
}

Point shifted(const Point& point, const Point& by) {
  return {point[0] + by[0], point[1] + by[1], point[2] + by[2]};
}

Json bounds_json(const Bounds& bounds, const Point& offset) {
  if (bounds.empty()) return nullptr;
  return {{"low", shifted(bounds.low, offset)}, {"high", shifted(bounds.high, offset)}};
}

/// How deep brackets nest, those in strings included: an upper bound.
std::size_t nesting(std::string_view text) {
  std::size_t depth = 0, deepest = 0;
  for (const char c : text) {
    if (c == '[' || c == '{') deepest = std::max(deepest, ++depth);
    if ((c == ']' || c == '}') && depth > 0) --depth;
  }
  return deepest;
}

Json metadata_json(const tetfmt::FileView& view) {
  const auto bytes = view.section(tetfmt::kMetadata);
  if (bytes.empty()) return nullptr;
  const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  // Printing recurses on brackets, so hostile nesting is shown as the text that it is; so is what is no JSON.
  if (nesting(text) > 64) return std::string(text);
  Json parsed = Json::parse(text, nullptr, false);
  return parsed.is_discarded() ? Json(std::string(text)) : parsed;
}

std::array<double, 3> wide(const tetfmt::Vec3f& v) {
  return {v.x, v.y, v.z};
}

Json regions_json(const tetfmt::FileView& view) {
  Json regions = Json::array();
  const Point origin = view.header().origin;
  for (const tetfmt::Region& region : view.regions()) {
    regions.push_back({{"id", region.id},
                       {"first_tet", region.first_tet},
                       {"tets", region.tet_count},
                       {"volume", region.volume},
                       {"low", shifted(wide(region.lower), origin)},
                       {"high", shifted(wide(region.upper), origin)}});
  }
  return regions;
}

Json materials_json(const tetfmt::SurfaceAttributes& attributes) {
  Json materials = Json::array();
  for (const tetfmt::Material& material : attributes.materials) {
    materials.push_back({{"name", attributes.text(material.name)},
                         {"base_color", material.base_color},
                         {"emission", material.emission},
                         {"metallic", material.metallic},
                         {"roughness", material.roughness},
                         {"ior", material.ior},
                         {"transmission", material.transmission},
                         {"base_color_texture", attributes.text(material.base_color_texture)}});
  }
  return materials;
}

Json objects_json(const tetfmt::SurfaceAttributes& attributes) {
  Json objects = Json::array();
  for (const tetfmt::Object& object : attributes.objects)
    objects.push_back({{"name", attributes.text(object.name)}, {"source", attributes.text(object.source)}});
  return objects;
}

Json attributes_json(const tetfmt::FileView& view, const tetfmt::SurfaceAttributes& attributes) {
  constexpr std::array kTypes = {"int8", "uint8", "int16", "uint16", "int32", "uint32", "float32", "float64"};
  Json properties = Json::array();
  for (const tetfmt::Property& property : attributes.properties) {
    properties.push_back(
        {{"name", attributes.text(property.name)},
         {"type", property.type < kTypes.size() ? Json(kTypes[property.type]) : Json(property.type)}});
  }
  const std::size_t of_properties =
      attributes.properties.empty() ? 0 : attributes.property_values.size() / attributes.properties.size();
  return {{"surface_points", std::max({attributes.normals.size(), attributes.texcoords.size(),
                                       attributes.colors.size(), of_properties})},
          {"normals", !attributes.normals.empty()},
          {"texcoords", !attributes.texcoords.empty()},
          {"colors", !attributes.colors.empty()},
          {"properties", properties},
          {"draco_bytes", view.section(tetfmt::kDracoSurface).size()}};
}

Json describe(const TetFile& file) {
  const tetfmt::FileView& view = file.view();
  const tetfmt::FileHeader& header = view.header();
  const auto bytes = view.bytes().size();
  const auto per = [bytes](std::uint64_t count) {
    return count == 0 ? Json(nullptr) : Json(static_cast<double>(bytes) / static_cast<double>(count));
  };
  const auto inputs = view.input_triangles();
  const auto kept = std::count_if(inputs.begin(), inputs.end(),
                                  [](const tetfmt::Triangle& triangle) { return !triangle.dropped(); });
  const auto one_sided = std::count_if(view.sides().begin(), view.sides().end(),
                                       [](const tetfmt::Side& side) { return side.tet == tetfmt::kNone; });
  const tetfmt::SurfaceAttributes attributes(view);
  const Bounds box = vertex_bounds(view), surface = surface_bounds(view);

  Json sections = Json::array();
  for (const tetfmt::SectionEntry& entry : view.sections()) {
    sections.push_back({{"kind", kind_text(entry.kind)},
                        {"count", entry.count},
                        {"stride", entry.stride},
                        {"offset", entry.offset},
                        {"bytes", entry.stored_bytes},
                        {"codec", entry.codec},
                        {"required", (entry.flags & tetfmt::kRequired) != 0}});
  }
  Json sources = Json::array();
  for (const tetfmt::SourceTet& source : view.sources()) {
    if (sources.size() == 8) break;
    sources.push_back({{"tet", source.tet}, {"vertices", source.vertices}});
  }
  return {{"path", file.path()},
          {"format_version", std::to_string(header.major) + "." + std::to_string(header.minor)},
          {"layout", view.layout() == tetfmt::Layout::tet20 ? "tet20" : "tet16"},
          {"bytes", bytes},
          {"tets", header.tet_count},
          {"vertices", header.vertex_count},
          {"input_triangles", inputs.size()},
          {"kept_triangles", kept},
          {"pieces", view.origins().empty() ? Json(nullptr) : Json(view.triangles().size())},
          {"constrained_faces", header.side_count / 2},
          {"partial", view.partial()},
          {"one_sided_faces", one_sided},
          {"hull_faces", header.hull_count},
          {"bytes_per_tet", per(header.tet_count)},
          {"bytes_per_input_triangle", per(inputs.size())},
          {"origin", header.origin},
          {"grid_exponent", header.grid_exponent},
          {"grid_step", std::ldexp(1.0, header.grid_exponent)},
          {"box", {{"local", bounds_json(box, {})}, {"model", bounds_json(box, header.origin)}}},
          {"surface", {{"local", bounds_json(surface, {})}, {"model", bounds_json(surface, header.origin)}}},
          {"regions", regions_json(view)},
          {"materials", materials_json(attributes)},
          {"objects", objects_json(attributes)},
          {"attributes", attributes_json(view, attributes)},
          {"source_count", header.source_count},
          {"sources", sources},
          {"sections", sections},
          {"metadata", metadata_json(view)}};
}

/// 1234567 as "1,234,567".
std::string grouped(std::uint64_t value) {
  std::string text = std::to_string(value);
  for (std::size_t i = text.size(); i > 3;) text.insert(i -= 3, ",");
  return text;
}

std::string rounded(const Json& value, const char* form) {
  if (value.is_null()) return "-";
  std::array<char, 64> text;
  std::snprintf(text.data(), text.size(), form, value.get<double>());
  return text.data();
}

std::string point_text(const Json& point) {
  std::string text;
  for (const Json& value : point) text += (text.empty() ? "" : " ") + number(value.get<double>());
  return text;
}

std::string bounds_text(const Json& bounds) {
  return bounds.is_null() ? "none" : point_text(bounds["low"]) + "  to  " + point_text(bounds["high"]);
}

/// In words: "normals, colours, property quality at 1,234 surface points".
std::string attributes_text(const Json& attributes) {
  std::string text;
  const auto add = [&text](const std::string& what) { text += (text.empty() ? "" : ", ") + what; };
  if (attributes["normals"].get<bool>()) add("normals");
  if (attributes["texcoords"].get<bool>()) add("texture coordinates");
  if (attributes["colors"].get<bool>()) add("colours");
  for (const Json& property : attributes["properties"])
    add("property " + property["name"].get<std::string>() + " (" +
        (property["type"].is_string() ? property["type"].get<std::string>() : "of unknown type") + ")");
  if (!text.empty())
    text += " at " + grouped(attributes["surface_points"].get<std::uint64_t>()) + " surface points";
  if (attributes["draco_bytes"].get<std::uint64_t>() > 0) add("coded by Draco");
  return text.empty() ? "none" : text;
}

std::string material_text(const Json& material) {
  const std::string texture = material["base_color_texture"].get<std::string>();
  return "\"" + material["name"].get<std::string>() + "\"  colour " + point_text(material["base_color"]) +
         (texture.empty() ? "" : ", texture " + texture);
}

std::string object_text(const Json& object) {
  const std::string source = object["source"].get<std::string>();
  return "\"" + object["name"].get<std::string>() + "\"" + (source.empty() ? "" : "  of " + source);
}

/// The first of a list that may be long, one a line.
template <class Line, class TextOf>
void some_lines(const Json& list, const char* name, const Line& line, const TextOf& text_of) {
  constexpr std::size_t kShown = 20;
  for (std::size_t i = 0; i < std::min(list.size(), kShown); ++i)
    line((name + (" " + std::to_string(i))).c_str(), text_of(list[i]));
  if (list.size() > kShown) line("", "... and " + grouped(list.size() - kShown) + " more");
}

void append_regions(std::string& text, const Json& regions) {
  constexpr std::size_t kShown = 20;
  if (regions.empty()) return;
  text += "\nregion            tets           volume  bounds, model\n";
  for (std::size_t i = 0; i < std::min(regions.size(), kShown); ++i) {
    std::array<char, 128> row;
    std::snprintf(row.data(), row.size(), "%-8llu %13s %16.9g  ",
                  static_cast<unsigned long long>(regions[i]["id"].get<std::uint64_t>()),
                  grouped(regions[i]["tets"].get<std::uint64_t>()).c_str(),
                  regions[i]["volume"].get<double>());
    text += row.data() + bounds_text(regions[i]) + "\n";
  }
  if (regions.size() > kShown) text += "... and " + grouped(regions.size() - kShown) + " more\n";
}

std::string text_of(const Json& info) {
  std::string text;
  const auto line = [&](const char* name, const std::string& value) {
    std::string label(name);
    label.resize(std::max<std::size_t>(label.size() + 1, 20), ' ');
    text += label + one_line(value) + "\n";
  };
  const auto count = [&](const char* key) { return grouped(info[key].get<std::uint64_t>()); };
  line("file", info["path"].get<std::string>());
  line("format", info["format_version"].get<std::string>() + ", " + info["layout"].get<std::string>());
  line("size", count("bytes") + " bytes");
  line("tets", count("tets") + "  (" + rounded(info["bytes_per_tet"], "%.2f") + " bytes of file a tet)");
  line("vertices", count("vertices"));
  line("input triangles", count("input_triangles") + "  (" +
                              rounded(info["bytes_per_input_triangle"], "%.1f") +
                              " bytes of file a triangle; " + count("kept_triangles") + " have faces)");
  if (!info["pieces"].is_null()) line("pieces", count("pieces") + "  (triangles were cut where they met)");
  line("constrained faces", count("constrained_faces"));
  if (info["partial"].get<bool>())
    line("one-sided faces", count("one_sided_faces") + "  (the space behind them was left out)");
  line("hull faces", count("hull_faces"));
  line("grid step", number(info["grid_step"].get<double>()) + "  (2^" + info["grid_exponent"].dump() + ")");
  line("origin", point_text(info["origin"]));
  line("surface, model", bounds_text(info["surface"]["model"]));
  line("surface, local", bounds_text(info["surface"]["local"]));
  line("box, model", bounds_text(info["box"]["model"]));
  line("box, local", bounds_text(info["box"]["local"]));
  line("attributes", attributes_text(info["attributes"]));
  some_lines(info["materials"], "material", line, material_text);
  some_lines(info["objects"], "object", line, object_text);
  for (const Json& source : info["sources"]) {
    line("source tet", source["tet"].dump() + "  (vertices " + point_text(source["vertices"]) + ")");
  }
  if (info["sources"].size() < info["source_count"].get<std::size_t>())
    line("", "... " + count("source_count") + " in all");
  if (!info["metadata"].is_null()) {
    line("metadata", info["metadata"].dump(-1, ' ', false, Json::error_handler_t::replace));
  }
  append_regions(text, info["regions"]);
  text += "\nsection        elements  stride           bytes  share\n";
  for (const Json& section : info["sections"]) {
    std::array<char, 128> row;
    const auto stored = section["bytes"].get<std::uint64_t>();
    std::snprintf(row.data(), row.size(), "%-8s %14s %7u %15s %5.1f%%\n",
                  one_line(section["kind"].get<std::string>()).c_str(),
                  grouped(section["count"].get<std::uint64_t>()).c_str(), section["stride"].get<unsigned>(),
                  grouped(stored).c_str(), 100 * static_cast<double>(stored) / info["bytes"].get<double>());
    text += row.data();
  }
  return text;
}

int run_info(const InfoOptions& options) {
  const TetFile file(options.file);
  const Json info = describe(file);
  Output::standard().write(options.json ? info.dump(2, ' ', false, Json::error_handler_t::replace) + "\n"
                                        : text_of(info));
  return 0;
}

}  // namespace

void add_info_command(CLI::App& app, std::function<int()>& run) {
  const auto options = std::make_shared<InfoOptions>();
  CLI::App* verb = app.add_subcommand(
      "info", "What is in a tet file: counts, layout, sections, bounds, bytes per tet and per triangle.");
  verb->add_option("FILE", options->file, "A tet file")->required();
  verb->add_option_function<std::string>(
          "--format", [options](const std::string& name) { options->json = name == "json"; },
          "text: for reading; json: one object with the same facts, lengths in bytes [text]")
      ->check(one_of({"text", "json"}))
      ->type_name("FORMAT");
  verb->footer(
      "Coordinates are in the unit of the input mesh. Local coordinates are model coordinates minus the "
      "origin, and\n"
      "multiples of the grid step. \"surface\" is the input mesh, \"box\" what the tetrahedra fill.\n"
      "Regions are the spaces that surfaces close off from each other, 0 the one around everything; text "
      "lists "
      "the\n"
      "first 20 of them, of materials and of objects, json all. One-sided faces border space that was left "
      "out "
      "of the\n"
      "file (tet convert --keep). Pieces: triangles that met others were cut there; hits name the whole "
      "ones.\n"
      "Only the file's structure is checked; `tet validate` proves the rest.\n"
      "\n"
      "Exit codes: 0 done; 1 usage; 2 the file cannot be read; 3 it is broken or no tet file; 5 it is of a "
      "kind\n"
      "that this version does not know.\n"
      "\n"
      "Examples:\n"
      "  tet info bunny.tet\n"
      "  tet info bunny.tet --format json | jq .bytes_per_tet");
  verb->callback([options, &run] { run = [options] { return run_info(*options); }; });
}

}  // namespace tetprep
