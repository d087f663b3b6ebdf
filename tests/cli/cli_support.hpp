// SPDX-License-Identifier: AGPL-3.0-or-later
// Runs `tet` and looks at everything that comes out of it.
#pragma once

#include <gtest/gtest.h>

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "support/lattice_mesh.hpp"
#include "tetfmt/layout.hpp"

namespace tetfmt_test {

struct RunResult {
  int exit_code = -1;  ///< 128 + signal if a signal ended it
  std::string out, err;
};

/// Runs `tet` with these arguments and this standard input, in the current folder.
RunResult tet(const std::vector<std::string>& arguments, std::string_view input = {});

/// Runs a shell command line; "$TET" is the binary.
RunResult shell(const std::string& line);

std::string read_bytes(const std::filesystem::path& path);
void write_bytes(const std::filesystem::path& path, std::string_view bytes);

/// One message: exactly one line, which begins with `speaker` and mentions every one of `parts`.
::testing::AssertionResult is_one_line(const std::string& text, const std::string& speaker,
                                       const std::vector<std::string>& parts);

/// Each test runs in an empty folder of its own, removed at the end.
class CliTest : public ::testing::Test {
 protected:
  void SetUp() override;
  void TearDown() override;

  /// Writes an encoded mesh and returns its name.
  std::string write_mesh(const std::string& name, const tetfmt::Mesh& mesh,
                         tetfmt::Layout layout = tetfmt::Layout::tet20);
  /// The 6 x 6 x 6 lattice around the inner box [2, 4]^3, shifted by (10, 20, 30).
  static tetfmt::Mesh box_mesh();
  /// What is in the folder, sorted: temporaries show up here.
  std::vector<std::string> listing() const;

 private:
  std::filesystem::path folder_, before_;
};

}  // namespace tetfmt_test
