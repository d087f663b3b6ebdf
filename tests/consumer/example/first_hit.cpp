// SPDX-License-Identifier: MIT
// The whole of reading: map a file, prove it, find a point, shoot a ray, and look from where it hits to a
// lamp.
#include <cstdio>

#include "tetfmt/mapped_file.hpp"
#include "tetfmt/traverse.hpp"
#include "tetfmt/validate.hpp"

int main(int argc, char** argv) {
  if (argc != 2) return 1;
  const auto file = tetfmt::MappedFile::open(argv[1]);
  if (!file) {
    std::fprintf(stderr, "%s\n", tetfmt::to_string(file.error()).c_str());
    return 3;
  }
  const auto view = tetfmt::TrustedView::validated(file->bytes());
  if (!view) {
    std::fprintf(stderr, "%s\n", tetfmt::to_string(view.error()).c_str());
    return 3;
  }

  const tetfmt::Ray ray{{1, 1, 3}, {0, 0, -0.5F}};
  const tetfmt::Location start = tetfmt::locate(*view, ray.origin);
  const tetfmt::Hit hit = tetfmt::first_hit(*view, start, ray.direction);
  if (hit.outcome == tetfmt::Outcome::hit) {
    std::printf("triangle %u at t = %g, seen from its %s\n", hit.triangle, hit.t,
                hit.back ? "back" : "front");
    const tetfmt::Location here = tetfmt::near_side(*view, hit);  // exactly on the surface: no offset
    const tetfmt::Location lamp = tetfmt::locate(*view, {2, 1.5F, 3});
    std::puts(tetfmt::occlusion(*view, here, lamp) == tetfmt::Outcome::miss ? "lit" : "in shadow");
  } else {
    std::puts("nothing there");
  }
  return 0;
}
