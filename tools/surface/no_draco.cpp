// SPDX-License-Identifier: AGPL-3.0-or-later
// Stands in for prep/draco_surface.cpp in builds without the converter, which alone links Draco.
#include "common/failure.hpp"
#include "prep/draco_surface.hpp"

namespace tetprep {

void decode_draco(std::span<const std::byte>, Appearance&) {
  throw Failure(
      ExitCode::unsupported,
      "DRAC section: this build has no Draco to decode it; configure with -DTETFMT_BUILD_CONVERT=ON");
}

}  // namespace tetprep
