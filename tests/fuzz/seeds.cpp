// SPDX-License-Identifier: AGPL-3.0-or-later
// Writes small files into a folder: what the fuzzer starts to mutate from. All are valid but the last, whose
// references lead in circles.
#include <cstdio>
#include <fstream>
#include <string>
#include <vector>

#include "format/format_support.hpp"
#include "tetfmt/encode.hpp"

int main(int argc, char** argv) {
  if (argc != 2) {
    std::fputs("usage: fuzz_seeds FOLDER\n", stderr);
    return 1;
  }
  tetfmt_test::LatticeOptions open;
  open.walls = 5;
  using namespace tetfmt_test;
  tetfmt::Mesh circle = two_tets();
  for (std::size_t t = 0; t < 2; ++t)
    for (std::size_t k = 0; k < 4; ++k)
      if (k != 3 * t)
        circle.tets[t].neighbors[k] = static_cast<Index>(1 - t);  // one face is left to the hull
  const std::vector<tetfmt::Mesh> meshes = {
      one_tet(),           lattice_mesh(3),     lattice_mesh(3, open),  room(), attributed_mesh(),
      region_mesh(3, {0}), region_mesh(3, {1}), region_mesh(4, {0, 1}), circle};
  int written = 0;
  for (const tetfmt::Mesh& mesh : meshes) {
    for (const auto layout : {tetfmt::Layout::tet20, tetfmt::Layout::tet16}) {
      const auto bytes = tetfmt::encode(mesh, layout);
      std::ofstream file(std::string(argv[1]) + "/seed" + std::to_string(written++) + ".tet",
                         std::ios::binary);
      file.write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
      if (!file.flush()) {
        std::fputs("fuzz_seeds: cannot write\n", stderr);
        return 2;
      }
    }
  }
  return 0;
}
