// SPDX-License-Identifier: AGPL-3.0-or-later
// glTF 2.0, as .gltf and .glb: the triangles of a scene in the scene's own coordinates.
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include "prep/draco_input.hpp"
#include "prep/gltf_primitive.hpp"

namespace tetprep {
namespace {

/// x -> linear x + translation.
struct Transform {
  std::array<std::array<double, 3>, 3> linear{{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
  Point translation{};

  Point operator()(const Point& p) const {
    Point q = translation;
    for (std::size_t i = 0; i < 3; ++i)
      q[i] += linear[i][0] * p[0] + linear[i][1] * p[1] + linear[i][2] * p[2];
    return q;
  }
  /// This one after `inner`.
  Transform operator*(const Transform& inner) const {
    Transform result;
    for (std::size_t i = 0; i < 3; ++i)
      for (std::size_t k = 0; k < 3; ++k)
        result.linear[i][k] = linear[i][0] * inner.linear[0][k] + linear[i][1] * inner.linear[1][k] +
                              linear[i][2] * inner.linear[2][k];
    result.translation = (*this)(inner.translation);
    return result;
  }
};

double determinant(const std::array<std::array<double, 3>, 3>& m) {
  return m[0][0] * (m[1][1] * m[2][2] - m[1][2] * m[2][1]) -
         m[0][1] * (m[1][0] * m[2][2] - m[1][2] * m[2][0]) +
         m[0][2] * (m[1][0] * m[2][1] - m[1][1] * m[2][0]);
}

/// Directions of normals: the inverse transpose, times the determinant's size (so that a flat map has one
/// too).
std::array<std::array<double, 3>, 3> normal_map(const std::array<std::array<double, 3>, 3>& m) {
  std::array<std::array<double, 3>, 3> result{};
  const double sign = determinant(m) < 0 ? -1 : 1;
  for (std::size_t i = 0; i < 3; ++i) {
    const auto &a = m[(i + 1) % 3], &b = m[(i + 2) % 3];
    for (std::size_t k = 0; k < 3; ++k)
      result[i][k] = sign * (a[(k + 1) % 3] * b[(k + 2) % 3] - a[(k + 2) % 3] * b[(k + 1) % 3]);
  }
  return result;
}

class GltfReader {
 public:
  explicit GltfReader(const SourceFile& file)
      : file_(file),
        warnings_(file.path),
        document_(open_gltf(file, warnings_)),
        model_(document_.model),
        accessors_(file, document_) {}

  PolygonSoup read() {
    walk();
    for (std::size_t i = 0; i < model_.materials.size(); ++i) soup_.materials.push_back(material(i));
    fill_up(soup_.normals);
    fill_up(soup_.texcoords);
    fill_up(soup_.colors);
    if (soup_.ends.empty() && !model_.meshes.empty()) explain_nothing();
    warnings_.append_to(soup_.warnings);
    return std::move(soup_);
  }

 private:
  /// The nodes that a viewer would start from.
  std::vector<int> roots() const {
    std::vector<int> result;
    if (model_.defaultScene >= 0) return model_.scenes[static_cast<std::size_t>(model_.defaultScene)].nodes;
    for (const tinygltf::Scene& scene : model_.scenes)
      for (const int node : scene.nodes)
        if (std::find(result.begin(), result.end(), node) == result.end()) result.push_back(node);
    if (!model_.scenes.empty()) return result;
    std::vector<bool> is_child(model_.nodes.size(), false);
    for (const tinygltf::Node& node : model_.nodes)
      for (const int child : node.children) is_child[static_cast<std::size_t>(child)] = true;
    for (std::size_t i = 0; i < is_child.size(); ++i)
      if (!is_child[i]) result.push_back(static_cast<int>(i));
    if (result.empty() && !model_.nodes.empty()) file_.fail(0, "its nodes have no root: they form a cycle");
    return result;
  }

  /// All nodes below the roots, parents before children, in the file's order; without recursion, because the
  /// file decides how deep they are nested.
  void walk() {
    struct Step {
      int node;
      Transform transform;  ///< of the node's parent, or in `shown` its own
    };
    std::vector<Step> steps, shown;
    const auto push = [&](const std::vector<int>& nodes, const Transform& parent) {
      for (std::size_t i = nodes.size(); i-- > 0;) steps.push_back({nodes[i], parent});
    };
    std::vector<bool> reached(model_.nodes.size(), false);
    push(roots(), {});
    while (!steps.empty()) {
      const Step step = steps.back();
      steps.pop_back();
      const auto number = static_cast<std::size_t>(step.node);
      if (reached[number])
        file_.fail(
            0, "nodes[" + std::to_string(number) + "] is reached twice: a cycle, or a node with two parents");
      reached[number] = true;
      const tinygltf::Node& node = model_.nodes[number];
      const Transform transform = step.transform * local(number);
      if (node.mesh >= 0) {
        for (const GltfPrimitive& primitive : mesh(node.mesh))
          count(shown_corners_, primitive.corners.size());
        shown.push_back({step.node, transform});
      }
      push(node.children, transform);
    }
    for (const Step& step : shown)
      add_mesh(model_.nodes[static_cast<std::size_t>(step.node)], step.transform);
  }

  Transform local(std::size_t number) const {
    const tinygltf::Node& node = model_.nodes[number];
    const auto fail = [&](const char* message) {
      file_.fail(0, "nodes[" + std::to_string(number) + "]" + message);
    };
    Transform result;
    if (!node.matrix.empty()) {  // column by column
      if (node.matrix[3] != 0 || node.matrix[7] != 0 || node.matrix[11] != 0 || node.matrix[15] != 1)
        fail(".matrix is not affine: its last row must be 0 0 0 1");
      for (std::size_t i = 0; i < 3; ++i) {
        for (std::size_t k = 0; k < 3; ++k) result.linear[i][k] = node.matrix[4 * k + i];
        result.translation[i] = node.matrix[12 + i];
      }
      return result;
    }
    if (!node.rotation.empty()) {
      double x = node.rotation[0], y = node.rotation[1], z = node.rotation[2], w = node.rotation[3];
      const double length = std::sqrt(x * x + y * y + z * z + w * w);
      if (!(length > 0) || !std::isfinite(length)) fail(".rotation is no quaternion that rotates");
      x /= length, y /= length, z /= length, w /= length;
      result.linear = {{{1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)},
                        {2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)},
                        {2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)}}};
    }
    if (!node.scale.empty())
      for (auto& row : result.linear)
        for (std::size_t k = 0; k < 3; ++k) row[k] *= node.scale[k];
    if (!node.translation.empty()) std::copy_n(node.translation.begin(), 3, result.translation.begin());
    return result;
  }

  const std::vector<GltfPrimitive>& mesh(int number) {
    const auto [place, is_new] = meshes_.try_emplace(number);
    if (is_new) {
      const auto mesh = static_cast<std::size_t>(number);
      for (std::size_t i = 0; i < model_.meshes[mesh].primitives.size(); ++i) {
        place->second.push_back(read_primitive(file_, document_, accessors_, mesh, i, warnings_));
        count(decoded_corners_, place->second.back().corners.size());
      }
    }
    return place->second;
  }

  /// Primitives may share accessors, and nodes meshes: a small file can ask for any number of triangles.
  void count(std::size_t& corners, std::size_t more) const {
    constexpr std::size_t kMost = std::size_t{3} << 26;
    corners += more;
    if (corners > kMost)
      file_.unsupported(0, "asks for more than 2^26 triangles, counted as often as they are shown");
  }

  void add_mesh(const tinygltf::Node& node, const Transform& transform) {
    const std::size_t before = soup_.ends.size();
    for (const GltfPrimitive& primitive : mesh(node.mesh)) add_primitive(primitive, transform);
    if (soup_.ends.size() == before) return;
    soup_.face_objects.resize(soup_.ends.size(), static_cast<Index>(soup_.objects.size()));
    soup_.objects.push_back(node.name.empty() ? model_.meshes[static_cast<std::size_t>(node.mesh)].name
                                              : node.name);
  }

  void add_primitive(const GltfPrimitive& primitive, const Transform& transform) {
    const std::size_t first = soup_.points.size();
    const bool moved = transform.linear != Transform{}.linear;
    const bool mirrored = determinant(transform.linear) < 0;
    for (const Point& position : primitive.positions) soup_.points.push_back(transform(position));
    for (std::size_t i = 0; i < primitive.corners.size(); i += 3) {
      for (const std::size_t k :
           {std::size_t{0}, std::size_t{mirrored ? 2u : 1u}, std::size_t{mirrored ? 1u : 2u}})
        soup_.corners.push_back(first + primitive.corners[i + k]);
      soup_.ends.push_back(soup_.corners.size());
    }
    soup_.face_materials.resize(soup_.ends.size(),
                                primitive.material < 0 ? kNone : static_cast<Index>(primitive.material));
    append(soup_.texcoords, primitive.texcoords, first);
    append(soup_.colors, primitive.colors, first);
    append(soup_.normals, primitive.normals, first);
    if (!moved || primitive.normals.empty()) return;
    const auto map = normal_map(transform.linear);
    for (std::size_t i = first; i < soup_.points.size(); ++i) turn(soup_.normals.rows[i], map);
  }

  /// Applies `map` to a normal, and makes it a unit vector.
  static void turn(std::array<float, 3>& normal, const std::array<std::array<double, 3>, 3>& map) {
    Point turned{};
    for (std::size_t i = 0; i < 3; ++i)
      for (std::size_t k = 0; k < 3; ++k) turned[i] += map[i][k] * static_cast<double>(normal[k]);
    const double length = std::hypot(turned[0], turned[1], turned[2]);
    for (std::size_t i = 0; i < 3; ++i)
      normal[i] =
          length > 0 ? static_cast<float>(turned[i] / length) : std::numeric_limits<float>::quiet_NaN();
  }

  template <std::size_t N>
  static std::array<float, N> nothing() {
    std::array<float, N> row{};
    row.fill(std::numeric_limits<float>::quiet_NaN());
    return row;
  }
  template <std::size_t N>
  static void append(Channel<std::array<float, N>>& channel, const std::vector<std::array<float, N>>& values,
                     std::size_t first) {
    if (values.empty()) return;
    channel.rows.resize(first, nothing<N>());
    channel.rows.insert(channel.rows.end(), values.begin(), values.end());
  }
  template <std::size_t N>
  void fill_up(Channel<std::array<float, N>>& channel) const {
    if (!channel.rows.empty()) channel.rows.resize(soup_.points.size(), nothing<N>());
  }

  Material material(std::size_t number) const {
    const tinygltf::Material& from = model_.materials[number];
    Material to;
    to.name = from.name;
    for (std::size_t k = 0; k < 4; ++k)
      to.values.base_color[k] = fraction(from.pbrMetallicRoughness.baseColorFactor[k]);
    if (from.alphaMode == "OPAQUE") to.values.base_color[3] = 1;
    to.values.metallic = fraction(from.pbrMetallicRoughness.metallicFactor);
    to.values.roughness = fraction(from.pbrMetallicRoughness.roughnessFactor);
    const double strength = extension(from, "KHR_materials_emissive_strength", "emissiveStrength", 1);
    for (std::size_t k = 0; k < 3; ++k) to.values.emission[k] = magnitude(from.emissiveFactor[k] * strength);
    to.values.ior = magnitude(extension(from, "KHR_materials_ior", "ior", 1.5));
    to.values.transmission = fraction(extension(from, "KHR_materials_transmission", "transmissionFactor", 0));
    const int texture = from.pbrMetallicRoughness.baseColorTexture.index;
    const int image = texture < 0 ? -1 : model_.textures[static_cast<std::size_t>(texture)].source;
    if (image >= 0) to.base_color_texture = document_.images[static_cast<std::size_t>(image)];
    return to;
  }

  static float fraction(double value) { return static_cast<float>(std::clamp(value, 0.0, 1.0)); }

  static float magnitude(double value) {
    return static_cast<float>(std::clamp(value, 0.0, static_cast<double>(std::numeric_limits<float>::max())));
  }

  static double extension(const tinygltf::Material& material, const char* name, const char* field,
                          double otherwise) {
    const auto found = material.extensions.find(name);
    if (found == material.extensions.end() || !found->second.Has(field)) return otherwise;
    return found->second.Get(field).GetNumberAsDouble();
  }

  [[noreturn]] void explain_nothing() const {
    file_.fail(0, meshes_.empty() ? "no node of its scene shows a mesh: there is no surface in it"
                                  : "its scene holds no triangles: there is no surface in it");
  }

  const SourceFile& file_;
  Warnings warnings_;
  GltfDocument document_;
  const tinygltf::Model& model_;
  GltfAccessors accessors_;
  std::map<int, std::vector<GltfPrimitive>> meshes_;
  std::size_t decoded_corners_ = 0, shown_corners_ = 0;
  PolygonSoup soup_;
};

}  // namespace

PolygonSoup read_gltf(const SourceFile& file) {
  // What Draco's data decode to may be any size; what all nodes show is bounded by count().
  const MemoryCeiling ceiling((std::uint64_t{8} << 30) + draco_ceiling(file.text.size()));
  return GltfReader(file).read();
}

}  // namespace tetprep
