// Reads meshes whose vertices and triangles stand in the scene file itself: small ones, for tests and for cases that no
// generator makes.
#pragma once

#include <memory>

#include "harness/json_reader.h"
#include "harness/scene/scene.h"

namespace pt {

// Reads a mesh from the keys "vertices": [[x, y, z], ..], "triangles": [[i, j, k], ..], and optionally
// "texture_coordinates": [[u, v], ..] and "normals": [[x, y, z], ..], one per vertex. SceneMesh has the normals only
// `with_normals`. Equal meshes share one SceneMesh as long as a scene uses it. Throws InputError.
std::shared_ptr<const SceneMesh> read_inline_mesh(const JsonObject& object, bool with_normals);

}  // namespace pt
