// SPDX-License-Identifier: MIT
#include "tetfmt/mapped_file.hpp"

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <utility>

namespace tetfmt {

Result<MappedFile> MappedFile::open(const std::string& path) {
  const auto cannot_open = [&] { return Error{Code::cannot_open, 0, path + ": " + std::strerror(errno)}; };
  // Without O_NONBLOCK, opening a named pipe would wait for a writer before it could be refused.
  const int descriptor = ::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK);
  if (descriptor < 0) return cannot_open();
  struct stat status {};
  if (::fstat(descriptor, &status) != 0) {
    const Error error = cannot_open();
    ::close(descriptor);
    return error;
  }
  if (!S_ISREG(status.st_mode)) {
    ::close(descriptor);
    return Error{Code::not_a_file, 0, path + ": not a regular file"};
  }
  MappedFile file;
  if (status.st_size > 0) {
    const auto size = static_cast<std::size_t>(status.st_size);
    void* address = ::mmap(nullptr, size, PROT_READ, MAP_PRIVATE, descriptor, 0);
    if (address == MAP_FAILED) {
      const Error error = cannot_open();
      ::close(descriptor);
      return error;
    }
    file.bytes_ = {static_cast<const std::byte*>(address), size};
  }
  ::close(descriptor);
  return file;
}

MappedFile::MappedFile(MappedFile&& other) noexcept : bytes_(std::exchange(other.bytes_, {})) {}

MappedFile& MappedFile::operator=(MappedFile&& other) noexcept {
  std::swap(bytes_, other.bytes_);
  return *this;
}

MappedFile::~MappedFile() {
  if (!bytes_.empty()) ::munmap(const_cast<std::byte*>(bytes_.data()), bytes_.size());
}

}  // namespace tetfmt
