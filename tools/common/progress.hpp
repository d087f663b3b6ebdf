// SPDX-License-Identifier: AGPL-3.0-or-later
// How long work tells where it is.
#pragma once

#include <string_view>

namespace tetprep {

/// Receives the stages of long work. The default implementation ignores them.
class Progress {
 public:
  virtual ~Progress() = default;
  /// A new stage begins (and the one before it has ended). `name` is short: "read", "tetrahedralize: facets".
  virtual void stage(std::string_view /*name*/) {}
  /// Share of the current stage that is done, 0 to 1, where it is known.
  virtual void fraction(double /*done*/) {}
};

}  // namespace tetprep
