// SPDX-License-Identifier: AGPL-3.0-or-later
#include "prep/debug_mesh.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>

#include "common/atomic_file.hpp"

namespace tetprep {
namespace {

static_assert(std::endian::native == std::endian::little, "the file is written as the machine holds numbers");

template <class T>
void append(std::string& bytes, const T& value) {
  char raw[sizeof value];
  std::memcpy(raw, &value, sizeof value);
  bytes.append(raw, sizeof raw);
}

/// Hands `bytes` on when they have become many: a second copy of the whole file is not needed.
void flush(AtomicFile& file, std::string& bytes, std::size_t least = 1 << 20) {
  if (bytes.size() < least) return;
  file.write(bytes);
  bytes.clear();
}

using Colour = std::array<std::uint8_t, 3>;
constexpr Colour kMarked{220, 30, 30}, kOther{200, 200, 200};

}  // namespace

void write_debug_mesh(const std::string& path, const CleanSurface& surface, std::vector<Index> marked) {
  AtomicFile file(path);
  std::sort(marked.begin(), marked.end());
  marked.erase(std::unique(marked.begin(), marked.end()), marked.end());

  std::string bytes = "ply\nformat binary_little_endian 1.0\ncomment the first " +
                      std::to_string(marked.size()) + " faces are the marked ones\nelement vertex " +
                      std::to_string(surface.points.size()) +
                      "\nproperty double x\nproperty double y\nproperty double z\nelement face " +
                      std::to_string(surface.triangles.size()) +
                      "\nproperty list uchar int vertex_indices\n"
                      "property uchar red\nproperty uchar green\nproperty uchar blue\n"
                      "property uint input_triangle\nend_header\n";
  const double step = std::ldexp(1.0, surface.grid_exponent);
  for (const GridPoint& point : surface.points) {
    for (std::size_t k = 0; k < 3; ++k) append(bytes, surface.origin[k] + point[k] * step);
    flush(file, bytes);
  }
  const auto put = [&](Index t, const Colour& colour) {
    append(bytes, std::uint8_t{3});
    append(bytes, surface.triangles[t]);
    append(bytes, colour);
    append(bytes, surface.input_triangle[t]);
    flush(file, bytes);
  };
  for (const Index t : marked) put(t, kMarked);
  auto next = marked.begin();
  for (Index t = 0; t < surface.triangles.size(); ++t) {
    if (next != marked.end() && *next == t) {
      ++next;
    } else {
      put(t, kOther);
    }
  }
  flush(file, bytes, 0);
  file.commit();
}

}  // namespace tetprep
