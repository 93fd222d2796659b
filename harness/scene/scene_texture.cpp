#include "harness/scene/scene_texture.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>

#include "harness/scene/json_lines.h"
#include "variants/fnv1a.h"

namespace pt {

namespace {

// The textures of a material's colour, roughness and normal; null: none.
std::array<const SceneTexture*, 3> images_of(const SceneMaterial& material) {
    return {material.texture.get(), material.roughness_texture.get(), material.normal_texture.get()};
}

}  // namespace

std::shared_ptr<const SceneTexture> read_texture(const JsonValue& value, TexelMeaning meaning) {
    const std::vector<std::string> keys = meaning == TexelMeaning::normal ? std::vector<std::string>{"image", "scale"}
                                                                          : std::vector<std::string>{"image"};
    const JsonValue named = JsonObject(value, keys).required("image");
    auto texture = std::make_shared<SceneTexture>();
    texture->path = named.named_file().string();
    texture->image = read_named_file(
        named, [&](const std::filesystem::path& file) { return read_texture_image(file.string(), meaning); });
    texture->file = named.text();
    const std::vector<Vec3<float>>& texels = texture->image.texels;
    texture->hash = fmt::format("{:016x}", fnv1a_of_bytes(texels.data(), texels.size() * sizeof(Vec3<float>),
                                                          fnv1a_of_bytes(&texture->image.width, 4)));
    return texture;
}

void read_normal_map(const JsonObject& object, SceneMaterial& material) {
    if (!object.has("normal")) {
        return;
    }
    const JsonValue value = object.at("normal");
    material.normal_texture = read_texture(value, TexelMeaning::normal);
    if (value.json().contains("scale")) {
        material.normal_scale =
            JsonObject(value, {"image", "scale"}).at("scale").number(-1000, 1000, "a number from -1000 to 1000");
    }
}

Vec3d largest_texel(const SceneTexture& texture) {
    Vec3d most(0.0);
    for (const Vec3<float>& texel : texture.image.texels) {
        for (int channel = 0; channel < 3; ++channel) {
            most[channel] = std::max(most[channel], static_cast<double>(texel[channel]));
        }
    }
    return most;
}

void check_texture(const JsonValue& value, const SceneMaterial& material, const SceneObject& object,
                   const Scene& scene) {
    if (!shows_images(material) || object.mesh == SceneObject::no_mesh) {
        return;
    }
    const SceneMesh& mesh = *scene.meshes[object.mesh];
    if (mesh.coordinates.empty()) {
        value.fail(
            fmt::format("on the mesh {}, which has no texture coordinates: a material without an image", mesh.source));
    }
    constexpr float largest = 1e6f;
    for (const CornerCoordinates& corners : mesh.coordinates) {
        for (int i = 0; i < 3; ++i) {
            if (!(std::abs(corners.u[i]) <= largest && std::abs(corners.v[i]) <= largest)) {
                value.fail(
                    fmt::format("on the mesh {}, which has the texture coordinates ({}, {}) beyond 1e6: a "
                                "material without an image",
                                mesh.source, corners.u[i], corners.v[i]));
            }
        }
    }
}

void check_texels(const Scene& scene, const std::string& file) {
    std::uint64_t texels = 0;
    for (const SceneMaterial& material : scene.materials) {
        for (const SceneTexture* image : images_of(material)) {
            texels += image != nullptr ? image->image.texels.size() : 0;
        }
    }
    if (texels > most_texels) {
        throw InputError(file, "$.materials", fmt::format("images of {} texels together", texels),
                         fmt::format("at most {}", most_texels));
    }
}

std::string text_of_textures(const Scene& scene) {
    std::string text;
    for (const SceneMaterial& material : scene.materials) {
        for (const SceneTexture* image : images_of(material)) {
            text += image != nullptr ? image->hash : "";
        }
    }
    for (const SceneObject& object : scene.objects) {
        const bool shows = shows_images(scene.materials[object.material]) && object.mesh != SceneObject::no_mesh;
        text += shows ? scene.meshes[object.mesh]->coordinates_hash : "";
        text += object.shading_normals ? scene.meshes[object.mesh]->normals_hash : "";
    }
    return text;
}

}  // namespace pt
