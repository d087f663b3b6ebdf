// SPDX-License-Identifier: AGPL-3.0-or-later
#include "surface/write_surface.hpp"

#include <algorithm>
#include <cctype>
#include <set>

#include "common/failure.hpp"
#include "surface/formats.hpp"

namespace tetprep {
namespace {

/// The name's ending in lower case, with its dot.
std::string ending_of(const std::string& path) {
  const auto dot = path.find_last_of("./");
  if (dot == std::string::npos || path[dot] == '/') return {};
  std::string ending = path.substr(dot);
  std::transform(ending.begin(), ending.end(), ending.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return ending;
}

}  // namespace

std::unique_ptr<SurfaceWriter> make_surface_writer(const std::string& path,
                                                   const SurfaceWriterOptions& options) {
  const std::string ending = ending_of(path);
  if (ending == ".ply") return make_ply_writer(path, options);
  if (ending != ".obj")
    throw Failure(ExitCode::usage, "--surface " + path + ": the name must end in " + kSurfaceEndings);
  if (options.ascii) throw Failure(ExitCode::usage, "--ascii is for .ply; OBJ is text anyway");
  if (options.input_triangles)
    throw Failure(ExitCode::usage, "--pieces needs a .ply: OBJ cannot tell which triangle a piece is of");
  return make_obj_writer(path);
}

std::string material_path(const std::string& path) {
  if (ending_of(path) != ".obj") return {};
  return path.substr(0, path.size() - 4) + ".mtl";
}

std::string printable(std::string name) {
  for (char& c : name) {
    const auto byte = static_cast<unsigned char>(c);
    if (byte < 0x20 || byte == 0x7F) c = '_';
  }
  return name;
}

std::vector<std::string> distinct_names(const std::vector<std::string>& names, const std::string& fallback,
                                        std::string_view special, const std::vector<std::string>& taken) {
  std::set<std::string> used(taken.begin(), taken.end());
  std::vector<std::string> distinct;
  for (std::size_t i = 0; i < names.size(); ++i) {
    std::string name = names[i].empty() ? fallback + std::to_string(i) : printable(names[i]);
    for (char& c : name)
      if (special.find(c) != std::string_view::npos) c = '_';
    const std::string first = name;
    for (std::size_t n = 2; !used.insert(name).second; ++n) name = first + "_" + std::to_string(n);
    distinct.push_back(name);
  }
  return distinct;
}

}  // namespace tetprep
