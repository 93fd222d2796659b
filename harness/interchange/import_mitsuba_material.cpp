// Imports Mitsuba BSDFs. Parameters and defaults are those of src/bsdfs/ and include/mitsuba/render/ior.h of Mitsuba 3.
#include "harness/interchange/import_mitsuba_material.h"

#include <cmath>

#include <fmt/format.h>

#include "harness/interchange/mitsuba_indices.h"

namespace pt {

namespace {

constexpr const char* readable_bsdfs =
    "diffuse, conductor, roughconductor, dielectric, roughdielectric, twosided with one of them, or blendbsdf of a "
    "diffuse and a conductor";

SceneMember mitsuba_member(const char* key, const std::string& value, const Cis565Line* line,
                           const char* stand_in = "") {
    return {.key = key, .value = value, .line = line, .stand_in = stand_in};
}

bool is_white_in_mitsuba(const Vec3d& v) { return v.x == 1 && v.y == 1 && v.z == 1; }

}  // namespace

MitsubaMaterials::Bsdf MitsubaMaterials::read_diffuse(MitsubaObject& object) {
    const Colour albedo = read_colour(object, "reflectance", Vec3d(0.5));
    const XmlElement* at = object.property("reflectance");
    return {.type = "diffuse",
            .members = {mitsuba_member("albedo", albedo.json, file_->place(at != nullptr ? *at : object.element()),
                                       "[0, 0, 0]")},
            .one_sided = &object.element(),
            .is_black = is_black(albedo.value),
            .image = albedo.image};
}

// Reads a roughness, the square root of Mitsuba's alpha. `changes` receives what differs in the microfacet model.
double MitsubaMaterials::read_roughness(MitsubaObject& object, std::string& changes) {
    const double alpha = object.number("alpha", 0.1);
    const double along = object.number("alpha_u", alpha), across = object.number("alpha_v", alpha);
    if (along != across) {
        object.fail(object.element(), "alpha_u and alpha_v that are the same");
    }
    if (!(along >= 0 && along <= 1)) {
        object.fail(object.element(), fmt::format("an alpha from 0 to 1, not {}", along));
        return 0;
    }
    object.ignore({"sample_visible"});
    if (object.text("distribution", "beckmann") != "ggx") {
        changes += "facets of the same width by GGX, not by Beckmann; ";
    }
    changes += "facets masked for both directions together, there for each on its own";
    return shortest_within(std::sqrt(along), 1e-15);
}

MitsubaMaterials::Bsdf MitsubaMaterials::read_conductor(MitsubaObject& object, bool is_rough) {
    const std::string material = object.text("material", "none");
    const Colour shown = read_colour(object, "specular_reflectance", Vec3d(1.0));
    const Vec3d colour = shown.value;
    std::optional<Vec3d> eta = object.optional_colour("eta"), k = object.optional_colour("k");
    if (material != "none") {
        const MitsubaMetal* metal = find_mitsuba_metal(material);
        if (metal == nullptr || eta || k) {
            object.fail(*object.property("material"), "without eta and k, \"none\" or " + names_of_mitsuba_metals());
        } else {
            eta = metal->eta;
            k = metal->k;
        }
    }
    const Cis565Line* at = file_->place(object.element());
    const bool has_fresnel = eta || k;
    if (has_fresnel && shown.image != MitsubaImage::none) {
        object.fail(*object.property("specular_reflectance"), "one colour with eta and k, which it is multiplied by");
    }
    Vec3d reflectance = colour;
    std::string changes;
    if (has_fresnel) {
        const Vec3d n = eta.value_or(Vec3d(0.0)), absorbed = k.value_or(Vec3d(1.0));
        for (int i = 0; i < 3; ++i) {
            const double squares = absorbed[i] * absorbed[i];
            reflectance[i] *= ((n[i] - 1) * (n[i] - 1) + squares) / ((n[i] + 1) * (n[i] + 1) + squares);
        }
        changes = fmt::format("Fresnel's formula of eta and k as Schlick's from [{:.4g}, {:.4g}, {:.4g}] on; ",
                              reflectance.x, reflectance.y, reflectance.z);
    } else if (is_rough && (shown.image != MitsubaImage::none || !is_white_in_mitsuba(colour))) {
        changes = "a reflectance that goes to white at grazing angles; ";
    }
    const std::string json = has_fresnel ? json_of(reflectance) : shown.json;
    if (!is_rough && !has_fresnel) {
        return {.type = "mirror",
                .members = {mitsuba_member("reflectance", json, at, "[0, 0, 0]")},
                .one_sided = &object.element(),
                .is_black = is_black(reflectance),
                .image = shown.image};
    }
    const double roughness = is_rough ? read_roughness(object, changes) : 0;
    if (!changes.empty()) {
        file_->warn(object.element(), "is read with " + changes.substr(0, changes.find_last_not_of("; ") + 1));
    }
    return {.type = "rough_conductor",
            .members = {mitsuba_member("reflectance", json, at, "[0, 0, 0]"),
                        mitsuba_member("roughness", json_of(roughness), at, "1")},
            .one_sided = &object.element(),
            .image = shown.image};
}

// Reads an index of refraction: a number, or the name of a substance.
std::optional<double> MitsubaMaterials::read_index(MitsubaObject& object, const std::string& name,
                                                   const std::string& otherwise) {
    const XmlElement* found = object.property(name);
    if (found != nullptr && found->tag != "string") {
        return object.optional_number(name);
    }
    const std::optional<double> index = mitsuba_index_of(object.text(name, otherwise));
    if (!index) {
        object.fail(*found, "a number or one of " + names_of_mitsuba_indices());
    }
    return index;
}

MitsubaMaterials::Bsdf MitsubaMaterials::read_dielectric(MitsubaObject& object, bool is_rough) {
    const double inside = read_index(object, "int_ior", "bk7").value_or(1.5);
    const double outside = read_index(object, "ext_ior", "air").value_or(1);
    if (!(inside > 0 && outside > 0)) {
        object.fail(object.element(), "indices of refraction above 0");
    }
    if (outside != 1) {
        file_->note(object.element(),
                    fmt::format("has the index {} in {}: here {} in 1", inside, outside, inside / outside));
    }
    const Vec3d tint = object.colour("specular_transmittance", Vec3d(1.0));
    if (!is_white_in_mitsuba(object.colour("specular_reflectance", Vec3d(1.0)))) {
        object.fail(*object.property("specular_reflectance"), "1: what glass reflects is not tinted");
    }
    const Cis565Line* at = file_->place(object.element());
    Bsdf glass{.type = is_rough ? "rough_dielectric" : "dielectric",
               .members = {mitsuba_member("ior", json_of(outside > 0 ? inside / outside : 0), at, "1")},
               .is_glass = true};
    if (!is_white_in_mitsuba(tint)) {
        glass.members.push_back(mitsuba_member("tint", json_of(tint), at, "[0, 0, 0]"));
    }
    if (is_rough) {
        std::string changes;
        glass.members.push_back(mitsuba_member("roughness", json_of(read_roughness(object, changes)), at, "1"));
        file_->warn(object.element(), "is read with " + changes);
    }
    return glass;
}

MitsubaMaterials::Bsdf MitsubaMaterials::read_blend(MitsubaObject& object, int depth) {
    const double weight = object.number("weight", 0.5);
    const std::vector<const XmlElement*> parts = object.objects("bsdf");
    Bsdf mix{.type = "mix", .members = {}};
    if (parts.size() != 2) {
        object.fail(object.element(), "two BSDFs in it");
        mix.is_good = false;
        return mix;
    }
    const Bsdf first = read_bsdf(*parts[0], depth + 1), second = read_bsdf(*parts[1], depth + 1);
    const bool has_mirror_second = first.type == "diffuse" && second.type == "mirror";
    if (!has_mirror_second && !(first.type == "mirror" && second.type == "diffuse")) {
        object.fail(object.element(), "in it a diffuse, and a conductor without eta and k");
    }
    const Bsdf &diffuse = has_mirror_second ? first : second, &mirror = has_mirror_second ? second : first;
    mix.members = diffuse.members;
    mix.members.insert(mix.members.end(), mirror.members.begin(), mirror.members.end());
    mix.members.push_back(mitsuba_member("mirror_probability", json_of(has_mirror_second ? weight : 1 - weight),
                                         file_->place(object.element()), "0"));
    mix.one_sided = first.one_sided != nullptr ? first.one_sided : second.one_sided;
    mix.is_good = first.is_good && second.is_good;
    mix.image = diffuse.image;
    file_->warn(object.element(),
                "is read as a mix, with a probability for each of the two: Mitsuba's own picture of it is too dark "
                "(docs/other_renderers.md)");
    return mix;
}

MitsubaMaterials::Bsdf MitsubaMaterials::read_bsdf(const XmlElement& element, int depth) {
    constexpr int deepest = 8;  // limit on nested BSDFs, which may refer to each other in a circle
    MitsubaObject object(element, *file_);
    const std::string type = object.type();
    Bsdf bsdf;
    if (depth > deepest) {
        file_->refuse(element, "BSDFs in at most 8 levels");
        bsdf.is_good = false;
        return bsdf;
    }
    if (type == "diffuse") {
        bsdf = read_diffuse(object);
    } else if (type == "conductor" || type == "roughconductor") {
        bsdf = read_conductor(object, type == "roughconductor");
    } else if (type == "dielectric" || type == "roughdielectric") {
        bsdf = read_dielectric(object, type == "roughdielectric");
    } else if (type == "blendbsdf") {
        bsdf = read_blend(object, depth);
    } else if (type == "twosided") {
        const std::vector<const XmlElement*> inner = object.objects("bsdf");
        if (inner.size() == 1) {
            bsdf = read_bsdf(*inner.front(), depth + 1);
            bsdf.one_sided = nullptr;
        } else {
            object.fail(element, "one BSDF in it: both sides of a surface are the same");
        }
    } else {
        file_->refuse(element, readable_bsdfs);
        bsdf.is_good = false;
        return bsdf;
    }
    object.finish("what " + type + " has here: nothing else");
    bsdf.is_good = bsdf.is_good && object.is_good();
    return bsdf;
}

const MitsubaMaterials::Bsdf& MitsubaMaterials::bsdf_of(const XmlElement* element) {
    const auto known = bsdfs_.find(element);
    return known != bsdfs_.end() ? known->second : bsdfs_.emplace(element, read_bsdf(*element, 0)).first->second;
}

// Adds a dielectric's interior medium: absorption alone, or scattering, which makes it a subsurface material.
bool MitsubaMaterials::add_medium(const XmlElement& element, const MitsubaSurface& surface, const Bsdf& bsdf,
                                  ScenePart& part) {
    MitsubaObject medium(element, *file_);
    if (!bsdf.is_glass) {
        file_->note(*surface.shape, "is opaque: its interior medium is left out");
        return true;
    }
    if (medium.type() != "homogeneous") {
        file_->refuse(element, "a medium of type homogeneous");
        return false;
    }
    const double scale = medium.number("scale", 1);
    const Vec3d extinction = medium.colour("sigma_t", Vec3d(1.0)) * scale;
    const Vec3d albedo = medium.colour("albedo", Vec3d(0.75));
    const Cis565Line* at = file_->place(element);
    medium.ignore({"sample_emitters", "has_spectral_extinction"});
    double g = 0;
    for (const XmlElement* phase : medium.objects("phase")) {
        MitsubaObject function(*phase, *file_);
        if (function.type() == "hg") {
            g = function.number("g", 0.8);
        } else if (function.type() != "isotropic") {
            medium.fail(*phase, "a phase function of type isotropic or hg");
        }
        function.finish("g");
    }
    medium.finish("sigma_t, albedo, scale and a phase function");
    if (!medium.is_good()) {
        return false;
    }
    if (is_black(albedo)) {
        part.members.push_back(mitsuba_member("sigma_a", json_of(extinction), at, "[0, 0, 0]"));
        return true;
    }
    const bool is_clear = bsdf.type == "dielectric" && bsdf.members.size() == 1;
    if (!is_clear) {
        file_->refuse(element,
                      "albedo 0 inside tinted or rough glass (inside a clear dielectric, what scatters is read "
                      "as subsurface)");
        return false;
    }
    part.members.front().value = "\"subsurface\"";
    part.members.push_back(mitsuba_member("sigma_s", json_of(extinction * albedo), at, "[0, 0, 0]"));
    part.members.push_back(mitsuba_member("sigma_a", json_of(extinction - extinction * albedo), at, "[0, 0, 0]"));
    if (g != 0) {
        part.members.push_back(mitsuba_member("g", json_of(g), at, "0"));
    }
    file_->warn(element,
                "is read as subsurface: all scatterings of a walk inside count once towards max_depth, there "
                "each does");
    return true;
}

bool MitsubaMaterials::add_emission(const MitsubaSurface& surface, const Bsdf& bsdf, ScenePart& part) {
    MitsubaObject emitter(*surface.emitter, *file_);
    const std::optional<Vec3d> radiance = emitter.optional_radiance("radiance");
    if (!radiance && emitter.is_good()) {
        file_->refuse(*surface.emitter, "an area emitter with its radiance");
        return false;
    }
    emitter.finish("radiance");
    if (!emitter.is_good()) {
        return false;
    }
    if (bsdf.is_glass) {
        file_->refuse(*surface.emitter, "an emitter on a surface that is not glass");
        return false;
    }
    const Cis565Line* at = file_->place(*emitter.property("radiance"));
    if (bsdf.is_black) {
        part.members = {mitsuba_member("type", "\"emitter\"", nullptr),
                        mitsuba_member("radiance", json_of(*radiance), at, "[0, 0, 0]")};
    } else {
        part.members.push_back(mitsuba_member("emission", json_of(*radiance), at, "[0, 0, 0]"));
    }
    return true;
}

std::optional<std::size_t> MitsubaMaterials::make(const MitsubaSurface& surface, const Bsdf& bsdf, const Key& key) {
    const auto known = made_.find(key);
    if (known != made_.end()) {
        return known->second;
    }
    ScenePart part{
        .place = "", .head = file_->place(surface.bsdf != nullptr ? *surface.bsdf : *surface.shape), .members = {}};
    part.members.push_back(mitsuba_member("type", json_of(bsdf.type), nullptr));
    part.members.insert(part.members.end(), bsdf.members.begin(), bsdf.members.end());
    const bool is_good = bsdf.is_good &&
                         (surface.interior == nullptr || add_medium(*surface.interior, surface, bsdf, part)) &&
                         (surface.emitter == nullptr || add_emission(surface, bsdf, part));
    std::optional<std::size_t>& made = made_[key];
    if (is_good) {
        const std::string id = surface.bsdf == nullptr ? "" : surface.bsdf->value_of("id");
        const bool is_lamp = surface.emitter != nullptr;
        made = file_->draft->add_material(std::move(part),
                                          id.empty() ? (is_lamp ? "lamp" : bsdf.type) : id + (is_lamp ? "_lamp" : ""));
        one_sided_[*made] = bsdf.one_sided;
        emitters_[*made] = surface.emitter;
        images_[*made] = bsdf.image;
    }
    return made;
}

std::optional<std::size_t> MitsubaMaterials::material_of(const MitsubaSurface& surface) {
    Bsdf own{.type = "diffuse",
             .members = {mitsuba_member("albedo", surface.emitter != nullptr ? "[0, 0, 0]" : "[0.5, 0.5, 0.5]",
                                        file_->place(*surface.shape))},
             .one_sided = surface.emitter != nullptr ? nullptr : surface.shape,
             .is_black = surface.emitter != nullptr};
    return make(surface, surface.bsdf == nullptr ? own : bsdf_of(surface.bsdf),
                {surface.bsdf, surface.emitter, surface.interior, false});
}

std::optional<std::size_t> MitsubaMaterials::material_behind(const MitsubaSurface& surface) {
    MitsubaSurface behind = surface;
    behind.emitter = behind.interior = nullptr;
    Bsdf bsdf{.type = "diffuse",
              .members = {mitsuba_member("albedo", "[0, 0, 0]", file_->place(*surface.shape))},
              .is_black = true};
    const bool is_twosided = surface.bsdf != nullptr && bsdf_of(surface.bsdf).one_sided == nullptr;
    if (!is_twosided) {
        behind.bsdf = nullptr;
    }
    return make(behind, is_twosided ? bsdf_of(surface.bsdf) : bsdf, {behind.bsdf, nullptr, nullptr, true});
}

std::set<const XmlElement*> MitsubaMaterials::used() const {
    std::set<const XmlElement*> used;
    for (const auto& [element, bsdf] : bsdfs_) {
        used.insert(element);
    }
    return used;
}

}  // namespace pt
