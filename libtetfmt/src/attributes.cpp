// SPDX-License-Identifier: MIT
#include "tetfmt/attributes.hpp"

namespace tetfmt {
namespace {

template <class T>
std::span<const T> typed(const FileView& view, SectionKind kind) {
  const auto bytes = view.section(kind);
  return {reinterpret_cast<const T*>(bytes.data()), bytes.size() / sizeof(T)};
}

}  // namespace

SurfaceAttributes::SurfaceAttributes(const FileView& view)
    : materials(typed<Material>(view, kMaterials)),
      objects(typed<Object>(view, kObjects)),
      triangle_objects(typed<Index>(view, kTriangleObjects)),
      corners(typed<std::array<Index, 3>>(view, kCorners)),
      normals(typed<std::array<float, 3>>(view, kNormals)),
      texcoords(typed<std::array<float, 2>>(view, kTexcoords)),
      colors(typed<std::array<float, 4>>(view, kColors)),
      properties(typed<Property>(view, kProperties)),
      property_values(typed<double>(view, kPropertyValues)) {
  const auto bytes = view.section(kTexts);
  texts_ = {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

std::string_view SurfaceAttributes::text(TextRef ref) const {
  if (ref >= texts_.size()) return {};
  const std::string_view rest = texts_.substr(ref);
  return rest.substr(0, rest.find('\0'));
}

}  // namespace tetfmt
