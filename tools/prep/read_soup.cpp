// SPDX-License-Identifier: AGPL-3.0-or-later
// From a path to triangles: choose the reader by the extension, then check what it says.
#include "prep/read_soup.hpp"

#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <cctype>
#include <exception>
#include <filesystem>
#include <fstream>
#include <new>
#include <system_error>

#include "tetfmt/mapped_file.hpp"

namespace tetprep {

MemoryCeiling::MemoryCeiling(std::uint64_t bytes) {
  rlimit limit{};
  getrlimit(RLIMIT_AS, &limit);
  old_limit_ = limit.rlim_cur;
  std::uint64_t pages = 0;
  if (!(std::ifstream("/proc/self/statm") >> pages)) return;
  limit.rlim_cur = std::min<rlim_t>(old_limit_, pages * static_cast<std::uint64_t>(getpagesize()) + bytes);
  setrlimit(RLIMIT_AS, &limit);
}

MemoryCeiling::~MemoryCeiling() {
  rlimit limit{};
  getrlimit(RLIMIT_AS, &limit);
  limit.rlim_cur = old_limit_;
  setrlimit(RLIMIT_AS, &limit);
}

void SourceFile::fail(std::size_t line, const std::string& message) const {
  throw Failure(ExitCode::invalid, path + (line == 0 ? "" : ":" + std::to_string(line)) + ": " + message);
}

void SourceFile::unsupported(std::size_t line, const std::string& message) const {
  throw Failure(ExitCode::unsupported, path + (line == 0 ? "" : ":" + std::to_string(line)) + ": " + message);
}

void Warnings::add(std::size_t line, const std::string& message) {
  constexpr std::size_t kMost = 20;
  if (++count_ <= kMost)
    kept_.push_back(path_ + (line == 0 ? "" : ":" + std::to_string(line)) + ": " + message);
}

void Warnings::append_to(std::vector<std::string>& list) const {
  list.insert(list.end(), kept_.begin(), kept_.end());
  if (count_ > kept_.size())
    list.push_back(path_ + ": " + std::to_string(count_ - kept_.size()) + " more warnings like these");
}

std::string path_beside(const std::string& path, std::string_view name) {
  std::string relative(name);
  std::replace(relative.begin(), relative.end(), '\\', '/');
  const bool drive = relative.size() > 1 && relative[1] == ':';
  const std::filesystem::path wanted = std::filesystem::path(relative).lexically_normal();
  if (relative.empty() || drive || wanted.is_absolute() || *wanted.begin() == "..") return {};
  if (relative.find('\0') != std::string::npos) return {};
  return (std::filesystem::path(path).parent_path() / wanted).string();
}

void look_for_texture(const std::string& path, std::string_view name, std::size_t line, Warnings& warnings) {
  const std::string beside = path_beside(path, name);
  std::error_code error;
  if (beside.empty())
    warnings.add(line,
                 "texture " + quote(name) + " is outside of this file's folder: named, but not looked for");
  else if (!std::filesystem::is_regular_file(beside, error))
    warnings.add(line, "texture " + quote(name) + " is not there: named all the same");
}

std::string counted(std::string_view what, std::uint64_t number) {
  return std::string(what) + " " + std::to_string(number) + " (counted from 0)";
}

std::string quote(std::string_view word) {
  constexpr std::size_t kLongest = 40;
  std::string text = "\"";
  for (const char c : word.substr(0, kLongest))  // a message is one line, whatever the file holds
    text += static_cast<unsigned char>(c) < ' ' || c == '\x7F' ? '?' : c;
  text += word.size() > kLongest ? "...\"" : "\"";
  return text;
}

namespace {

using Reader = PolygonSoup (*)(const SourceFile&);

Reader reader_for(const std::string& path) {
  std::string extension = std::filesystem::path(path).extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  if (extension == ".obj") return read_obj;
  if (extension == ".off") return read_off;
  if (extension == ".ply") return read_ply;
  if (extension == ".stl") return read_stl;
  if (extension == ".drc") return read_drc;
  if (extension == ".gltf" || extension == ".glb") return read_gltf;
  throw Failure(ExitCode::unsupported, path + ": " +
                                           (extension.empty() ? "no extension" : "extension " + extension) +
                                           " (known: .obj, .off, .ply, .stl, .drc, .gltf, .glb)");
}

/// Editors put a byte order mark before text; to a reader it would be part of the first word. The mark is
/// taken for one only before text: a Draco file's or a binary STL file's first bytes may be anything.
void strip_mark(SourceFile& file, Reader reader) {
  if (reader == read_drc) return;
  const bool stl = reader == read_stl;
  if (!stl && (file.text.starts_with("\xFF\xFE") || file.text.starts_with("\xFE\xFF")))
    file.fail(0, "is text in UTF-16: save it as UTF-8");
  constexpr std::string_view kMark = "\xEF\xBB\xBF";
  if (!file.text.starts_with(kMark) || (stl && !file.text.substr(kMark.size()).starts_with("solid"))) return;
  file.text.remove_prefix(kMark.size());
}

}  // namespace

TriangleSoup read_soup(const std::string& path) {
  const auto opened = tetfmt::MappedFile::open(path);
  if (!opened) throw Failure(ExitCode::io, opened.error().text);
  const std::span<const std::byte> bytes = opened->bytes();
  return parse_soup(path, {reinterpret_cast<const char*>(bytes.data()), bytes.size()});
}

TriangleSoup parse_soup(const std::string& path, std::string_view contents) {
  SourceFile file{path, contents};
  const Reader read = reader_for(path);
  if (contents.empty()) file.fail(0, "the file is empty");
  strip_mark(file, read);
  try {
    return triangulate(file, read(file));
  } catch (const Failure&) {
    throw;
  } catch (const std::bad_alloc&) {
    file.fail(0, "asks for far more memory than its size warrants: damaged, or no mesh");
  } catch (const std::exception& error) {
    file.fail(0, std::string("cannot be understood (") + error.what() + ")");
  }
}

}  // namespace tetprep
