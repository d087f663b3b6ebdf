// SPDX-License-Identifier: AGPL-3.0-or-later
// Khronos, "glTF 2.0 Specification".
//
// tinygltf fills structures and checks next to nothing: an offset of -4 or of the wrong type is 0 to it, a
// matrix that is none is left out, a list of children with one bad entry is empty, indices are not compared
// with anything, nesting in "extras" recurses, one image that cannot be decoded fails the file, and
// primitives compressed with Draco are refused because their accessors have no data of their own. So the JSON
// is read here first: what the parser gets is a copy that holds the fields we use, and these are as they
// should be.
#include "prep/gltf_document.hpp"

#include <array>
#include <climits>
#include <cmath>
#include <cstring>
#include <nlohmann/json.hpp>
#include <optional>
#include <utility>

namespace tetprep {
namespace {

using nlohmann::json;

constexpr const char* kDraco = "KHR_draco_mesh_compression";

/// One object of the JSON: fields are checked, and go into a copy, one by one.
class Fields {
 public:
  Fields(const SourceFile& file, const json& root, const json& from, std::string path)
      : file_(file), root_(root), from_(from), path_(std::move(path)) {
    if (!from.is_object()) file.fail(0, path_ + " is not an object");
  }

  json copy = json::object();

  [[noreturn]] void fail(const std::string& field, const std::string& message) const {
    file_.fail(0, path_ + (path_.empty() ? "" : ".") + field + " " + message);
  }

  bool has(const char* field) const { return from_.contains(field); }

  /// A whole number from 0 on.
  std::optional<std::uint64_t> count(const char* field, bool required = false,
                                     std::uint64_t most = 1ull << 53) {
    if (missing(field, required)) return std::nullopt;
    const std::uint64_t value = whole(field, from_[field], most);
    copy[field] = value;
    return value;
  }

  /// The position of something in the file's array `array`.
  std::optional<std::size_t> index(const char* field, const char* array, bool required = false) {
    if (missing(field, required)) return std::nullopt;
    const std::size_t value = within(field, from_[field], array);
    copy[field] = value;
    return value;
  }

  void indices(const char* field, const char* array) {
    if (missing(field, false)) return;
    if (!from_[field].is_array()) fail(field, "is not an array");
    json list = json::array();
    for (const json& entry : from_[field]) list.push_back(within(field, entry, array));
    copy[field] = std::move(list);
  }

  /// An object whose fields are all positions in `array`, or whole numbers if it is null.
  void index_map(const char* field, const char* array, bool required) {
    if (missing(field, required)) return;
    if (!from_[field].is_object()) fail(field, "is not an object");
    json map = json::object();
    for (const auto& [key, entry] : from_[field].items()) {
      const std::string place = std::string(field) + "." + quote(key);
      map[key] = array != nullptr ? within(place, entry, array) : whole(place, entry, INT_MAX);
    }
    copy[field] = std::move(map);
  }

  void number(const char* field) {
    if (missing(field, false)) return;
    if (!from_[field].is_number()) fail(field, "is not a number");
    copy[field] = from_[field].get<double>();
  }

  void numbers(const char* field, std::size_t count) {
    if (missing(field, false)) return;
    if (!from_[field].is_array() || from_[field].size() != count)
      fail(field, "is not an array of " + std::to_string(count) + " numbers");
    for (const json& entry : from_[field])
      if (!entry.is_number()) fail(field, "is not an array of " + std::to_string(count) + " numbers");
    copy[field] = from_[field];
  }

  std::string text(const char* field, bool required = false) {
    if (missing(field, required)) return {};
    if (!from_[field].is_string()) fail(field, "is not a string");
    copy[field] = from_[field];
    return from_[field].get<std::string>();
  }

  void flag(const char* field) {
    if (missing(field, false)) return;
    if (!from_[field].is_boolean()) fail(field, "is not true or false");
    copy[field] = from_[field];
  }

  /// An object inside; `work` fills its copy.
  template <class Work>
  void object(const char* field, const Work& work, bool required = false) {
    if (missing(field, required)) return;
    Fields inner(file_, root_, from_[field], path_ + (path_.empty() ? "" : ".") + field);
    work(inner);
    copy[field] = std::move(inner.copy);
  }

  /// An array of objects.
  template <class Work>
  void array(const char* field, const Work& work, bool required = false) {
    if (missing(field, required)) return;
    const std::string place = path_ + (path_.empty() ? "" : ".") + field;
    if (!from_[field].is_array()) file_.fail(0, place + " is not an array");
    json list = json::array();
    for (const json& entry : from_[field]) {
      Fields inner(file_, root_, entry, place + "[" + std::to_string(list.size()) + "]");
      work(inner);
      list.push_back(std::move(inner.copy));
    }
    copy[field] = std::move(list);
  }

  const json& source() const { return from_; }

 private:
  bool missing(const char* field, bool required) const {
    if (from_.contains(field)) return false;
    if (required) fail(field, "is missing");
    return true;
  }

  std::uint64_t whole(const std::string& field, const json& value, std::uint64_t most) const {
    // 1.0 is a whole number too.
    const double number = value.is_number() ? value.get<double>() : -1;
    if (number < 0 || number != std::floor(number))
      fail(field, "is " + shown(value) + ", not a whole number from 0 on");
    if (number > static_cast<double>(most)) fail(field, "is " + shown(value) + ": out of range");
    return static_cast<std::uint64_t>(number);
  }

  std::size_t within(const std::string& field, const json& value, const char* array) const {
    const std::uint64_t number = whole(field, value, 1ull << 53);
    const auto place = root_.find(array);
    const std::size_t known = place == root_.end() || !place->is_array() ? 0 : place->size();
    if (number >= known)
      fail(field,
           "is " + std::to_string(number) + ", but there are only " + std::to_string(known) + " " + array);
    return static_cast<std::size_t>(number);
  }

  static std::string shown(const json& value) {
    if (value.is_array() || value.is_object()) return value.is_array() ? "an array" : "an object";
    return value.is_string() ? quote(value.get_ref<const std::string&>()) : value.dump();
  }

  const SourceFile& file_;
  const json& root_;
  const json& from_;
  std::string path_;
};

/// The two parts of a GLB file, or the whole text and nothing.
std::pair<std::string_view, std::optional<std::string_view>> split(const SourceFile& file) {
  std::string_view rest = file.text;
  if (!rest.starts_with("glTF")) return {rest, std::nullopt};
  const auto word = [&](std::size_t at) {
    std::uint32_t value = 0;
    std::memcpy(&value, rest.data() + at, sizeof value);
    return value;
  };
  constexpr std::uint32_t kJson = 0x4E4F534A, kBin = 0x004E4942;
  if (rest.size() < 20) file.fail(0, "a GLB file that ends in its header: cut short");
  if (word(4) != 2)
    file.unsupported(0, "GLB version " + std::to_string(word(4)) + ": only version 2 is read");
  if (word(8) > rest.size() || word(8) < 20)
    file.fail(0, "a GLB file of " + std::to_string(word(8)) + " bytes by its header, but " +
                     std::to_string(rest.size()) + " in truth: cut short, or damaged");
  rest = rest.substr(12, word(8) - 12);
  std::optional<std::string_view> text, data;
  while (!rest.empty()) {
    if (rest.size() < 8 || word(0) > rest.size() - 8)
      file.fail(0, "a GLB chunk that does not fit into the file: damaged");
    const std::string_view chunk = rest.substr(8, word(0));
    if (!text && word(4) != kJson) file.fail(0, "a GLB file whose first chunk is not JSON");
    if (word(4) == kJson && !text)
      text = chunk;
    else if (word(4) == kBin && !data)
      data = chunk;
    rest.remove_prefix(8 + chunk.size());
  }
  return {*text, data};
}

/// Percent signs of a URI undone.
std::string decode_percent(std::string_view text) {
  std::string result;
  const auto digit = [](char c) {
    return c >= '0' && c <= '9'   ? c - '0'
           : c >= 'a' && c <= 'f' ? c - 'a' + 10
           : c >= 'A' && c <= 'F' ? c - 'A' + 10
                                  : -1;
  };
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (text[i] == '%' && i + 2 < text.size() && digit(text[i + 1]) >= 0 && digit(text[i + 2]) >= 0) {
      result += static_cast<char>(16 * digit(text[i + 1]) + digit(text[i + 2]));
      i += 2;
    } else {
      result += text[i];
    }
  }
  return result;
}

/// RFC 4648, section 4; the padding may be missing. Nothing for what is not base64.
std::optional<std::string> decode_base64(std::string_view text) {
  static constexpr auto kDigits = [] {
    std::array<signed char, 256> table{};
    table.fill(-1);
    const std::string_view digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    for (std::size_t i = 0; i < digits.size(); ++i)
      table[static_cast<unsigned char>(digits[i])] = static_cast<signed char>(i);
    return table;
  }();
  while (!text.empty() && text.back() == '=') text.remove_suffix(1);
  if (text.size() % 4 == 1) return std::nullopt;
  std::string result;
  result.reserve(text.size() / 4 * 3 + 2);
  std::uint32_t bits = 0;
  int count = 0;
  for (const char c : text) {
    const int digit = kDigits[static_cast<unsigned char>(c)];
    if (digit < 0) return std::nullopt;
    bits = bits << 6 | static_cast<std::uint32_t>(digit);
    if ((count += 6) < 8) continue;
    count -= 8;
    result += static_cast<char>(bits >> count & 0xFF);
  }
  return result;
}

class Opener {
 public:
  Opener(const SourceFile& file, Warnings& warnings) : file_(file), warnings_(warnings) {}

  GltfDocument open() {
    const auto [text, data] = split(file_);
    json root;
    try {
      root = json::parse(text);
    } catch (const json::exception& error) {
      file_.fail(0, std::string("its JSON cannot be read: ") + error.what());
    }
    if (!root.is_object()) file_.fail(0, "its JSON is not an object");
    Fields fields(file_, root, root, {});
    check_asset(fields);
    check_extensions(root);
    check_buffers(fields, data);
    check_accessors(fields);
    check_meshes(fields);
    check_nodes(fields);
    check_materials(fields);
    fill_model(fields.copy);
    return std::move(document_);
  }

 private:
  void check_asset(Fields& fields) {
    fields.object(
        "asset",
        [&](Fields& asset) {
          const std::string version = asset.text("version", true), least = asset.text("minVersion");
          if (!version.starts_with("2."))
            file_.unsupported(0, "glTF version " + quote(version) + ": only 2 is read");
          if (!least.empty() && least != "2.0") file_.unsupported(0, "needs glTF version " + quote(least));
        },
        true);
  }

  void check_extensions(const json& root) {
    const auto required = root.find("extensionsRequired");
    if (required == root.end()) return;
    if (!required->is_array()) file_.fail(0, "extensionsRequired is not an array");
    for (const json& entry : *required) {
      const std::string name = entry.is_string() ? entry.get<std::string>() : "?";
      // Materials and textures change no triangle.
      const bool harmless = name.starts_with("KHR_materials_") || name.starts_with("KHR_texture_") ||
                            name.starts_with("EXT_texture_") || name == "KHR_lights_punctual" ||
                            name == "KHR_mesh_quantization" || name == kDraco;
      if (!harmless)
        file_.unsupported(0, "requires the extension " + quote(name) +
                                 ", which is not supported: export the file without it");
    }
  }

  void check_buffers(Fields& fields, std::optional<std::string_view> data) {
    std::size_t number = 0;
    fields.array("buffers", [&](Fields& buffer) {
      const std::uint64_t length = *buffer.count("byteLength", true);
      const std::string uri = buffer.text("uri");
      std::span<const std::byte> bytes;
      if (!buffer.has("uri") && number == 0 && data)
        bytes = std::as_bytes(std::span(data->data(), data->size()));
      else if (uri.empty())
        buffer.fail("uri", "is missing, and the file has no data for it");
      else
        bytes = fetch(buffer, uri);
      if (length > bytes.size())
        buffer.fail("byteLength", "is " + std::to_string(length) + ", but there are only " +
                                      std::to_string(bytes.size()) + " bytes: cut short, or damaged");
      document_.buffers.push_back(bytes.first(static_cast<std::size_t>(length)));
      ++number;
    });
    fields.copy.erase("buffers");
    fields.array("bufferViews", [&](Fields& view) {
      const std::size_t buffer = *view.index("buffer", "buffers", true);
      const std::uint64_t offset = view.count("byteOffset").value_or(0),
                          length = *view.count("byteLength", true);
      const std::size_t room = document_.buffers[buffer].size();
      if (offset > room || length > room - offset)
        view.fail("byteLength", "reaches to byte " + std::to_string(offset + length) + " of buffers[" +
                                    std::to_string(buffer) + "], which has only " + std::to_string(room));
      const auto stride = view.count("byteStride");
      if (stride && (*stride > 252 || *stride % 4 != 0))
        view.fail("byteStride", "is " + std::to_string(*stride) + ", not a multiple of 4 up to 252");
      view.copy["buffer"] = buffer;
    });
  }

  std::span<const std::byte> fetch(Fields& buffer, const std::string& uri) {
    if (uri.starts_with("data:")) {
      const auto comma = uri.find(',');
      const std::string_view head = std::string_view(uri).substr(0, comma);
      if (comma == std::string::npos || !head.ends_with(";base64"))
        buffer.fail("uri", "is a data URI, but not in base64");
      auto bytes = decode_base64(std::string_view(uri).substr(comma + 1));
      if (!bytes) buffer.fail("uri", "is a data URI that is not sound base64");
      document_.decoded.push_back(std::move(*bytes));
      return std::as_bytes(std::span(document_.decoded.back()));
    }
    const std::string path = path_beside(file_.path, decode_percent(uri));
    if (path.empty() || uri.find("://") != std::string::npos)
      buffer.fail("uri", "names " + quote(uri) + ", which is outside of the file's folder: not read");
    auto opened = tetfmt::MappedFile::open(path);
    if (!opened)
      throw Failure(ExitCode::io, file_.path + ": names the file " + quote(uri) + ": " + opened.error().text);
    document_.files.push_back(std::move(*opened));
    return document_.files.back().bytes();
  }

  void check_accessors(Fields& fields) {
    fields.array("accessors", [&](Fields& accessor) {
      accessor.index("bufferView", "bufferViews");
      accessor.count("byteOffset");
      component_type(accessor, true);
      accessor.count("count", true);
      const std::string type = accessor.text("type", true);
      if (type != "SCALAR" && type != "VEC2" && type != "VEC3" && type != "VEC4" && !type.starts_with("MAT"))
        accessor.fail("type", "is " + quote(type));
      accessor.flag("normalized");
      accessor.object("sparse", [&](Fields& sparse) {
        sparse.count("count", true, INT_MAX);
        sparse.object(
            "indices",
            [&](Fields& indices) {
              indices.index("bufferView", "bufferViews", true);
              indices.count("byteOffset", false, INT_MAX);
              component_type(indices, true);
            },
            true);
        sparse.object(
            "values",
            [&](Fields& values) {
              values.index("bufferView", "bufferViews", true);
              values.count("byteOffset", false, INT_MAX);
            },
            true);
      });
    });
  }

  static void component_type(Fields& fields, bool required) {
    const auto type = fields.count("componentType", required);
    if (type && (*type < 5120 || *type > 5126 || *type == 5124))
      fields.fail("componentType", "is " + std::to_string(*type) + ", which is none of glTF's");
  }

  void check_meshes(Fields& fields) {
    bool targets = false;
    fields.array("meshes", [&](Fields& mesh) {
      mesh.text("name");
      mesh.array(
          "primitives",
          [&](Fields& primitive) {
            primitive.index_map("attributes", "accessors", true);
            primitive.index("material", "materials");
            const auto mode = primitive.count("mode");
            if (mode && *mode > 6)
              primitive.fail("mode", "is " + std::to_string(*mode) + ", which is none of glTF's");
            if (const auto indices = primitive.index("indices", "accessors")) {
              // tinygltf insists on a view, which neither Draco's indices nor those that are all sparse have.
              primitive.copy["extras"]["indices"] = *indices;
              primitive.copy.erase("indices");
            }
            targets = targets || primitive.has("targets");
            primitive.object("extensions", [&](Fields& extensions) {
              extensions.object(kDraco, [&](Fields& draco) {
                draco.index("bufferView", "bufferViews", true);
                draco.index_map("attributes", nullptr, true);
              });
            });
          },
          true);
    });
    if (targets) warnings_.add(0, "morph targets are left out");
  }

  void check_nodes(Fields& fields) {
    bool skins = false, instances = false;
    fields.array("nodes", [&](Fields& node) {
      node.text("name");
      node.index("mesh", "meshes");
      node.indices("children", "nodes");
      node.numbers("matrix", 16);
      node.numbers("translation", 3);
      node.numbers("rotation", 4);
      node.numbers("scale", 3);
      skins = skins || node.has("skin");
      const auto extensions = node.source().find("extensions");
      instances =
          instances || (extensions != node.source().end() && extensions->contains("EXT_mesh_gpu_instancing"));
    });
    fields.array("scenes", [&](Fields& scene) { scene.indices("nodes", "nodes"); });
    fields.index("scene", "scenes");
    if (skins) warnings_.add(0, "skins are left out: meshes are as they are before any pose");
    if (instances) warnings_.add(0, "EXT_mesh_gpu_instancing is left out: such a mesh is read once");
  }

  void check_materials(Fields& fields) {
    bool maps = false, second = false;
    const auto texture = [&](Fields& info) {
      info.index("index", "textures", true);
      second = second || info.count("texCoord").value_or(0) != 0;
    };
    fields.array("materials", [&](Fields& material) {
      material.text("name");
      material.text("alphaMode");
      material.numbers("emissiveFactor", 3);
      material.object("pbrMetallicRoughness", [&](Fields& pbr) {
        pbr.numbers("baseColorFactor", 4);
        pbr.number("metallicFactor");
        pbr.number("roughnessFactor");
        pbr.object("baseColorTexture", texture);
        maps = maps || pbr.has("metallicRoughnessTexture");
      });
      maps = maps || material.has("emissiveTexture") || material.has("normalTexture") ||
             material.has("occlusionTexture");
      material.object("extensions", [&](Fields& extensions) {
        extensions.object("KHR_materials_transmission", [](Fields& e) { e.number("transmissionFactor"); });
        extensions.object("KHR_materials_ior", [](Fields& e) { e.number("ior"); });
        extensions.object("KHR_materials_emissive_strength", [](Fields& e) { e.number("emissiveStrength"); });
      });
    });
    fields.array("textures", [&](Fields& texture_fields) { texture_fields.index("source", "images"); });
    fields.array("images", [&](Fields& image) {
      const std::string uri = image.text("uri");
      const bool inside = uri.empty() || uri.starts_with("data:");
      document_.images.push_back(inside ? "#/images/" + std::to_string(document_.images.size()) : uri);
      if (!inside) look_for_texture(file_.path, decode_percent(uri), 0, warnings_);
    });
    fields.copy.erase("images");
    if (maps) warnings_.add(0, "textures other than those of base colours are left out");
    if (second)
      warnings_.add(
          0, "a base colour texture uses other texture coordinates than TEXCOORD_0, which alone are kept");
  }

  void fill_model(const json& reduced) {
    const std::string text = reduced.dump();
    if (text.size() > UINT_MAX) file_.unsupported(0, "more than 4 GiB of JSON");
    tinygltf::TinyGLTF parser;
    std::string errors, warnings;
    const bool parsed =
        parser.LoadASCIIFromString(&document_.model, &errors, &warnings, text.data(),
                                   static_cast<unsigned>(text.size()), {}, tinygltf::NO_REQUIRE);
    if (!parsed || !errors.empty()) {
      for (char& c : errors)
        if (c == '\n') c = ' ';
      file_.fail(0, "tinygltf cannot understand it: " + errors);
    }
  }

  const SourceFile& file_;
  Warnings& warnings_;
  GltfDocument document_;
};

}  // namespace

int index_accessor(const tinygltf::Primitive& primitive) {
  return primitive.extras.Has("indices") ? primitive.extras.Get("indices").GetNumberAsInt() : -1;
}

GltfDocument open_gltf(const SourceFile& file, Warnings& warnings) {
  return Opener(file, warnings).open();
}

}  // namespace tetprep
