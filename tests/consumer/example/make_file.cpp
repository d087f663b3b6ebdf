// SPDX-License-Identifier: MIT
// The whole of writing: a mesh of two tetrahedra with one triangle of a surface between them, as a file.
#include <cstdio>
#include <fstream>

#include "tetfmt/encode.hpp"

int main(int argc, char** argv) {
  if (argc != 2) return 1;
  tetfmt::Mesh mesh;
  //               0          1          2          3 above    4 below
  mesh.vertices = {{0, 0, 2}, {4, 0, 2}, {0, 4, 2}, {1, 1, 4}, {1, 1, 0}};
  mesh.triangles = {{{0, 1, 2}}};       // its normal points up
  mesh.sides = {{0, 0, 0}, {1, 0, 0}};  // side 0, in front: tet 0; side 1, behind: tet 1
  const tetfmt::Ref hull = tetfmt::kHull;
  mesh.tets = {{{0, 1, 2, 3}, {hull, hull, hull, tetfmt::side_ref(0)}},
               {{0, 1, 2, 4}, {hull, hull, hull, tetfmt::side_ref(1)}}};
  // Every tet must be reachable from a source; a walk may cross the surface from one side to its twin.
  mesh.sources = {0};

  const auto bytes = tetfmt::encode(mesh, tetfmt::Layout::tet20);
  std::ofstream file(argv[1], std::ios::binary);
  file.write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
  return file.flush() ? 0 : 2;
}
