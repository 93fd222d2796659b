// A kind of material as scenes have it: harness/scene/materials/NAME.cpp says for each of the list
// (kernels/material_list.h) how scene files describe it, and what of a description kernels and pictures need.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "harness/json_reader.h"
#include "harness/scene/scene.h"
#include "kernels/config.h"
#include "kernels/materials.h"

namespace pt {

// Depth from which on paths of a scene with a subsurface material have no end in Mitsuba, which counts each scattering
// of a walk towards its max_depth: what paths bring after a thousand segments is no part of a picture.
inline constexpr std::uint32_t endless_depth = 1000;

// What Mitsuba cannot express of a material: the key in question (empty: the material as a whole), what was found
// there, and what is allowed.
struct BeyondMitsuba {
    std::string key, found, allowed;
};

// What Mitsuba has in a material's place: a surface that reflects on both sides, the smooth boundary of a body, or none
// where a body's index is 1.
struct MitsubaBsdf {
    enum class Type { diffuse, conductor, dielectric, none };
    Type type = Type::diffuse;
    std::optional<Vec3d> colour;          // that it reflects or, a boundary, lets through
    const SceneTexture* image = nullptr;  // in place of the colour, or null
};

// What is beyond Mitsuba of a material with rough facets, which it masks by another formula.
std::vector<BeyondMitsuba> rough_facets_beyond_mitsuba(const SceneMaterial& material, std::uint32_t depth);

struct MaterialKind {
    // The material that a scene file describes, without its name. Throws InputError.
    SceneMaterial (*read)(const JsonValue& value) = nullptr;
    // What kernels need for it beyond the kind's own feature and Feature::emission.
    FeatureSet (*extra_features)(const SceneMaterial& material) = [](const SceneMaterial&) { return no_features; };
    // Fills in the kind's parameters, of which one that is by_surface has none; `absorbs` and what every material has
    // stand there already.
    void (*pack_single)(const SceneMaterial& material, Material<float>& packed) = [](const SceneMaterial&,
                                                                                     Material<float>&) {};
    void (*pack_double)(const SceneMaterial& material, Material<double>& packed) = [](const SceneMaterial&,
                                                                                      Material<double>&) {};
    // The colour that most hits need (Surface): what a texture stands for.
    Vec3d (*surface_colour)(const SceneMaterial& material) = [](const SceneMaterial& m) { return m.albedo; };
    // What the picture of albedos shows, with `colour` in place of surface_colour.
    Vec3d (*first_hit_albedo)(const SceneMaterial& material, const Vec3d& colour) = [](const SceneMaterial&,
                                                                                       const Vec3d& c) { return c; };
    // Whether rays run within the body, so that its shape must have an inside.
    bool (*needs_inside)(const SceneMaterial& material) = [](const SceneMaterial&) { return false; };
    // Whether its facets do nothing, so that an image of their roughness is not looked up.
    bool (*ignores_roughness)(const SceneMaterial& material) = [](const SceneMaterial&) { return false; };
    // Bound on what a path's throughput is multiplied by at one vertex, where that can be above 1.
    double (*largest_gain)(const SceneMaterial& material) = [](const SceneMaterial&) { return 1.0; };
    bool reflects_all_at_grazing = false;  // whatever its colour
    // The part of the light that every bounce keeps; nothing unless all that the material does keeps the same part.
    std::optional<Vec3d> (*even_reflectance)(const SceneMaterial& material) = [](const SceneMaterial&) {
        return std::optional<Vec3d>();
    };
    // What stands for it in a file for Mitsuba, where beyond_mitsuba has nothing to say.
    MitsubaBsdf (*in_mitsuba)(const SceneMaterial& material) = [](const SceneMaterial& m) {
        return MitsubaBsdf{MitsubaBsdf::Type::diffuse, m.albedo, m.texture.get()};
    };
    // What an export to Mitsuba with paths of `depth` segments cannot express.
    std::vector<BeyondMitsuba> (*beyond_mitsuba)(const SceneMaterial& material, std::uint32_t depth) =
        [](const SceneMaterial&, std::uint32_t) { return std::vector<BeyondMitsuba>{}; };

    // `pack` fills in the parameters in either precision: a lambda that captures nothing.
    template <class Pack>
    void set_pack(Pack pack) {
        pack_single = pack;
        pack_double = pack;
    }
};

// The kinds, each defined in its file: kind_of_diffuse() and so on.
#define PT_KIND(name, Type, traits) MaterialKind kind_of_##name();
PT_MATERIALS(PT_KIND)
#undef PT_KIND

const MaterialKind& kind_of(MaterialType type);
inline const MaterialKind& kind_of(const SceneMaterial& material) { return kind_of(material.type); }

// The names of the kinds, as scene files have them.
std::vector<std::string> material_type_names();

// The material that a scene file describes, without its name. Throws InputError.
SceneMaterial read_material(const JsonValue& value);

// Everything that kernels need for the material.
FeatureSet features_of(const SceneMaterial& material);

// The material as kernels read it.
template <class Real>
Material<Real> packed(const SceneMaterial& material);

template <class Real>
Vec3<Real> narrow(const Vec3d& v) {
    return {static_cast<Real>(v.x), static_cast<Real>(v.y), static_cast<Real>(v.z)};
}

// For the files of kinds: a boundary of index `ior` from outside and from within, values with their ranges, and keys
// that several kinds have.
template <class Real>
Boundary<Real> entering_boundary(double ior);
template <class Real>
Boundary<Real> leaving_boundary(double ior);
inline constexpr double largest_radiance = 1e30;
Vec3d read_vector(const JsonValue& value, double low, double high, const std::string& allowed);
Vec3d read_fractions(const JsonValue& value);  // from 0 to 1
Vec3d read_radiance(const JsonValue& value);
Vec3d read_sigma(const JsonValue& value);
double read_ior(const JsonValue& value);
// A colour, or {"image": NAME}, which the material keeps; the name is relative to the scene's file. Returns the colour,
// or the largest texel in each channel.
Vec3d read_colour(const JsonValue& value, SceneMaterial& material);
// A roughness: a number, or an image of numbers, which the material keeps. Returns the largest number.
double read_roughness(const JsonValue& value, SceneMaterial& material);
// The keys that all have that reflect, "emission" and "normal": each may be absent.
void read_emission_and_normal(const JsonObject& object, SceneMaterial& material);

}  // namespace pt
