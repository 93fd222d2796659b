// Textures of a scene's materials: loading them, checking that objects have texture coordinates for them, and hashing.
#pragma once

#include <memory>
#include <string>

#include "harness/json_reader.h"
#include "harness/scene/scene.h"

namespace pt {

// Reads a texture {"image": PATH}, relative to the scene; a normal map may have a "scale". Throws InputError.
std::shared_ptr<const SceneTexture> read_texture(const JsonValue& value, TexelMeaning meaning);
// Reads the optional key "normal" (a normal map) of a material. Throws InputError.
void read_normal_map(const JsonObject& object, SceneMaterial& material);
// The largest value of each colour channel over all texels of a texture.
Vec3d largest_texel(const SceneTexture& texture);

// Throws InputError if an object shows a texture on a mesh without texture coordinates, or with coordinates beyond 1e6,
// of which kernels could not take the fraction. `value`: the object's material in the scene file.
void check_texture(const JsonValue& value, const SceneMaterial& material, const SceneObject& object,
                   const Scene& scene);
// Throws InputError if the textures of a scene have too many texels together.
void check_texels(const Scene& scene, const std::string& file);

// Text that identifies the textures of a scene for its hash: the hashes of their texels, and of the texture coordinates
// and shading normals of meshes that show them.
std::string text_of_textures(const Scene& scene);

}  // namespace pt
