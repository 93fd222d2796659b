// Images that a scene's materials show: named in its file, held to what its objects have of coordinates, and part of
// its hash.
#pragma once

#include <memory>
#include <string>

#include "harness/json_reader.h"
#include "harness/scene/scene.h"

namespace pt {

// Reads an image, {"image": NAME}; the name is relative to the scene's file. One of normals may have a "scale" too.
// Throws InputError.
std::shared_ptr<const SceneTexture> read_texture(const JsonValue& value, TexelMeaning meaning);
// The material's key "normal", where it has one. Throws InputError.
void read_normal_map(const JsonObject& object, SceneMaterial& material);
// The largest texel of an image in each channel.
Vec3d largest_texel(const SceneTexture& texture);

// An image needs coordinates, of which the kernels take fractions. Throws InputError; `value`: the object's material.
void check_texture(const JsonValue& value, const SceneMaterial& material, const SceneObject& object,
                   const Scene& scene);
// Throws InputError for images that are too large together.
void check_texels(const Scene& scene, const std::string& file);

// A text that identifies the images of a scene that has any: the hashes of their texels, and of the coordinates of
// meshes that show them.
std::string text_of_textures(const Scene& scene);

}  // namespace pt
