// Material kind `subsurface`: a scattering body in which paths make random walks.
#include <fmt/format.h>

#include "harness/scene/material_kind.h"

namespace pt {

MaterialKind kind_of_subsurface() {
    MaterialKind kind;
    kind.read = [](const JsonValue& value) {
        const JsonObject object(value, {"type", "ior", "sigma_a", "sigma_s", "g", "max_scatterings"});
        SceneMaterial material;
        material.ior = object.has("ior") ? read_ior(object.at("ior")) : 1;
        material.sigma_a = object.has("sigma_a") ? read_sigma(object.at("sigma_a")) : Vec3d(0.0);
        material.sigma_s = read_sigma(object.required("sigma_s"));
        material.g = object.has("g") ? object.at("g").number(-0.9999, 0.9999, "a number from -0.9999 to 0.9999") : 0;
        if (object.has("max_scatterings")) {
            material.max_scatterings = static_cast<std::uint32_t>(
                object.at("max_scatterings").whole(1, 1000000000, "a whole number from 1 to 1000000000"));
        }
        return material;
    };
    kind.extra_features = [](const SceneMaterial& m) {
        return m.ior == 1 ? no_features : no_features | Feature::subsurface_boundary;
    };
    kind.set_pack([]<class Real>(const SceneMaterial& m, Material<Real>& packed) {
        ScatteringMedium<Real> medium{};
        const Vec3d sigma_t = m.sigma_a + m.sigma_s;
        medium.sigma_s = narrow<Real>(m.sigma_s);
        medium.sigma_t = narrow<Real>(sigma_t);
        for (int i = 0; i < 3; ++i) {
            medium.scattering_albedo[i] = static_cast<Real>(sigma_t[i] > 0 ? m.sigma_s[i] / sigma_t[i] : 0.0);
        }
        medium.grey = sigma_t.x == sigma_t.y && sigma_t.y == sigma_t.z ? 1 : 0;
        medium.g = static_cast<Real>(m.g);
        packed.subsurface = {entering_boundary<Real>(m.ior), leaving_boundary<Real>(m.ior), m.ior != 1 ? 1u : 0u,
                             m.max_scatterings, medium};
    });
    kind.first_hit_albedo = [](const SceneMaterial& m, const Vec3d&) {
        Vec3d albedo(0.0);
        for (int i = 0; i < 3; ++i) {
            const double sigma_t = m.sigma_a[i] + m.sigma_s[i];
            albedo[i] = sigma_t > 0 ? m.sigma_s[i] / sigma_t : 0;
        }
        return albedo;
    };
    kind.needs_inside = [](const SceneMaterial&) { return true; };
    kind.in_mitsuba = [](const SceneMaterial& m) {
        return MitsubaBsdf{m.ior == 1 ? MitsubaBsdf::Type::none : MitsubaBsdf::Type::dielectric, std::nullopt};
    };
    kind.beyond_mitsuba = [](const SceneMaterial& m, std::uint32_t depth) {
        std::vector<BeyondMitsuba> problems;
        if (depth < endless_depth) {
            problems.push_back({"", fmt::format("subsurface at depth {}", depth),
                                fmt::format("--depth {} or more, where paths have no end in Mitsuba: it counts each "
                                            "scattering towards its max_depth",
                                            endless_depth)});
        }
        if (m.max_scatterings != SceneMaterial{}.max_scatterings) {
            problems.push_back({"max_scatterings", fmt::format("{}", m.max_scatterings),
                                "none: Mitsuba's walks end at the surface only"});
        }
        return problems;
    };
    return kind;
}

}  // namespace pt
