// Meshes whose vertices and triangles stand in the scene file itself: small ones, for tests and for cases that no
// generator makes.
#pragma once

#include <memory>
#include <optional>

#include "harness/json_reader.h"
#include "harness/scene/scene.h"

namespace pt {

// "vertices": [[x, y, z], ..], "triangles": [[i, j, k], ..], and "texture_coordinates": [[u, v], ..], one a vertex, or
// none. Equal ones are one mesh, as long as a scene has it. Throws InputError.
std::shared_ptr<const SceneMesh> read_inline_mesh(const JsonValue& vertices, const JsonValue& triangles,
                                                  const std::optional<JsonValue>& coordinates);

}  // namespace pt
