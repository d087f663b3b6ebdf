// SPDX-License-Identifier: AGPL-3.0-or-later
// Small surfaces and files for the converter's tests.
#pragma once

#include <gtest/gtest.h>

#include <filesystem>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "prep/prep.hpp"

namespace tetprep_test {

using tetprep::Index;
using tetprep::TriangleSoup;

/// A folder that is empty at the start of each test and gone at its end.
class FolderTest : public ::testing::Test {
 protected:
  void SetUp() override;
  void TearDown() override;
  std::string path(const std::string& name) const { return (folder_ / name).string(); }
  std::string write(const std::string& name, std::string_view bytes) const;
  std::string read(const std::string& name) const;
  /// Names of what is in the folder, hidden files too.
  std::vector<std::string> listing() const;

 private:
  std::filesystem::path folder_;
};

/// The Failure that `work` ends in. Fails the test if it ends in anything else, or if the message is not one
/// line.
tetprep::Failure failure_of(const std::function<void()>& work);

/// True if all of `parts` are in `text`.
::testing::AssertionResult mentions(const std::string& text, const std::vector<std::string>& parts);

/// Twelve triangles that point outward.
TriangleSoup cube(const std::array<double, 3>& low, double edge);
/// `a` and then `b`.
TriangleSoup join(TriangleSoup a, const TriangleSoup& b);
TriangleSoup moved(TriangleSoup soup, const std::array<double, 3>& by);
/// An icosphere-like closed surface: the cube's sides cut into n x n squares and pushed onto the unit sphere.
TriangleSoup ball(int n);
/// As an OBJ file, exact.
std::string as_obj(const TriangleSoup& soup);

/// Everything that tetrahedralize() promises, checked without its own checks.
void expect_sound(const tetprep::CleanSurface& surface, const tetprep::TetMesh& mesh);

/// tetrahedralize() with defaults. A surface that must not change is expected not to.
tetprep::TetMesh fill(const tetprep::CleanSurface& surface, tetprep::TetrahedralizeReport* report = nullptr);
tetprep::TetMesh fill(tetprep::CleanSurface& surface, tetprep::TetrahedralizeReport* report = nullptr);

}  // namespace tetprep_test
