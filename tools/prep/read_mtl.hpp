// SPDX-License-Identifier: AGPL-3.0-or-later
// Materials of OBJ files.
#pragma once

#include <map>
#include <string>
#include <string_view>

#include "prep/read_soup.hpp"

namespace tetprep {

/// Materials by name.
using MaterialLibrary = std::map<std::string, Material, std::less<>>;

/// Adds the materials of the MTL file `path`, whose contents are `text`. Never fails: what cannot be
/// understood goes to `warnings` and is left out. A name that the library has already keeps its first
/// material.
///
///   Kd -> base_color, d or 1 - Tr -> its opacity, map_Kd -> base_color_texture, Ke -> emission,
///   Pr -> roughness, Pm -> metallic, Ni -> ior.
///   Ns, where there is no Pr -> roughness = (2 / (Ns + 2))^(1/4): a Blinn-Phong exponent n shines like a
///     microfacet surface of alpha^2 = 2 / (n + 2) (Walter et al., EGSR 2007, section 5.2), and
///     alpha = roughness^2 as in glTF.
///   Tf, where illum is 4, 6, 7 or 9 (those let light through) -> transmission = the mean of its three:
///     exporters write "Tf 1 1 1" for opaque materials too.
void read_mtl(const std::string& path, std::string_view text, MaterialLibrary& library, Warnings& warnings);

}  // namespace tetprep
