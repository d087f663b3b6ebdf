// SPDX-License-Identifier: AGPL-3.0-or-later
// Surfaces to mesh files, attributes and all.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "surface/read_surface.hpp"

namespace tetprep {

/// The formats that a SurfaceWriter knows, for messages.
inline constexpr const char* kSurfaceEndings = ".ply or .obj";

/// A mesh file in the making. Nothing is at its path (nor, for OBJ, beside it) before write() has ended.
class SurfaceWriter {
 public:
  virtual ~SurfaceWriter() = default;
  /// Returns what the format could not say, one line each. Throws Failure (io).
  virtual std::vector<std::string> write(const SurfaceMesh& mesh) = 0;
};

struct SurfaceWriterOptions {
  bool ascii = false;            ///< PLY as text
  bool input_triangles = false;  ///< the face property input_triangle, PLY only
};

/// The writer for the ending of `path`; made before long work, so that a path that cannot be written is not
/// its last discovery. Throws Failure: usage for another ending, or for an option that the format does not
/// have; io.
///
/// .ply: binary little-endian or text. A vertex for every combination of a place and a surface point:
///   double x y z; float nx ny nz; float s t; uchar red green blue (and alpha, unless it is 1 everywhere), or
///   float if there is a colour that is no multiple of 1/255; and the input's properties in its types (double
///   if a type does not hold all the values). A value that a vertex does not have is nan. Faces:
///   vertex_indices, int material (-1: unknown) and int object if the file knows any, whose names are header
///   comments; int texnumber if materials have textures, which are comments "TextureFile NAME" (MeshLab's
///   way).
/// .obj: v (with colours where the file has them), vt, vn, each value once; o or g by object, usemtl by
///   material, and the materials in a file beside it that ends in .mtl. Names that OBJ could not tell apart
///   get a number.
/// Numbers in text are the shortest that read back as the same double or float.
std::unique_ptr<SurfaceWriter> make_surface_writer(const std::string& path,
                                                   const SurfaceWriterOptions& options);

/// The .mtl beside an .obj; empty for other endings.
std::string material_path(const std::string& path);

}  // namespace tetprep
