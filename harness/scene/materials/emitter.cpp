// Material kind `emitter`: emits light and reflects none.
#include "harness/scene/material_kind.h"

namespace pt {

MaterialKind kind_of_emitter() {
    MaterialKind kind;
    kind.read = [](const JsonValue& value) {
        const JsonObject object(value, {"type", "radiance"});
        SceneMaterial material;
        material.emission = read_radiance(object.required("radiance"));
        return material;
    };
    kind.surface_colour = [](const SceneMaterial& m) { return m.emission; };
    kind.first_hit_albedo = [](const SceneMaterial&, const Vec3d&) { return Vec3d(0.0); };
    return kind;
}

}  // namespace pt
