// SPDX-License-Identifier: MIT
#include "check_attributes.hpp"

#include <algorithm>
#include <string>

#include "report.hpp"
#include "tetfmt/attributes.hpp"

namespace tetfmt::detail {
namespace {

class Attributes {
 public:
  Attributes(const FileView& view, Report& report)
      : view_(view), attributes_(view), report_(report), inputs_(view.input_triangles().size()) {}

  void run() {
    check_bounds();
    check_origins();
    check_counts();
    check_indices();
    check_texts();
    check_fields();
  }

 private:
  template <class MakeText>
  void add(Code code, std::uint64_t where, MakeText&& make_text) {
    add_issue(report_, code, where, std::forward<MakeText>(make_text));
  }

  /// A section that is there has `expected` elements.
  void demand_count(SectionKind kind, const char* name, std::uint64_t expected, const char* of_what) {
    const SectionEntry* const entry = view_.find(kind);
    if (entry == nullptr || entry->count == expected) return;
    add(Code::attribute_count, entry->offset, [&] {
      return std::string(name) + " has " + str(entry->count) + " elements for " + str(expected) + " " +
             of_what;
    });
  }

  /// A section makes no sense without another.
  void demand_partner(SectionKind kind, const char* name, SectionKind partner, const char* partner_name) {
    const SectionEntry* const entry = view_.find(kind);
    if (entry == nullptr || view_.find(partner) != nullptr) return;
    add(Code::attribute_count, entry->offset,
        [&] { return std::string(name) + " is there without " + partner_name; });
  }

  void check_bounds() {
    const SectionEntry* const entry = view_.find(kSurfaceBounds);
    if (entry == nullptr) return;
    Bounds bounds;
    for (const Triangle& triangle : view_.triangles())
      for (const Index id : triangle.vertices)
        if (id < view_.vertices().size()) bounds.add(view_.vertices()[id]);
    const auto& claimed = *reinterpret_cast<const SurfaceBounds*>(view_.section(kSurfaceBounds).data());
    const bool any = bounds.lower.x <= bounds.upper.x;
    if (!(any && claimed.lower == bounds.lower && claimed.upper == bounds.upper)) {
      add(Code::surface_bounds, entry->offset,
          [] { return std::string("BNDS is not the box around the triangles' corners"); });
    }
  }

  void check_origins() {
    demand_partner(kOrigins, "ORIG", kInputTriangles, "SURF");
    demand_partner(kInputTriangles, "SURF", kOrigins, "ORIG");
    demand_count(kOrigins, "ORIG", view_.triangles().size(), "triangles");
    for (std::size_t i = 0; i < view_.origins().size(); ++i) {
      const Index input = view_.origins()[i];
      if (input >= inputs_) bad_index(i, "ORIG", input, inputs_);
    }
    if (view_.find(kInputTriangles) == nullptr) return;
    const auto vertex_count = static_cast<Index>(view_.vertices().size());
    for (std::size_t i = 0; i < inputs_; ++i) {
      const auto& v = view_.input_triangles()[i].vertices;
      const bool none = v[0] == kNone && v[1] == kNone && v[2] == kNone;
      if (!none && std::max({v[0], v[1], v[2]}) >= vertex_count)
        add(Code::attribute_index, i,
            [&] { return "SURF element " + str(i) + " has a corner that is no vertex"; });
    }
  }

  void check_counts() {
    demand_count(kTriangleObjects, "TOBJ", inputs_, "input triangles");
    demand_partner(kTriangleObjects, "TOBJ", kObjects, "OBJT");
    demand_count(kCorners, "CORN", inputs_, "input triangles");
    if (const SectionEntry* const draco = view_.find(kDracoSurface)) {
      for (const SectionKind kind : {kCorners, kNormals, kTexcoords, kColors, kProperties, kPropertyValues}) {
        if (view_.find(kind) == nullptr) continue;
        add(Code::attribute_count, draco->offset,
            [] { return std::string("DRAC is there together with a section that it stands for"); });
      }
    }
    demand_partner(kPropertyValues, "PVAL", kProperties, "PROP");
    demand_partner(kProperties, "PROP", kPropertyValues, "PVAL");

    // All arrays of surface points have one length.
    const char* first = nullptr;
    const auto points = [&](SectionKind kind, const char* name, std::uint64_t per_point) {
      const SectionEntry* const entry = view_.find(kind);
      if (entry == nullptr) return;
      demand_partner(kind, name, kCorners, "CORN");
      const std::uint64_t count = per_point == 0 ? 0 : entry->count / per_point;
      if (first == nullptr) {
        first = name;
        points_ = count;
      }
      if (entry->count == points_ * per_point) return;
      add(Code::attribute_count, entry->offset, [&] {
        return std::string(name) + " does not hold as many surface points as " + first + ", " + str(points_);
      });
    };
    points(kNormals, "NORM", 1);
    points(kTexcoords, "TEXC", 1);
    points(kColors, "COLR", 1);
    points(kPropertyValues, "PVAL", attributes_.properties.size());
  }

  void bad_index(std::size_t where, const char* name, std::uint64_t index, std::uint64_t count) {
    add(Code::attribute_index, where, [&] {
      return std::string(name) + " element " + str(where) + " is " + str(index) + ", of " + str(count);
    });
  }

  void check_indices() {
    for (std::size_t i = 0; i < attributes_.triangle_objects.size(); ++i) {
      const Index object = attributes_.triangle_objects[i];
      if (object >= attributes_.objects.size()) bad_index(i, "TOBJ", object, attributes_.objects.size());
    }
    for (std::size_t i = 0; i < attributes_.corners.size(); ++i) {
      for (const Index point : attributes_.corners[i])
        if (point != kNone && point >= points_) bad_index(i, "CORN", point, points_);
    }
  }

  void check_text(TextRef ref, std::size_t where, const char* name) {
    if (ref == kNone || ref < texts_.size()) return;
    add(Code::text, where, [&] {
      return std::string(name) + " element " + str(where) + " refers to text " + str(ref) + " of " +
             str(texts_.size()) + " bytes";
    });
  }

  void check_texts() {
    texts_ = view_.section(kTexts);
    if (!texts_.empty() && texts_.back() != std::byte{0})
      add(Code::text, texts_.size() - 1, [] { return std::string("the last text does not end in a zero"); });
    for (std::size_t i = 0; i < attributes_.materials.size(); ++i) {
      check_text(attributes_.materials[i].name, i, "MATL");
      check_text(attributes_.materials[i].base_color_texture, i, "MATL");
    }
    for (std::size_t i = 0; i < attributes_.objects.size(); ++i) {
      check_text(attributes_.objects[i].name, i, "OBJT");
      check_text(attributes_.objects[i].source, i, "OBJT");
    }
    for (std::size_t i = 0; i < attributes_.properties.size(); ++i)
      check_text(attributes_.properties[i].name, i, "PROP");
  }

  void check_fields() {
    for (std::size_t i = 0; i < attributes_.materials.size(); ++i) {
      if (attributes_.materials[i].reserved != decltype(Material::reserved){})
        add(Code::attribute_field, i,
            [&] { return "material " + str(i) + ": the reserved words are not zero"; });
    }
    for (std::size_t i = 0; i < attributes_.properties.size(); ++i) {
      if (attributes_.properties[i].type > static_cast<std::uint32_t>(PropertyType::float64))
        add(Code::attribute_field, i, [&] {
          return "property " + str(i) + " is of the unknown type " + str(attributes_.properties[i].type);
        });
    }
  }

  const FileView& view_;
  const SurfaceAttributes attributes_;
  Report& report_;
  const std::uint64_t inputs_;
  std::uint64_t points_ = 0;
  std::span<const std::byte> texts_;
};

}  // namespace

void check_attributes(const FileView& view, Report& report) {
  Attributes(view, report).run();
}

}  // namespace tetfmt::detail
