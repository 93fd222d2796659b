// The interface of a kind of material: harness/scene/materials/NAME.cpp tells, for each kind in
// kernels/material_list.h, how scene files describe it, and how it is packed for kernels, shown in the albedo image and
// exported to Mitsuba.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "harness/json_reader.h"
#include "harness/scene/scene.h"
#include "kernels/config.h"
#include "kernels/materials.h"

namespace pt {

// Least path depth at which a scene with a subsurface material can be exported to Mitsuba, without a max_depth, since
// Mitsuba counts each scattering of a random walk towards it. Paths beyond a thousand segments add nothing visible.
inline constexpr std::uint32_t endless_depth = 1000;

// A property of a material that Mitsuba cannot express: the key in the scene file (empty: the material as a whole),
// what was found under the key, and what is allowed.
struct BeyondMitsuba {
    std::string key, found, allowed;
};

// The Mitsuba BSDF that a material is exported as: a two-sided reflecting surface, the smooth boundary of a dielectric
// body, or none where the body's index of refraction is 1.
struct MitsubaBsdf {
    enum class Type { diffuse, conductor, dielectric, none };
    Type type = Type::diffuse;
    std::optional<Vec3d> colour;          // colour that the surface reflects or, as a dielectric boundary, transmits
    const SceneTexture* image = nullptr;  // texture that takes the place of the colour; null: none
};

// What Mitsuba cannot express of a material with rough microfacets: its masking term is another formula.
std::vector<BeyondMitsuba> rough_facets_beyond_mitsuba(const SceneMaterial& material, std::uint32_t depth);

struct MaterialKind {
    // Reads a material of the kind, without the material's name, from a scene file. Throws InputError.
    SceneMaterial (*read)(const JsonValue& value) = nullptr;
    // Feature flags that kernels need for the material, beyond the kind's own and Feature::emission.
    FeatureSet (*extra_features)(const SceneMaterial& material) = [](const SceneMaterial&) { return no_features; };
    // Fills the kind's parameters into the packed material; a kind with the trait `by_surface` has none. `absorbs` and
    // the fields that every material has are filled in already.
    void (*pack_single)(const SceneMaterial& material, Material<float>& packed) = [](const SceneMaterial&,
                                                                                     Material<float>&) {};
    void (*pack_double)(const SceneMaterial& material, Material<double>& packed) = [](const SceneMaterial&,
                                                                                      Material<double>&) {};
    // The colour that shading most hits needs (Surface), which a texture replaces.
    Vec3d (*surface_colour)(const SceneMaterial& material) = [](const SceneMaterial& m) { return m.albedo; };
    // The colour of the material in the albedo image. `colour` is surface_colour, or the texel in its place.
    Vec3d (*first_hit_albedo)(const SceneMaterial& material, const Vec3d& colour) = [](const SceneMaterial&,
                                                                                       const Vec3d& c) { return c; };
    // Whether rays run within a body of the material, so that its shape must have an inside.
    bool (*needs_inside)(const SceneMaterial& material) = [](const SceneMaterial&) { return false; };
    // Whether the material's microfacets have no effect, so that a roughness texture need not be looked up.
    bool (*ignores_roughness)(const SceneMaterial& material) = [](const SceneMaterial&) { return false; };
    // Upper bound on the factor by which the throughput grows at a path vertex on the material; above 1 for some kinds.
    double (*largest_gain)(const SceneMaterial& material) = [](const SceneMaterial&) { return 1.0; };
    bool reflects_all_at_grazing = false;  // whether the material reflects all grazing light, whatever its colour
    // The share of light that every bounce off the material reflects, or nothing if its lobes reflect different shares.
    std::optional<Vec3d> (*even_reflectance)(const SceneMaterial& material) = [](const SceneMaterial&) {
        return std::optional<Vec3d>();
    };
    // The BSDF that the material is exported as to Mitsuba. Only valid if `beyond_mitsuba` returns nothing.
    MitsubaBsdf (*in_mitsuba)(const SceneMaterial& material) = [](const SceneMaterial& m) {
        return MitsubaBsdf{MitsubaBsdf::Type::diffuse, m.albedo, m.texture.get()};
    };
    // What an export to Mitsuba cannot express of the material, for paths of up to `depth` segments.
    std::vector<BeyondMitsuba> (*beyond_mitsuba)(const SceneMaterial& material, std::uint32_t depth) =
        [](const SceneMaterial&, std::uint32_t) { return std::vector<BeyondMitsuba>{}; };

    // Sets the functions that pack the kind's parameters in single and in double precision; `pack` captures nothing.
    template <class Pack>
    void set_pack(Pack pack) {
        pack_single = pack;
        pack_double = pack;
    }
};

// One function kind_of_NAME() per kind of material, each defined in harness/scene/materials/NAME.cpp.
#define PT_KIND(name, Type, traits) MaterialKind kind_of_##name();
PT_MATERIALS(PT_KIND)
#undef PT_KIND

const MaterialKind& kind_of(MaterialType type);
inline const MaterialKind& kind_of(const SceneMaterial& material) { return kind_of(material.type); }

// Names of the kinds of materials as scene files write them.
std::vector<std::string> material_type_names();

// Reads a material of any kind, without its name, from a scene file. Throws InputError.
SceneMaterial read_material(const JsonValue& value);

// All feature flags that kernels need for a material.
FeatureSet features_of(const SceneMaterial& material);

// Packs a material into the layout that kernels read.
template <class Real>
Material<Real> packed(const SceneMaterial& material);

template <class Real>
Vec3<Real> narrow(const Vec3d& v) {
    return {static_cast<Real>(v.x), static_cast<Real>(v.y), static_cast<Real>(v.z)};
}

// Helpers for the files of material kinds: a dielectric boundary of index `ior` as met from outside and from inside,
// and readers of values with their ranges and of keys that several kinds share.
template <class Real>
Boundary<Real> entering_boundary(double ior);
template <class Real>
Boundary<Real> leaving_boundary(double ior);
inline constexpr double largest_radiance = 1e30;
Vec3d read_vector(const JsonValue& value, double low, double high, const std::string& allowed);
Vec3d read_fractions(const JsonValue& value);  // reads a vector of three numbers from 0 to 1
Vec3d read_radiance(const JsonValue& value);
Vec3d read_sigma(const JsonValue& value);
double read_ior(const JsonValue& value);
// Reads a colour or a texture {"image": NAME} with a path relative to the scene file, and stores the texture in the
// material. Returns the colour, or the largest texel in each channel.
Vec3d read_colour(const JsonValue& value, SceneMaterial& material);
// Reads a roughness: a number or a texture, which is stored in the material. Returns the largest value.
double read_roughness(const JsonValue& value, SceneMaterial& material);
// Reads the optional keys "emission" and "normal" that all reflecting kinds of materials share.
void read_emission_and_normal(const JsonObject& object, SceneMaterial& material);

}  // namespace pt
