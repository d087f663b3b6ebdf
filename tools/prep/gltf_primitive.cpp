// SPDX-License-Identifier: AGPL-3.0-or-later
#include "prep/gltf_primitive.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>

#include "prep/draco_input.hpp"

namespace tetprep {
namespace {

constexpr const char* kDraco = "KHR_draco_mesh_compression";

/// Values of vertices, wherever they come from.
struct Attribute {
  std::string name;  ///< for messages: "NORMAL (accessors[3])"
  std::size_t components = 0;
  std::function<double(std::size_t vertex, std::size_t k)> at;
};

class PrimitiveReader {
 public:
  PrimitiveReader(const SourceFile& file, const GltfDocument& document, GltfAccessors& accessors,
                  const tinygltf::Primitive& primitive, std::string where, Warnings& warnings)
      : file_(file),
        document_(document),
        accessors_(accessors),
        primitive_(primitive),
        where_(std::move(where)),
        warnings_(warnings) {}

  GltfPrimitive read() {
    result_.material = primitive_.material;
    const int mode = primitive_.mode;
    if (mode < TINYGLTF_MODE_TRIANGLES) {
      warnings_.add(0, where_ + "points or lines: skipped");
      return {};
    }
    if (!primitive_.attributes.contains("POSITION")) {
      warnings_.add(0, where_ + "no positions: skipped");
      return {};
    }
    if (primitive_.extensions.contains(kDraco))
      open_draco();
    else
      open_accessors();
    cut_triangles();
    keep_used_vertices();
    return std::move(result_);
  }

 private:
  [[noreturn]] void fail(const std::string& message) const { file_.fail(0, where_ + message); }

  /// Checks what attribute `name` may be made of.
  void check_components(const Attribute& attribute, std::size_t least, std::size_t most) const {
    if (attribute.components >= least && attribute.components <= most) return;
    fail(attribute.name + " has " + std::to_string(attribute.components) + " components, not " +
         std::to_string(least) + (most > least ? " or " + std::to_string(most) : ""));
  }

  /// `get` gives the attribute of a name.
  template <class Get>
  void take_attributes(const Get& get) {
    for (const auto& [name, number] : primitive_.attributes) {
      if (name == "POSITION") {
        check_components(position_ = get(name, number), 3, 3);
      } else if (name == "NORMAL") {
        check_components(normal_ = get(name, number), 3, 3);
      } else if (name == "TEXCOORD_0") {
        check_components(texcoord_ = get(name, number), 2, 2);
      } else if (name == "COLOR_0") {
        check_components(color_ = get(name, number), 3, 4);
      } else if (name != "TANGENT") {
        warnings_.add(0, where_ + "attribute " + quote(name) + " is left out");
      }
    }
  }

  void open_accessors() {
    const GltfAccessor& positions = accessors_.get(primitive_.attributes.at("POSITION"));
    vertices_ = positions.count();
    take_attributes([&](const std::string& name, int number) {
      const GltfAccessor& accessor = accessors_.get(number);
      if (accessor.count() != vertices_)
        fail(name + " (" + accessor.name() + ") has " + std::to_string(accessor.count()) +
             " elements, but there are " + std::to_string(vertices_) + " positions (" + positions.name() +
             ")");
      return Attribute{name + " (" + accessor.name() + ")", accessor.components(),
                       [&accessor](std::size_t vertex, std::size_t k) { return accessor.at(vertex, k); }};
    });
    if (vertices_ > kMost) file_.unsupported(0, where_ + "more than 2^31 vertices");
    const int number = index_accessor(primitive_);
    if (number < 0) {
      order_.resize(vertices_);
      for (std::size_t i = 0; i < vertices_; ++i) order_[i] = static_cast<Index>(i);
      return;
    }
    const GltfAccessor& indices = accessors_.get(number);
    if (indices.components() != 1 || indices.is_float())
      fail("indices (" + indices.name() + ") are not whole numbers");
    if (indices.count() > kMost) file_.unsupported(0, where_ + "more than 2^31 corners");
    order_.resize(indices.count());
    for (std::size_t i = 0; i < order_.size(); ++i) {
      order_[i] = indices.index_at(i);
      if (order_[i] >= vertices_)
        fail("element " + std::to_string(i) + " of its indices (" + indices.name() + ") is " +
             std::to_string(order_[i]) + ", but there are only " + std::to_string(vertices_) + " vertices");
    }
  }

  void open_draco() {
    const tinygltf::Value& extension = primitive_.extensions.at(kDraco);
    const tinygltf::BufferView& view =
        document_.model.bufferViews[static_cast<std::size_t>(extension.Get("bufferView").GetNumberAsInt())];
    const auto bytes =
        document_.buffers[static_cast<std::size_t>(view.buffer)].subspan(view.byteOffset, view.byteLength);
    mesh_ = decode_draco_mesh(file_, {reinterpret_cast<const char*>(bytes.data()), bytes.size()}, where_);
    vertices_ = mesh_->num_points();
    const tinygltf::Value& ids = extension.Get("attributes");
    take_attributes([&](const std::string& name, int number) {
      if (!ids.Has(name)) fail("attribute " + name + " is not among what Draco compressed");
      const int id = ids.Get(name).GetNumberAsInt();
      const draco::PointAttribute* attribute = mesh_->GetAttributeByUniqueId(static_cast<std::uint32_t>(id));
      if (attribute == nullptr)
        fail("Draco's data has no attribute " + std::to_string(id) + " (" + name + ")");
      const bool fractions = document_.model.accessors[static_cast<std::size_t>(number)].normalized;
      const double scale = fractions ? draco_scale(*attribute) : 1;
      return Attribute{
          name + " (Draco's attribute " + std::to_string(id) + ")",
          static_cast<std::size_t>(attribute->num_components()),
          [this, attribute, scale](std::size_t vertex, std::size_t k) {
            const std::uint32_t row =
                attribute->mapped_index(draco::PointIndex(static_cast<std::uint32_t>(vertex))).value();
            if (row >= attribute->size()) fail("damaged Draco data");
            return draco_row(*attribute, row)[k] / scale;
          }};
    });
    for (draco::FaceIndex face(0); face < mesh_->num_faces(); ++face) {
      for (const draco::PointIndex& corner : mesh_->face(face)) {
        if (corner.value() >= vertices_) fail("damaged Draco data: a corner without a vertex");
        order_.push_back(corner.value());
      }
    }
  }

  /// From `order_` to three corners a triangle; glTF 2.0, section 3.7.2.1.
  void cut_triangles() {
    const std::size_t count = order_.size();
    const int mode = mesh_ ? TINYGLTF_MODE_TRIANGLES : primitive_.mode;  // Draco's data are always triangles
    if (mode == TINYGLTF_MODE_TRIANGLES) {
      if (count % 3 != 0) fail(std::to_string(count) + " corners of triangles, which is no multiple of 3");
      result_.corners = std::move(order_);
      return;
    }
    result_.corners.reserve(count < 3 ? 0 : 3 * (count - 2));
    for (std::size_t i = 0; i + 2 < count; ++i) {
      const std::size_t odd = i % 2;
      if (mode == TINYGLTF_MODE_TRIANGLE_STRIP)
        result_.corners.insert(result_.corners.end(), {order_[i], order_[i + 1 + odd], order_[i + 2 - odd]});
      else
        result_.corners.insert(result_.corners.end(), {order_[i + 1], order_[i + 2], order_[0]});
    }
  }

  /// Primitives often share one long list of vertices, of which each uses a part.
  void keep_used_vertices() {
    std::vector<Index> used;
    if (vertices_ <= 8 * result_.corners.size()) {
      std::vector<Index> number(vertices_, kNone);
      for (const Index corner : result_.corners) number[corner] = 0;
      for (std::size_t i = 0; i < vertices_; ++i) {
        if (number[i] == kNone) continue;
        number[i] = static_cast<Index>(used.size());
        used.push_back(static_cast<Index>(i));
      }
      for (Index& corner : result_.corners) corner = number[corner];
    } else {
      used = result_.corners;
      std::sort(used.begin(), used.end());
      used.erase(std::unique(used.begin(), used.end()), used.end());
      for (Index& corner : result_.corners)
        corner = static_cast<Index>(std::lower_bound(used.begin(), used.end(), corner) - used.begin());
    }
    result_.positions.resize(used.size());
    for (std::size_t i = 0; i < used.size(); ++i) {
      for (std::size_t k = 0; k < 3; ++k) {
        result_.positions[i][k] = position_.at(used[i], k);
        if (!std::isfinite(result_.positions[i][k]))
          fail("element " + std::to_string(used[i]) + " of " + position_.name + " is not finite");
      }
    }
    take_values(used, normal_, result_.normals);
    take_values(used, texcoord_, result_.texcoords);
    take_values(used, color_, result_.colors);
  }

  template <std::size_t N>
  void take_values(const std::vector<Index>& used, const Attribute& attribute,
                   std::vector<std::array<float, N>>& values) {
    if (!attribute.at) return;
    std::size_t unusable = 0;
    values.resize(used.size());
    for (std::size_t i = 0; i < used.size(); ++i) {
      bool finite = true;
      for (std::size_t k = 0; k < N; ++k) {
        values[i][k] = k < attribute.components ? static_cast<float>(attribute.at(used[i], k)) : 1;  // opaque
        finite = finite && std::isfinite(values[i][k]);
      }
      if (finite) continue;
      values[i].fill(std::numeric_limits<float>::quiet_NaN());
      ++unusable;
    }
    if (unusable > 0)
      warnings_.add(0, where_ + std::to_string(unusable) + " elements of " + attribute.name +
                           " are not finite: taken as none");
  }

  static constexpr std::size_t kMost = 0x7FFFFFFE;
  const SourceFile& file_;
  const GltfDocument& document_;
  GltfAccessors& accessors_;
  const tinygltf::Primitive& primitive_;
  std::string where_;
  Warnings& warnings_;

  std::size_t vertices_ = 0;
  Attribute position_, normal_, texcoord_, color_;
  std::vector<Index> order_;  ///< vertices in the order in which the mode takes them
  std::unique_ptr<draco::Mesh> mesh_;
  GltfPrimitive result_;
};

}  // namespace

GltfPrimitive read_primitive(const SourceFile& file, const GltfDocument& document, GltfAccessors& accessors,
                             std::size_t mesh, std::size_t number, Warnings& warnings) {
  const std::string where =
      "meshes[" + std::to_string(mesh) + "].primitives[" + std::to_string(number) + "]: ";
  return PrimitiveReader(file, document, accessors, document.model.meshes[mesh].primitives[number], where,
                         warnings)
      .read();
}

}  // namespace tetprep
