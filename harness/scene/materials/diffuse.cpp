// Lambertian reflection.
#include "harness/scene/material_kind.h"
#include "harness/scene/scene_texture.h"

namespace pt {

MaterialKind kind_of_diffuse() {
    MaterialKind kind;
    kind.read = [](const JsonValue& value) {
        const JsonObject object(value, {"type", "albedo", "emission", "normal"});
        SceneMaterial material;
        material.albedo = read_colour(object.required("albedo"), material);
        read_emission(object, material);
        read_normal_map(object, material);
        return material;
    };
    const auto pack = [](const SceneMaterial&, auto&) {};  // all that kernels need stands in Surface
    kind.pack_single = pack;
    kind.pack_double = pack;
    return kind;
}

}  // namespace pt
