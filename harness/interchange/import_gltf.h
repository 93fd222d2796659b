// Converts a glTF 2 scene (.gltf, .glb) into a scene file with its meshes as PLY files beside it: cameras, nodes and
// the materials that scene files can express. docs/other_renderers.md tells how each part is read.
#pragma once

#include <string>

#include "harness/interchange/import_result.h"

namespace pt {

ImportResult import_gltf(const ImportSource& source);

// Whether a text looks like glTF; for files whose extension names no format.
bool is_like_gltf(const std::string& text);

}  // namespace pt
