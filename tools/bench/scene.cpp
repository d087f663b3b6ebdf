// SPDX-License-Identifier: AGPL-3.0-or-later
#include "bench/scene.hpp"

#include <utility>

#include "common/failure.hpp"
#include "common/tet_file.hpp"
#include "tetfmt/encode.hpp"
#include "tetfmt/reconstruct.hpp"

namespace tetbench {
namespace {

using tetprep::ExitCode;
using tetprep::Failure;

tetfmt::MappedFile map(const std::string& path) {
  const tetprep::TetFile checked(path);  // for its messages
  auto file = tetfmt::MappedFile::open(path);
  if (!file) throw Failure(ExitCode::io, tetfmt::to_string(file.error()));
  return std::move(file).value();
}

std::unique_ptr<tetfmt::TrustedView> validated(std::span<const std::byte> bytes, const std::string& name) {
  auto view = tetfmt::TrustedView::validated(bytes);
  if (!view)
    throw Failure(ExitCode::invalid,
                  name + ": " + tetfmt::to_string(view.error()) + "; `tet validate` tells more");
  return std::make_unique<tetfmt::TrustedView>(*view);
}

std::unique_ptr<tetfmt::TrustedView> testable(std::span<const std::byte> bytes, const std::string& path) {
  auto trusted = validated(bytes, path);
  if (trusted->view().partial())
    throw Failure(ExitCode::unsupported, path +
                                             ": leaves space out, about which a surface says nothing; use a "
                                             "file that was converted with --keep all");
  if (trusted->view().sides().empty()) throw Failure(ExitCode::unsupported, path + ": has no surface to hit");
  return trusted;
}

}  // namespace

void Scene::check(const std::string& path) {
  testable(map(path).bytes(), path);
}

Scene::Scene(const std::string& path) : path_(path), file_(map(path)) {
  views_[0] = testable(file_.bytes(), path);
  const tetfmt::FileView& view = views_[0]->view();
  auto mesh = tetfmt::reconstruct(view);
  if (!mesh) throw Failure(ExitCode::invalid, path + ": " + tetfmt::to_string(mesh.error()));
  mesh_ = std::move(mesh).value();
  const bool is_tet20 = view.layout() == tetfmt::Layout::tet20;
  other_ = tetfmt::encode(mesh_, is_tet20 ? tetfmt::Layout::tet16 : tetfmt::Layout::tet20);
  views_[1] = validated(other_, path + " in the other layout");
  reference_ = std::make_unique<ExactReference>(Surface::of(mesh_));
}

}  // namespace tetbench
