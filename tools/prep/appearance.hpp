// SPDX-License-Identifier: AGPL-3.0-or-later
// What a surface looks like, beyond its shape: materials, objects, and values at its points. Everything is
// kept by input triangle, so that no later stage (snapping, cutting, tetrahedra) has to touch it.
#pragma once

#include <array>
#include <cstddef>
#include <string>
#include <vector>

#include "tetfmt/layout.hpp"
#include "tetfmt/mesh.hpp"

namespace tetprep {

using tetfmt::Index;
using tetfmt::kNone;

/// tetfmt::Material with its texts in place.
struct Material {
  std::string name;
  std::string base_color_texture;  ///< path or URI as the input gives it; empty for none
  tetfmt::Material values;         ///< its TextRefs are not used
};

/// A named part of the input.
struct Object {
  std::string name;    ///< OBJ "o"/"g", glTF node or mesh; empty where the file names none
  std::string source;  ///< the input file's name, without folders
};

/// A further number at each surface point.
struct PointProperty {
  std::string name;
  tetfmt::PropertyType type = tetfmt::PropertyType::float32;
  std::vector<double> values;  ///< of each surface point
};

/// A surface point is one combination of normal, texture coordinates, colour and properties; several of them
/// may lie at one place (at a crease, say). Invariants: every array below is empty or as long as its comment
/// says; every index is in range. "Surface points" are counted by surface_points.
struct Appearance {
  std::vector<Material> materials;       ///< empty: nothing is known
  std::vector<Index> triangle_material;  ///< of each triangle, or empty: all 0
  std::vector<Object> objects;           ///< at least one after read_soup()
  std::vector<Index> triangle_object;    ///< of each triangle, or empty: all 0
  std::size_t surface_points = 0;
  std::vector<std::array<Index, 3>> corners;  ///< of each triangle its surface points, kNone: none; or empty
  std::vector<std::array<float, 3>> normals;  ///< of each surface point, or empty; NaN: this one has none
  std::vector<std::array<float, 2>> texcoords;  ///< likewise
  std::vector<std::array<float, 4>> colors;     ///< likewise; red, green, blue, alpha, 0 to 1
  std::vector<PointProperty> properties;
};

/// How much of an Appearance goes into the file.
enum class KeepAttributes {
  none,     ///< nothing but input triangle numbers: no section at all. Every Side::material must then be 0
  normals,  ///< normals alone (CORN and NORM), no materials either
  all,
};

/// The optional sections (TEXT, MATL, OBJT, TOBJ, CORN, NORM, TEXC, COLR, PROP, PVAL) that hold it, in the
/// order in which the reference writer stores them. Nothing is stored that says nothing: one unnamed object,
/// say. `draco`: DRAC stands for CORN to PVAL, quantised as prep/draco_surface.hpp says. Texts are stored
/// once each, without zero bytes; what is not UTF-8 is taken for Latin-1. O(size). Failure: unsupported (over
/// 4 GiB of texts), runtime (Draco refused).
std::vector<tetfmt::OptionalSection> to_sections(const Appearance& appearance, KeepAttributes keep,
                                                 bool draco = false);

}  // namespace tetprep
