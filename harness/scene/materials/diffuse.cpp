// Material kind `diffuse`: Lambertian reflection.
#include "harness/scene/material_kind.h"

namespace pt {

MaterialKind kind_of_diffuse() {
    MaterialKind kind;
    kind.read = [](const JsonValue& value) {
        const JsonObject object(value, {"type", "albedo", "emission", "normal"});
        SceneMaterial material;
        material.albedo = read_colour(object.required("albedo"), material);
        read_emission_and_normal(object, material);
        return material;
    };
    kind.even_reflectance = [](const SceneMaterial& m) { return std::optional(m.albedo); };
    return kind;
}

}  // namespace pt
