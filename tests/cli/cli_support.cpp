// SPDX-License-Identifier: AGPL-3.0-or-later
#include "cli/cli_support.hpp"

#include <fcntl.h>
#include <stdlib.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <fstream>
#include <iterator>
#include <stdexcept>

#include "tetfmt/encode.hpp"

namespace tetfmt_test {
namespace fs = std::filesystem;
namespace {

/// An unnamed file to redirect a stream from or to: pipes would need both ends served at once.
class Scratch {
 public:
  explicit Scratch(std::string_view contents = {}) : file_(std::tmpfile()) {
    if (file_ == nullptr) throw std::runtime_error("no temporary file");
    if (!contents.empty()) std::fwrite(contents.data(), 1, contents.size(), file_);
    std::rewind(file_);
  }
  ~Scratch() { std::fclose(file_); }
  Scratch(const Scratch&) = delete;
  Scratch& operator=(const Scratch&) = delete;

  int descriptor() const { return fileno(file_); }
  std::string contents() const {
    std::string text;
    std::rewind(file_);
    for (int c = std::fgetc(file_); c != EOF; c = std::fgetc(file_)) text += static_cast<char>(c);
    return text;
  }

 private:
  FILE* file_;
};

RunResult run(std::vector<std::string> command, std::string_view input) {
  const Scratch in(input), out, err;
  std::vector<char*> arguments;
  for (std::string& word : command) arguments.push_back(word.data());
  arguments.push_back(nullptr);
  const pid_t child = fork();
  if (child < 0) throw std::runtime_error("fork failed");
  if (child == 0) {
    dup2(in.descriptor(), 0);
    dup2(out.descriptor(), 1);
    dup2(err.descriptor(), 2);
    execv(arguments[0], arguments.data());
    _exit(127);
  }
  int status = 0;
  waitpid(child, &status, 0);
  return {WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status), out.contents(), err.contents()};
}

}  // namespace

RunResult tet(const std::vector<std::string>& arguments, std::string_view input) {
  std::vector<std::string> command{TET_BINARY};
  command.insert(command.end(), arguments.begin(), arguments.end());
  return run(std::move(command), input);
}

RunResult shell(const std::string& line) {
  setenv("TET", TET_BINARY, 1);
  return run({"/bin/sh", "-c", line}, {});
}

std::string read_bytes(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

void write_bytes(const fs::path& path, std::string_view bytes) {
  std::ofstream file(path, std::ios::binary);
  file.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  if (!file.flush()) throw std::runtime_error("cannot write " + path.string());
}

::testing::AssertionResult is_one_line(const std::string& text, const std::string& speaker,
                                       const std::vector<std::string>& parts) {
  if (std::count(text.begin(), text.end(), '\n') != 1 || text.back() != '\n') {
    return ::testing::AssertionFailure() << "not one line: " << text;
  }
  if (!text.starts_with(speaker + ": "))
    return ::testing::AssertionFailure() << "not from " << speaker << ": " << text;
  for (const std::string& part : parts) {
    if (text.find(part) == std::string::npos)
      return ::testing::AssertionFailure() << "no '" << part << "' in: " << text;
  }
  return ::testing::AssertionSuccess();
}

void CliTest::SetUp() {
  std::string name = ::testing::TempDir() + "tet-cli-XXXXXX";
  ASSERT_NE(mkdtemp(name.data()), nullptr);
  folder_ = name;
  before_ = fs::current_path();
  fs::current_path(folder_);
}

void CliTest::TearDown() {
  fs::current_path(before_);
  fs::remove_all(folder_);
}

std::string CliTest::write_mesh(const std::string& name, const tetfmt::Mesh& mesh, tetfmt::Layout layout) {
  const auto bytes = tetfmt::encode(mesh, layout);
  write_bytes(name, {reinterpret_cast<const char*>(bytes.data()), bytes.size()});
  return name;
}

tetfmt::Mesh CliTest::box_mesh() {
  LatticeOptions options;
  options.low = 2;
  options.origin = {10, 20, 30};
  return lattice_mesh(6, options);
}

std::vector<std::string> CliTest::listing() const {
  std::vector<std::string> names;
  for (const auto& entry : fs::directory_iterator(folder_)) names.push_back(entry.path().filename().string());
  std::sort(names.begin(), names.end());
  return names;
}

}  // namespace tetfmt_test
