// SPDX-License-Identifier: AGPL-3.0-or-later
#include "sample/write_mesh.hpp"

#include <algorithm>
#include <cctype>
#include <cmath>

#include "common/buffered_file.hpp"
#include "common/failure.hpp"

namespace tetprep {
namespace {

using Writer = BufferedFile;

/// Coordinates are written as doubles, so that readers that keep doubles get this very number too.
double wide(float value) {
  return static_cast<double>(value);
}

void write_obj(const Surface& surface, Writer& out) {
  out.text("# made by tet sample\n");
  for (const auto& p : surface.points)
    out.text("v ").number(wide(p[0])).text(" ").number(wide(p[1])).text(" ").number(wide(p[2])).text("\n");
  for (const auto& t : surface.triangles) {
    out.text("f ").number(t[0] + std::uint64_t{1}).text(" ").number(t[1] + std::uint64_t{1});
    out.text(" ").number(t[2] + std::uint64_t{1}).text("\n");
  }
}

void write_off(const Surface& surface, Writer& out) {
  out.text("OFF\n").number(std::uint64_t{surface.points.size()}).text(" ");
  out.number(std::uint64_t{surface.triangles.size()}).text(" 0\n");
  for (const auto& p : surface.points)
    out.number(wide(p[0])).text(" ").number(wide(p[1])).text(" ").number(wide(p[2])).text("\n");
  for (const auto& t : surface.triangles) {
    out.text("3 ").number(std::uint64_t{t[0]}).text(" ").number(std::uint64_t{t[1]}).text(" ");
    out.number(std::uint64_t{t[2]}).text("\n");
  }
}

void write_ply(const Surface& surface, Writer& out) {
  out.text("ply\nformat binary_little_endian 1.0\ncomment made by tet sample\nelement vertex ");
  out.number(std::uint64_t{surface.points.size()});
  out.text("\nproperty float x\nproperty float y\nproperty float z\nelement face ");
  out.number(std::uint64_t{surface.triangles.size()});
  out.text("\nproperty list uchar int vertex_indices\nend_header\n");
  for (const auto& p : surface.points) out.raw(p);
  for (const auto& t : surface.triangles) out.raw(std::uint8_t{3}).raw(t);
}

void write_stl(const Surface& surface, Writer& out) {
  std::string header = "made by tet sample";  // 80 bytes that must not begin with "solid"
  header.resize(80, ' ');
  out.text(header).raw(static_cast<std::uint32_t>(surface.triangles.size()));
  for (const auto& t : surface.triangles) {
    const auto &a = surface.points[t[0]], &b = surface.points[t[1]], &c = surface.points[t[2]];
    std::array<float, 3> normal{};
    for (std::size_t i = 0; i < 3; ++i) {
      const std::size_t j = (i + 1) % 3, k = (i + 2) % 3;
      normal[i] = (b[j] - a[j]) * (c[k] - a[k]) - (b[k] - a[k]) * (c[j] - a[j]);
    }
    const float length = std::sqrt(normal[0] * normal[0] + normal[1] * normal[1] + normal[2] * normal[2]);
    for (float& component : normal) component = length > 0 ? component / length : 0;
    out.raw(normal).raw(a).raw(b).raw(c).raw(std::uint16_t{0});
  }
}

using Format = void (*)(const Surface&, Writer&);

Format format_of(const std::string& path) {
  const auto dot = path.rfind('.');
  std::string ending = dot == std::string::npos ? "" : path.substr(dot);
  std::transform(ending.begin(), ending.end(), ending.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  if (ending == ".obj") return write_obj;
  if (ending == ".off") return write_off;
  if (ending == ".ply") return write_ply;
  if (ending == ".stl") return write_stl;
  throw Failure(ExitCode::usage, "--output " + path + ": the name must end in " + kMeshEndings);
}

}  // namespace

void check_mesh_ending(const std::string& path) {
  format_of(path);
}

void write_mesh(const Surface& surface, const std::string& path) {
  const Format format = format_of(path);
  Writer out(path);
  format(surface, out);
  out.commit();
}

}  // namespace tetprep
