#include "harness/scene/material_kind.h"

#include <algorithm>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "harness/scene/scene_texture.h"

namespace pt {

const MaterialKind& kind_of(MaterialType type) {
#define PT_KIND(name, Type, traits) kind_of_##name(),
    static const MaterialKind kinds[] = {PT_MATERIALS(PT_KIND)};
#undef PT_KIND
    return kinds[static_cast<std::size_t>(type)];
}

std::vector<BeyondMitsuba> rough_facets_beyond_mitsuba(const SceneMaterial&, std::uint32_t) {
    return {{"", "rough facets",
             "another material: Mitsuba masks the facets of each direction on its own, ptbench of both together (Heitz "
             "2014)"}};
}

std::vector<std::string> material_type_names() {
#define PT_NAME(name, Type, traits) #name,
    return {PT_MATERIALS(PT_NAME)};
#undef PT_NAME
}

SceneMaterial read_material(const JsonValue& value) {
    if (!value.json().is_object()) {
        value.fail("an object");
    }
    const std::vector<std::string> names = material_type_names();
    if (!value.json().contains("type")) {
        throw InputError(value.file(), value.path(), "no key \"type\"",
                         fmt::format("it is required: {}", fmt::join(names, ", ")));
    }
    const std::string name = JsonValue(value.json().at("type"), value.file(), value.path() + ".type").one_of(names);
    const auto type = static_cast<MaterialType>(std::find(names.begin(), names.end(), name) - names.begin());
    SceneMaterial material = kind_of(type).read(value);
    material.type = type;
    return material;
}

FeatureSet features_of(const SceneMaterial& material) {
#define PT_FEATURE(name, Type, traits) Feature::name,
    static constexpr Feature by_type[] = {PT_MATERIALS(PT_FEATURE)};
#undef PT_FEATURE
    FeatureSet features = kind_of(material).extra_features(material) | by_type[static_cast<std::size_t>(material.type)];
    if (!is_black(material.emission) && !has_trait(material.type, material_trait::ends_paths)) {
        features = features | Feature::emission;
    }
    return features;
}

template <class Real>
Material<Real> packed(const SceneMaterial& m) {
    Material<Real> material{};
    material.type = m.type;
    material.emits = m.emission != Vec3d(0.0) ? 1 : 0;
    material.emission = narrow<Real>(m.emission);
    material.sigma_a = narrow<Real>(m.sigma_a);
    material.absorbs = lets_light_in(m) && m.sigma_a != Vec3d(0.0) ? 1 : 0;
    if constexpr (std::is_same_v<Real, float>) {
        kind_of(m).pack_single(m, material);
    } else {
        kind_of(m).pack_double(m, material);
    }
    return material;
}
template Material<float> packed(const SceneMaterial&);
template Material<double> packed(const SceneMaterial&);

namespace {

template <class Real>
Boundary<Real> make_boundary(double relative_ior) {
    return {static_cast<Real>(relative_ior), static_cast<Real>(1.0 / relative_ior),
            static_cast<Real>((relative_ior - 1.0) * (relative_ior + 1.0))};
}

}  // namespace

template <class Real>
Boundary<Real> entering_boundary(double ior) {
    return make_boundary<Real>(ior);
}
template <class Real>
Boundary<Real> leaving_boundary(double ior) {
    Boundary<Real> leaving = make_boundary<Real>(1.0 / ior);
    // The boundary's coefficient k = 1/ior^2 - 1 is computed from the index ior itself, since 1/ior is already rounded.
    leaving.k = static_cast<Real>(-(ior - 1.0) * (ior + 1.0) / (ior * ior));
    return leaving;
}
template Boundary<float> entering_boundary(double);
template Boundary<double> entering_boundary(double);
template Boundary<float> leaving_boundary(double);
template Boundary<double> leaving_boundary(double);

Vec3d read_vector(const JsonValue& value, double low, double high, const std::string& allowed) {
    if (!value.json().is_array() || value.json().size() != 3) {
        value.fail("an array of 3 numbers");
    }
    const std::vector<JsonValue> elements = value.elements();
    return {elements[0].number(low, high, allowed), elements[1].number(low, high, allowed),
            elements[2].number(low, high, allowed)};
}

Vec3d read_fractions(const JsonValue& value) { return read_vector(value, 0, 1, "a number from 0 to 1"); }
Vec3d read_radiance(const JsonValue& value) {
    return read_vector(value, 0, largest_radiance, "a number from 0 to 1e30");
}
Vec3d read_sigma(const JsonValue& value) { return read_vector(value, 0, 1e18, "a number from 0 to 1e18"); }
double read_ior(const JsonValue& value) { return value.number(0.01, 1e4, "a number from 0.01 to 1e4"); }

Vec3d read_colour(const JsonValue& value, SceneMaterial& material) {
    if (value.json().is_array()) {
        return read_fractions(value);
    }
    if (!value.json().is_object()) {
        value.fail(R"(an array of 3 numbers, or {"image": NAME})");
    }
    material.texture = read_texture(value, TexelMeaning::colour);
    return largest_texel(*material.texture);
}

double read_roughness(const JsonValue& value, SceneMaterial& material) {
    if (value.json().is_number()) {
        return value.number(0, 1, "a number from 0 to 1");
    }
    if (!value.json().is_object()) {
        value.fail(R"(a number from 0 to 1, or {"image": NAME})");
    }
    material.roughness_texture = read_texture(value, TexelMeaning::number);
    return largest_texel(*material.roughness_texture).x;
}

void read_emission_and_normal(const JsonObject& object, SceneMaterial& material) {
    material.emission = object.has("emission") ? read_radiance(object.at("emission")) : Vec3d(0.0);
    read_normal_map(object, material);
}

}  // namespace pt
