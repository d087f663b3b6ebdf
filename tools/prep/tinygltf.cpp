// SPDX-License-Identifier: AGPL-3.0-or-later
// The packaged glTF parser's code, once. Textures are named, not decoded, and files are opened by
// gltf_document.cpp alone: the parser gets neither an image decoder nor the file system.
#include <fstream>  // which it forgets where it has no file system
#include <sstream>

#define TINYGLTF_IMPLEMENTATION
#include "prep/tinygltf.hpp"
