// Rough glass.
#include "harness/scene/material_kind.h"
#include "harness/scene/scene_texture.h"

namespace pt {

MaterialKind kind_of_rough_dielectric() {
    MaterialKind kind;
    kind.read = [](const JsonValue& value) {
        const JsonObject object(value, {"type", "ior", "roughness", "tint", "sigma_a", "normal"});
        SceneMaterial material;
        material.ior = read_ior(object.required("ior"));
        material.tint = object.has("tint") ? read_fractions(object.at("tint")) : Vec3d(1.0);
        material.sigma_a = object.has("sigma_a") ? read_sigma(object.at("sigma_a")) : Vec3d(0.0);
        read_normal_map(object, material);
        material.roughness = read_roughness(object.required("roughness"), material);
        return material;
    };
    kind.extra_features = [](const SceneMaterial& m) {
        return is_black(m.sigma_a) ? no_features : no_features | Feature::absorption;
    };
    // However its facets are turned, a boundary between equals bends no light.
    kind.ignores_roughness = [](const SceneMaterial& m) { return m.ior == 1; };
    const auto pack = []<class Real>(const SceneMaterial& m, Material<Real>& packed) {
        packed.rough_dielectric = {packed_glass<Real>(m),
                                   static_cast<Real>(m.ior == 1 ? 0 : m.roughness * m.roughness)};
    };
    kind.pack_single = pack;
    kind.pack_double = pack;
    kind.first_hit_albedo = [](const SceneMaterial& m, const Vec3d&) { return m.tint; };
    kind.needs_inside = [](const SceneMaterial&) { return true; };
    kind.beyond_mitsuba = [](const SceneMaterial&, std::uint32_t) -> std::vector<BeyondMitsuba> {
        return {{"", "rough facets",
                 "another material: Mitsuba masks the facets of each direction on its own, ptbench of both "
                 "together (Heitz 2014)"}};
    };
    return kind;
}

}  // namespace pt
