// SPDX-License-Identifier: AGPL-3.0-or-later
#include "common/tet_file.hpp"

#include <algorithm>
#include <limits>
#include <utility>

#include "common/failure.hpp"

namespace tetprep {
namespace {

using tetfmt::Code;

[[noreturn]] void refuse(const std::string& path, const tetfmt::Error& error) {
  const std::string what = path + ": " + tetfmt::to_string(error);
  if (is_unsupported(error.code)) throw Failure(ExitCode::unsupported, what + "; a newer `tet` may read it");
  switch (error.code) {
    case Code::cannot_open:  // these two texts begin with the path
      throw Failure(ExitCode::io, error.text + "; check the path and its permissions");
    case Code::not_a_file:
      throw Failure(ExitCode::io, error.text + "; name a tet file");
    case Code::too_short:
    case Code::bad_magic:
      throw Failure(ExitCode::invalid, what + "; surface meshes become tet files by `tet convert`");
    default:
      throw Failure(ExitCode::invalid, what + "; copy or convert it again");
  }
}

tetfmt::MappedFile map(const std::string& path) {
  auto file = tetfmt::MappedFile::open(path);
  if (!file) refuse(path, file.error());
  return std::move(file).value();
}

}  // namespace

bool is_unsupported(Code code) {
  return code == Code::unsupported_major || code == Code::unknown_required_section ||
         code == Code::unsupported_codec;
}

TetFile::TetFile(const std::string& path) : path_(path), file_(map(path)) {
  auto view = tetfmt::FileView::open(file_.bytes());
  if (!view) refuse(path, view.error());
  view_ = *view;
}

Bounds::Bounds() {
  low.fill(std::numeric_limits<double>::infinity());
  high.fill(-std::numeric_limits<double>::infinity());
}

void Bounds::add(const std::array<double, 3>& point) {
  for (std::size_t i = 0; i < 3; ++i) {
    low[i] = std::min(low[i], point[i]);
    high[i] = std::max(high[i], point[i]);
  }
}

Bounds vertex_bounds(const tetfmt::FileView& view) {
  Bounds bounds;
  for (const tetfmt::Vec3f& v : view.vertices()) {
    if (std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z)) bounds.add({v.x, v.y, v.z});
  }
  return bounds;
}

Bounds surface_bounds(const tetfmt::FileView& view) {
  Bounds bounds;
  for_each_surface_corner(view, [&](const std::array<double, 3>& corner) { bounds.add(corner); });
  return bounds;
}

}  // namespace tetprep
