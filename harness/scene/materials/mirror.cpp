// Perfect specular reflection.
#include "harness/scene/material_kind.h"
#include "harness/scene/scene_texture.h"

namespace pt {

MaterialKind kind_of_mirror() {
    MaterialKind kind;
    kind.read = [](const JsonValue& value) {
        const JsonObject object(value, {"type", "reflectance", "emission", "normal"});
        SceneMaterial material;
        material.reflectance = read_colour(object.required("reflectance"), material);
        read_emission(object, material);
        read_normal_map(object, material);
        return material;
    };
    const auto pack = [](const SceneMaterial&, auto&) {};  // all that kernels need stands in Surface
    kind.pack_single = pack;
    kind.pack_double = pack;
    kind.surface_colour = [](const SceneMaterial& m) { return m.reflectance; };
    return kind;
}

}  // namespace pt
