// SPDX-License-Identifier: AGPL-3.0-or-later
#include "common/output.hpp"

#include <unistd.h>

#include <cerrno>
#include <cstring>

#include "common/failure.hpp"

namespace tetprep {

void Output::write(std::string_view data) const {
  while (!data.empty()) {
    const ssize_t written = ::write(descriptor_, data.data(), data.size());
    if (written >= 0) {
      data.remove_prefix(static_cast<std::size_t>(written));
    } else if (errno == EPIPE) {
      throw OutputClosed{};
    } else if (errno != EINTR) {
      throw Failure(ExitCode::io, name_ + ": cannot write: " + std::strerror(errno));
    }
  }
}

std::string one_line(std::string_view text) {
  constexpr const char* kDigits = "0123456789abcdef";
  std::string line;
  line.reserve(text.size());
  for (const char c : text) {
    const auto byte = static_cast<unsigned char>(c);
    if (byte >= 0x20 && byte != 0x7F) {
      line += c;
    } else {
      line += {'\\', 'x', kDigits[byte >> 4], kDigits[byte & 15]};
    }
  }
  return line;
}

}  // namespace tetprep
