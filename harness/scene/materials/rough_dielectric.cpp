// Material kind `rough_dielectric`: glass with rough microfacets.
#include "harness/scene/materials/glass.h"

namespace pt {

MaterialKind kind_of_rough_dielectric() {
    MaterialKind kind = glass_kind();
    kind.read = [](const JsonValue& value) {
        const JsonObject object(value, {"type", "ior", "roughness", "tint", "sigma_a", "normal"});
        SceneMaterial material = read_glass(object);
        material.roughness = read_roughness(object.required("roughness"), material);
        return material;
    };
    // A boundary between media of equal index bends no light, whatever its roughness.
    kind.ignores_roughness = [](const SceneMaterial& m) { return m.ior == 1; };
    kind.set_pack([]<class Real>(const SceneMaterial& m, Material<Real>& packed) {
        packed.rough_dielectric = {packed_glass<Real>(m),
                                   static_cast<Real>(m.ior == 1 ? 0 : m.roughness * m.roughness)};
    });
    kind.beyond_mitsuba = rough_facets_beyond_mitsuba;
    return kind;
}

}  // namespace pt
