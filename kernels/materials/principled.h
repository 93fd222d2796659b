// Metal, plastic and glass in one: the base colour, metallic, roughness and transmission of glTF 2.0 (appendix B of its
// specification, KHR_materials_transmission and _ior), over the facets of the other rough materials (kernels/ggx.h,
// alpha = roughness^2). With c the base colour, m metallic, t transmission, h the half vector,
//   m      a metal: facets that reflect c + (1 - c) (1 - v.h)^5 (Schlick 1994), as kernels/materials/rough_conductor.h,
//   1 - m  a dielectric: facets that reflect F(v.h), and beneath them
//            t      glass, tinted by c, as kernels/materials/rough_dielectric.h,
//            1 - t  a diffuse surface, (c / pi) (1 - max(F(n.v), F(n.l))).
// F is the exact reflectance of the boundary, where glTF has Schlick's; from within glass it is total at grazing
// angles. glTF weighs the diffuse surface by 1 - F(v.h), which with the facets' reflection adds up to more than 1 at
// grazing angles. The weight here is reciprocal too, and at most the 1 - F(n.v) that a smooth layer lets through:
// KHR_materials_sheen keeps its sum within 1 in that way. Single scattering: what facets send into others is lost.
#pragma once

#include "kernels/materials/rough_conductor.h"
#include "kernels/materials/rough_dielectric.h"

namespace pt {

template <class Real>
struct PrincipledMaterial {
    DielectricMaterial<Real> glass;  // dielectric part of the principled material, tinted by the base colour
    Real metallic;
    Real transmission;
    Real alpha;  // width of the GGX distribution, roughness^2

    template <class At>
    PT_HD bool scatter(const At& at, const Material<Real>& material) const;
};

// The principled material's lobe at one vertex, seen from one direction. All vectors are unit.
template <class ConfigT>
struct Principled {
    using Config = ConfigT;
    using Real = typename Config::Real;
    static constexpr bool transmits = true, may_be_opaque = true;

    RoughDielectric<Config> glass;  // glass lobe, whose microfacets serve the metal lobe as well
    Vec3<Real> colour;
    Real metal_share, diffuse_share, glass_share;  // shares of the principled lobe's three parts, which sum to 1
    Real layer_reflectance;                        // reflectance of a smooth boundary in the viewing direction, F(n.v)
    Real diffuse_probability;
    Vec3<Real> diffuse_colour;  // in a diffuse sample's weight: base colour * diffuse_share / diffuse_probability
    bool are_facets_wide;
    std::uint32_t medium_beyond;

    PT_HD Principled(const PrincipledMaterial<Real>& material, std::uint32_t beyond, const Vec3<Real>& colour_of,
                     Real alpha, const Vec3<Real>& outgoing, const Vertex<Real>& vertex)
        : glass(material.glass, beyond, alpha, outgoing, vertex),
          colour(colour_of),
          metal_share(material.metallic),
          diffuse_share((Real(1) - material.metallic) * (Real(1) - material.transmission)),
          glass_share((Real(1) - material.metallic) * material.transmission),
          medium_beyond(beyond) {
        glass.tint = colour;
        if (!(glass_share > Real(0))) {
            // No light comes out of an opaque body, whose boundary is always seen from outside.
            glass.boundary = material.glass.entering;
        }
        are_facets_wide = glass_share > Real(0) ? glass.is_connectable() : glass.facets.are_wide();
        layer_reflectance = reflectance_of(glass.facets.cosine);
        // The diffuse lobe and the reflecting layer are drawn in proportion to what a smooth surface sends by each.
        const Real beneath = (Real(1) - layer_reflectance) * max(colour.x, max(colour.y, colour.z));
        const Real both = layer_reflectance + beneath;
        diffuse_probability = diffuse_share * (both > Real(0) ? beneath / both : Real(1));
        const Vec3<Real> shown = colour * diffuse_share;
        // The division is last: diffuse_share / diffuse_probability could overflow for a colour near the least number.
        diffuse_colour = diffuse_probability > Real(0)
                             ? Vec3<Real>(shown.x / diffuse_probability, shown.y / diffuse_probability,
                                          shown.z / diffuse_probability)
                             : Vec3<Real>(Real(0));
    }

    // Narrow facets are not connected to lights, as mirrors and smooth glass are not; the diffuse surface beneath is.
    PT_HD bool is_connectable() const { return are_facets_wide || diffuse_share > Real(0); }
    PT_HD bool lets_through() const { return glass_share > Real(0) && are_facets_wide; }

    // BSDF * cosine / pdf, and pdf, of the principled lobe in the direction `incoming`, if the lobe is connectable;
    // `cosine`: of the direction to the normal, not 0.
    PT_HD LobeValue<Real> towards(const Vec3<Real>& incoming, Real cosine) const {
        if (!(cosine > Real(0))) {
            return lets_through() ? through(glass.towards(incoming, cosine))
                                  : LobeValue<Real>{Vec3<Real>(Real(0)), Real(0)};
        }
        if (!are_facets_wide) {
            return {diffuse_weight(cosine), diffuse_pdf(cosine)};
        }
        const GgxFacets<Real>& facets = glass.facets;
        const Real along = facets.cosine + cosine;
        const Vec3<Real> across = facets.outgoing + incoming - facets.normal * along;
        const Real across_squared = dot(across, across);
        const Real square = along * along + across_squared;
        const Real facet_cosine = min(Real(0.5) * square_root(square), Real(1));
        return above(cosine, mirror_of(facet_cosine, reflectance_of(facet_cosine)),
                     facets.mirrored_pdf(along, across_squared, square));
    }

    // Samples the principled lobe; `lobe` in [0, 1) picks its part. The sample's cosine is below 0 where it is
    // refracted; its pdf is 0 for narrow facets, and never 0 otherwise.
    PT_HD LobeSample<Real> sample(Real lobe, Real u, Real v) const {
        const bool meets_metal = lobe < metal_share;
        const Real rest = lobe - metal_share;
        if (!meets_metal && rest < diffuse_probability) {
            return sample_diffuse(u, v);
        }
        const GgxFacets<Real>& facets = glass.facets;
        const GgxFacet<Real> facet = facets.sample(u, v);
        const Vec3<Real> direction = -facets.outgoing;
        const Real facet_cosine = cosine_of_incidence(direction, facet.normal);
        Refraction<Real> refraction{Real(0), facet_cosine};
        if (metal_share < Real(1)) {
            refraction = fresnel<Config>(glass.boundary, facet_cosine);
        }
        const bool meets_glass = !meets_metal && !(rest < diffuse_share) && glass_share > Real(0);
        const bool is_reflected_totally = !(refraction.reflectance < Real(1));
        if (meets_glass && !((rest - diffuse_share) / glass_share < refraction.reflectance || is_reflected_totally)) {
            return sample_refracted(facet, facet_cosine, refraction);
        }
        LobeSample<Real> sample{reflect(direction, facet.normal), Real(0), {Vec3<Real>(Real(0)), Real(0)}};
        const Real cosine = dot(sample.direction, facets.normal);
        if (!(cosine > least_cosine<Real>)) {
            return sample;
        }
        sample.cosine = cosine;
        const Mirror mirror = mirror_of(facet_cosine, refraction.reflectance);
        if (are_facets_wide) {
            sample.value = kept(above(cosine, mirror, facets.mirrored_pdf(facet)));
        } else {
            sample.value.weight = mirror.weight() * facets.share_above(cosine);
        }
        return sample;
    }

private:
    // The reflectance of a facet, and the probability with which a path that meets it is reflected.
    struct Mirror {
        Vec3<Real> reflectance;
        Real probability;

        PT_HD Vec3<Real> weight() const {
            return {reflectance.x / probability, reflectance.y / probability, reflectance.z / probability};
        }
    };

    PT_HD Real reflectance_of(Real cosine) const {
        return metal_share < Real(1) ? fresnel<Config>(glass.boundary, min(cosine, Real(1))).reflectance : Real(0);
    }

    PT_HD Mirror mirror_of(Real facet_cosine, Real boundary) const {
        return {schlick_reflectance(colour, facet_cosine) * metal_share +
                    Vec3<Real>((diffuse_share + glass_share) * boundary),
                metal_share + (diffuse_share - diffuse_probability) + glass_share * boundary};
    }

    // The diffuse lobe's BSDF times the cosine over the lobe's density, scaled by the probability of drawing the lobe.
    PT_HD Vec3<Real> diffuse_weight(Real cosine) const {
        if (!(diffuse_probability > Real(0))) {
            return Vec3<Real>(Real(0));
        }
        return diffuse_colour * (Real(1) - max(layer_reflectance, reflectance_of(cosine)));
    }
    PT_HD Real diffuse_pdf(Real cosine) const { return diffuse_probability * (cosine * (Real(1) / pi<Real>)); }

    // Value of all parts of the principled lobe together for a direction above the surface; `mirrored`: the pdf with
    // which a facet mirrors light in that direction.
    PT_HD LobeValue<Real> above(Real cosine, const Mirror& mirror, Real mirrored) const {
        const Real facets_pdf = mirrored * mirror.probability;
        if (!(facets_pdf > Real(0))) {
            return {diffuse_weight(cosine), diffuse_pdf(cosine)};
        }
        const Vec3<Real> by_facets = mirror.weight() * glass.facets.share_above(cosine);
        if (!(diffuse_probability > Real(0))) {
            return {by_facets, facets_pdf};
        }
        const Real pdf = facets_pdf + diffuse_pdf(cosine);
        const Real share = facets_pdf / pdf;
        return {by_facets * share + diffuse_weight(cosine) * (Real(1) - share), pdf};
    }

    PT_HD LobeValue<Real> through(const LobeValue<Real>& of_glass) const {
        return {of_glass.weight, of_glass.pdf * glass_share};
    }
    // Keeps a lobe's pdf above 0: a path stores the pdf 0 where its vertex was not connected to a light.
    PT_HD static LobeValue<Real> kept(const LobeValue<Real>& value) {
        return {value.weight, max(value.pdf, Real(0x1p-60))};
    }

    PT_HD LobeSample<Real> sample_diffuse(Real u, Real v) const {
        const Vec3<Real> direction = Frame<Real>(glass.facets.normal).to_world(cosine_hemisphere(u, v));
        const Real cosine = max(dot(direction, glass.facets.normal), least_cosine<Real>);
        return {direction, cosine, kept(towards(direction, cosine))};
    }

    PT_HD LobeSample<Real> sample_refracted(const GgxFacet<Real>& facet, Real facet_cosine,
                                            const Refraction<Real>& refraction) const {
        LobeSample<Real> sample = glass.refracted(facet, facet_cosine, refraction);
        if (glass.boundary.k == Real(0)) {
            // A boundary between equal media bends no light, however its facets are turned.
            sample.value.weight = colour;
        }
        if (sample.cosine != Real(0) && are_facets_wide) {
            sample.value = kept(through(sample.value));
        }
        return sample;
    }
};

// After a sample by narrow facets lights that are hit count in full, though the diffuse lobe was connected to one.
template <class Real>
template <class At>
PT_HD inline bool PrincipledMaterial<Real>::scatter(const At& at, const Material<Real>& material) const {
    using Config = typename At::Config;
    const Principled<Config> lobe(*this, medium_behind(at.vertex, material), at.colour(glass.tint), at.roughness(alpha),
                                  -at.path.direction, at.vertex);
    const bool is_connected = at.connect_if_wide(lobe);
    LobeSample<Real> sample;
    if (!at.leave_by(lobe, sample)) {
        return false;
    }
    if (is_connected) {
        at.path.bsdf_pdf = sample.value.pdf > Real(0) ? kept_pdf<Config>(at.path, sample.value.pdf) : Real(0);
    }
    return true;
}

}  // namespace pt
