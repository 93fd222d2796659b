// Material kind `principled`: metal, plastic and glass in one, with the parameters of glTF.
#include "harness/scene/materials/glass.h"

namespace pt {

MaterialKind kind_of_principled() {
    MaterialKind kind;
    kind.read = [](const JsonValue& value) {
        const JsonObject object(
            value, {"type", "base_colour", "metallic", "roughness", "transmission", "ior", "emission", "normal"});
        const auto share = [&](const char* key) {
            return object.has(key) ? object.at(key).number(0, 1, "a number from 0 to 1") : 0;
        };
        SceneMaterial material;
        material.albedo = read_colour(object.required("base_colour"), material);
        material.metallic = share("metallic");
        material.roughness = read_roughness(object.required("roughness"), material);
        material.transmission = share("transmission");
        material.ior = object.has("ior") ? object.at("ior").number(1, 1e4, "a number from 1 to 1e4") : 1.5;
        read_emission_and_normal(object, material);
        if (!is_black(material.emission) && material.metallic < 1 && material.transmission > 0) {
            object.at("emission").fail("none, where light passes through: transmission 0 or metallic 1");
        }
        return material;
    };
    kind.set_pack([]<class Real>(const SceneMaterial& m, Material<Real>& packed) {
        packed.principled = {packed_glass<Real>(m), static_cast<Real>(m.metallic), static_cast<Real>(m.transmission),
                             static_cast<Real>(m.roughness * m.roughness)};
        packed.principled.glass.tint = narrow<Real>(m.albedo);
    });
    kind.needs_inside = [](const SceneMaterial& m) { return m.metallic < 1 && m.transmission > 0; };
    // For some directions the throughput grows by up to 32, since rough microfacets over a diffuse base are sampled
    // with the smooth surface's reflectance. On average over directions the factor is at most 1.
    kind.largest_gain = [](const SceneMaterial& m) {
        return m.metallic < 1 && m.transmission < 1 && m.ior != 1 ? 32.0 : 1.0;
    };
    kind.reflects_all_at_grazing = true;
    kind.beyond_mitsuba = [](const SceneMaterial&, std::uint32_t) -> std::vector<BeyondMitsuba> {
        return {{"", "principled",
                 "another material: Mitsuba's has Disney's lobes and this one glTF's, of other formulas"}};
    };
    return kind;
}

}  // namespace pt
