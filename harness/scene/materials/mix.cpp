// Material kind `mix`: a mirror with probability `mirror_probability`, Lambertian otherwise.
#include <fmt/format.h>

#include "harness/scene/material_kind.h"

namespace pt {

MaterialKind kind_of_mix() {
    MaterialKind kind;
    kind.read = [](const JsonValue& value) {
        const JsonObject object(value, {"type", "albedo", "reflectance", "mirror_probability", "emission", "normal"});
        SceneMaterial material;
        material.albedo = read_colour(object.required("albedo"), material);
        material.reflectance = read_fractions(object.required("reflectance"));
        material.mirror_probability = object.required("mirror_probability").number(0, 1, "a number from 0 to 1");
        read_emission_and_normal(object, material);
        return material;
    };
    kind.set_pack([]<class Real>(const SceneMaterial& m, Material<Real>& packed) {
        packed.mix = {narrow<Real>(m.albedo), narrow<Real>(m.reflectance), static_cast<Real>(m.mirror_probability)};
    });
    kind.first_hit_albedo = [](const SceneMaterial& m, const Vec3d& colour) {
        return m.reflectance * m.mirror_probability + colour * (1 - m.mirror_probability);
    };
    kind.even_reflectance = [](const SceneMaterial& m) {
        return m.albedo == m.reflectance ? std::optional(m.albedo) : std::nullopt;
    };
    kind.in_mitsuba = [](const SceneMaterial& m) {
        return m.mirror_probability == 1 ? MitsubaBsdf{MitsubaBsdf::Type::conductor, m.reflectance}
                                         : MitsubaBsdf{MitsubaBsdf::Type::diffuse, m.albedo, m.texture.get()};
    };
    kind.beyond_mitsuba = [](const SceneMaterial& m, std::uint32_t) -> std::vector<BeyondMitsuba> {
        if (m.mirror_probability == 0 || m.mirror_probability == 1) {
            return {};
        }
        return {{"mirror_probability", fmt::format("{}", m.mirror_probability),
                 "0 or 1: Mitsuba's blendbsdf adds a mirror's probability to a diffuse lobe's density"}};
    };
    return kind;
}

}  // namespace pt
