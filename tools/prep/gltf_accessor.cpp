// SPDX-License-Identifier: AGPL-3.0-or-later
#include "prep/gltf_accessor.hpp"

#include <algorithm>
#include <cstring>

namespace tetprep {
namespace {

template <class T>
T load(const std::byte* place) {
  T value{};
  std::memcpy(&value, place, sizeof value);
  return value;
}

/// A whole number by its glTF type.
double load_whole(const std::byte* place, int type) {
  switch (type) {
    case TINYGLTF_COMPONENT_TYPE_BYTE:
      return load<std::int8_t>(place);
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE:
      return load<std::uint8_t>(place);
    case TINYGLTF_COMPONENT_TYPE_SHORT:
      return load<std::int16_t>(place);
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT:
      return load<std::uint16_t>(place);
    default:
      return load<std::uint32_t>(place);
  }
}

}  // namespace

GltfAccessor::GltfAccessor(const SourceFile& file, const GltfDocument& document, int number)
    : file_(file), document_(document), name_("accessors[" + std::to_string(number) + "]") {
  const tinygltf::Accessor& accessor = document.model.accessors[static_cast<std::size_t>(number)];
  count_ = accessor.count;
  type_ = accessor.componentType;
  normalized_ = accessor.normalized;
  components_ =
      static_cast<std::size_t>(tinygltf::GetNumComponentsInType(static_cast<std::uint32_t>(accessor.type)));
  component_bytes_ =
      static_cast<std::size_t>(tinygltf::GetComponentSizeInBytes(static_cast<std::uint32_t>(type_)));
  const std::size_t size = components_ * component_bytes_;
  if (accessor.bufferView >= 0) {
    const std::size_t stride =
        document.model.bufferViews[static_cast<std::size_t>(accessor.bufferView)].byteStride;
    stride_ = stride == 0 ? size : stride;
    if (stride_ < size)
      file.fail(0, name_ + " has elements of " + std::to_string(size) +
                       " bytes, but its buffer view gives them " + std::to_string(stride_));
    bytes_ = view(accessor.bufferView, accessor.byteOffset, stride_, size, count_, "its elements");
  }
  if (!accessor.sparse.isSparse) return;

  const auto& sparse = accessor.sparse;
  if (sparse.indices.componentType == TINYGLTF_COMPONENT_TYPE_FLOAT)
    file.fail(0, name_ + ": sparse indices are not whole numbers");
  const auto replacements = static_cast<std::size_t>(sparse.count);
  const auto index_bytes = static_cast<std::size_t>(
      tinygltf::GetComponentSizeInBytes(static_cast<std::uint32_t>(sparse.indices.componentType)));
  const auto indices = view(sparse.indices.bufferView, static_cast<std::size_t>(sparse.indices.byteOffset),
                            index_bytes, index_bytes, replacements, "its sparse indices");
  const auto values = view(sparse.values.bufferView, static_cast<std::size_t>(sparse.values.byteOffset), size,
                           size, replacements, "its sparse values");
  for (std::size_t i = 0; i < replacements; ++i) {
    const auto element =
        static_cast<std::size_t>(load_whole(indices.data() + i * index_bytes, sparse.indices.componentType));
    if (element >= count_)
      file.fail(0, name_ + ": its sparse part replaces element " + std::to_string(element) + " of " +
                       std::to_string(count_));
    replaced_[element] = values.data() + i * size;
  }
}

bool GltfAccessor::is_float() const {
  return type_ == TINYGLTF_COMPONENT_TYPE_FLOAT;
}

std::span<const std::byte> GltfAccessor::view(int number, std::size_t offset, std::size_t stride,
                                              std::size_t size, std::size_t count, const char* what) const {
  const tinygltf::BufferView& view = document_.model.bufferViews[static_cast<std::size_t>(number)];
  const std::size_t room = view.byteLength;
  // count elements take (count - 1) * stride + size bytes; nothing here may overflow.
  const bool fits = offset <= room &&
                    (count == 0 || (size <= room - offset && (room - offset - size) / stride >= count - 1));
  if (!fits)
    file_.fail(0, name_ + ": " + what + " (" + std::to_string(count) + " from byte " +
                      std::to_string(offset) + " on) reach beyond the " + std::to_string(room) +
                      " bytes of bufferViews[" + std::to_string(number) + "]");
  return document_.buffers[static_cast<std::size_t>(view.buffer)].subspan(view.byteOffset + offset,
                                                                          room - offset);
}

const std::byte* GltfAccessor::place(std::size_t element) const {
  if (!replaced_.empty()) {
    const auto replaced = replaced_.find(element);
    if (replaced != replaced_.end()) return replaced->second;
  }
  return bytes_.empty() ? nullptr : bytes_.data() + element * stride_;
}

double GltfAccessor::at(std::size_t element, std::size_t k) const {
  const std::byte* const place = this->place(element);
  if (place == nullptr) return 0;
  if (is_float()) return static_cast<double>(load<float>(place + k * component_bytes_));
  const double value = load_whole(place + k * component_bytes_, type_);
  if (!normalized_) return value;
  switch (type_) {  // glTF 2.0, section 3.6.2.2
    case TINYGLTF_COMPONENT_TYPE_BYTE:
      return std::max(value / 127, -1.0);
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE:
      return value / 255;
    case TINYGLTF_COMPONENT_TYPE_SHORT:
      return std::max(value / 32767, -1.0);
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT:
      return value / 65535;
    default:
      return value / 4294967295.0;
  }
}

std::uint32_t GltfAccessor::index_at(std::size_t element) const {
  const std::byte* const place = this->place(element);
  return place == nullptr ? 0 : static_cast<std::uint32_t>(load_whole(place, type_));
}

}  // namespace tetprep
