// Material kind `mirror`: perfect specular reflection.
#include "harness/scene/material_kind.h"

namespace pt {

MaterialKind kind_of_mirror() {
    MaterialKind kind;
    kind.read = [](const JsonValue& value) {
        const JsonObject object(value, {"type", "reflectance", "emission", "normal"});
        SceneMaterial material;
        material.reflectance = read_colour(object.required("reflectance"), material);
        read_emission_and_normal(object, material);
        return material;
    };
    kind.surface_colour = [](const SceneMaterial& m) { return m.reflectance; };
    kind.even_reflectance = [](const SceneMaterial& m) { return std::optional(m.reflectance); };
    kind.in_mitsuba = [](const SceneMaterial& m) {
        return MitsubaBsdf{MitsubaBsdf::Type::conductor, m.reflectance, m.texture.get()};
    };
    return kind;
}

}  // namespace pt
