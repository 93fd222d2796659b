// Turns a glTF 2 scene (.gltf, .glb) into a scene file, with its meshes as PLY files beside it: cameras, nodes, and the
// materials that scene files have. What is read how is in docs/other_renderers.md.
#pragma once

#include <string>

#include "harness/interchange/import_result.h"

namespace pt {

ImportResult import_gltf(const ImportSource& source);

// Whether a text may be glTF, for a file whose ending tells nothing.
bool is_like_gltf(const std::string& text);

}  // namespace pt
