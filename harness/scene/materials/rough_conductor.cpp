// Material kind `rough_conductor`: metal with rough microfacets, optionally with multiple scattering.
#include "harness/scene/material_kind.h"

namespace pt {

MaterialKind kind_of_rough_conductor() {
    MaterialKind kind;
    kind.read = [](const JsonValue& value) {
        const JsonObject object(value,
                                {"type", "reflectance", "roughness", "multiple_scattering", "emission", "normal"});
        SceneMaterial material;
        material.reflectance = read_colour(object.required("reflectance"), material);
        material.roughness = read_roughness(object.required("roughness"), material);
        material.multiple_scattering = object.has("multiple_scattering") && object.at("multiple_scattering").boolean();
        read_emission_and_normal(object, material);
        return material;
    };
    kind.extra_features = [](const SceneMaterial& m) {
        return m.multiple_scattering ? no_features | Feature::multiple_scattering : no_features;
    };
    kind.set_pack([]<class Real>(const SceneMaterial& m, Material<Real>& packed) {
        packed.rough_conductor = {narrow<Real>(m.reflectance), static_cast<Real>(m.roughness * m.roughness),
                                  m.multiple_scattering ? 1u : 0u};
    });
    kind.surface_colour = [](const SceneMaterial& m) { return m.reflectance; };
    // With multiple scattering a BSDF sample multiplies the throughput by up to 3.3, but by at most 1 on average.
    kind.largest_gain = [](const SceneMaterial& m) { return m.multiple_scattering ? 16.0 : 1.0; };
    kind.reflects_all_at_grazing = true;
    kind.beyond_mitsuba = rough_facets_beyond_mitsuba;
    return kind;
}

}  // namespace pt
