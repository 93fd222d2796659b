// Meshes whose vertices and triangles stand in the scene file itself: small ones, for tests and for cases that no
// generator makes.
#pragma once

#include <memory>

#include "harness/json_reader.h"
#include "harness/scene/scene.h"

namespace pt {

// "vertices": [[x, y, z], ..], "triangles": [[i, j, k], ..], and "texture_coordinates": [[u, v], ..] and "normals":
// [[x, y, z], ..], one a vertex, or none; as SceneMesh has them where they are asked for. Equal ones are one mesh, as
// long as a scene has it. Throws InputError.
std::shared_ptr<const SceneMesh> read_inline_mesh(const JsonObject& object, bool with_normals);

}  // namespace pt
