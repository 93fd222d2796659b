// Rough conductor: mirror microfacets under the GGX distribution of normals (kernels/ggx.h), with Schlick's reflectance
// from the colour at normal incidence.
// Single scattering: what one facet sends into another is lost, so a rough white metal is darker than white; or, where
// the material asks for it, given back by scaling the lobe (kernels/ggx_gain.h).
#pragma once

#include "kernels/ggx.h"
#include "kernels/ggx_gain.h"
#include "kernels/scattering.h"

namespace pt {

// Schlick's approximation of a conductor's Fresnel reflectance (1994).
template <class Real>
PT_HD inline Vec3<Real> schlick_reflectance(const Vec3<Real>& at_normal_incidence, Real cosine) {
    const Real rest = Real(1) - min(cosine, Real(1));
    const Real square = rest * rest;
    return at_normal_incidence + (Vec3<Real>(Real(1)) - at_normal_incidence) * (square * square * rest);
}

// A rough conductor at one vertex, seen from one direction. All vectors are unit.
template <class Real, bool has_gain = false>
struct RoughConductor {
    static constexpr bool transmits = false, may_be_opaque = false;
    GgxFacets<Real> facets;
    Vec3<Real> reflectance;
    Vec3<Real> gain{Real(1)};  // factor on the lobe's weight that makes up for lost energy; 1: none

    PT_HD RoughConductor(const Vec3<Real>& reflectance_of, Real alpha, const Vec3<Real>& outgoing,
                         const Vec3<Real>& normal)
        : facets(alpha, outgoing, normal), reflectance(reflectance_of) {}

    // Narrow lobes are not connected to lights, as mirrors are not: hardly any connection would bring light. The choice
    // depends on the surface alone, so the expectation is the same either way.
    PT_HD bool is_connectable() const { return facets.are_wide(); }

    // Adds the compensation for multiple scattering to the lobe, in kernels that have it (kernels/ggx_gain.h).
    PT_HD void scatter_multiply() {
        gain = Vec3<Real>(Real(1)) + reflectance * ggx_gain(facets.cosine / facets.q, facets.alpha);
    }

    PT_HD Vec3<Real> weight(Real incoming_cosine, Real facet_cosine) const {
        const Vec3<Real> once = schlick_reflectance(reflectance, facet_cosine) * facets.share_above(incoming_cosine);
        if constexpr (has_gain) {
            return once * gain;
        } else {
            return once;
        }
    }

    // Value of a rough conductor's lobe for a direction above the surface; the lobe must be connectable.
    PT_HD LobeValue<Real> towards(const Vec3<Real>& incoming, Real incoming_cosine) const {
        const Real along = facets.cosine + incoming_cosine;
        const Vec3<Real> across = facets.outgoing + incoming - facets.normal * along;
        const Real across_squared = dot(across, across);
        const Real square = along * along + across_squared;
        return {weight(incoming_cosine, Real(0.5) * square_root(square)),
                facets.mirrored_pdf(along, across_squared, square)};
    }

    PT_HD LobeSample<Real> sample(Real u, Real v) const {
        const GgxFacet<Real> facet = facets.sample(u, v);
        LobeSample<Real> sample{reflect(-facets.outgoing, facet.normal), Real(0), {Vec3<Real>(Real(0)), Real(0)}};
        const Real incoming_cosine = dot(sample.direction, facets.normal);
        if (!(incoming_cosine > least_cosine<Real>)) {
            return sample;
        }
        sample.cosine = incoming_cosine;
        sample.value.weight = weight(incoming_cosine, max(dot(facets.outgoing, facet.normal), Real(0)));
        if (is_connectable()) {
            sample.value.pdf = facets.mirrored_pdf(facet);
        }
        return sample;
    }
};

template <class Real>
struct RoughConductorMaterial {
    Vec3<Real> reflectance;           // reflectance (linear RGB) at normal incidence
    Real alpha;                       // width of the GGX distribution, roughness^2
    std::uint32_t scatters_multiply;  // 1: energy lost between facets is given back

    // Scatters the path by a rough conductor, even at the last vertex of a final-bounce path, as a mirror does. A path
    // ends where the facet sends it into the surface.
    template <class At>
    PT_HD bool scatter(const At& at, const Material<Real>&) const {
        using Config = typename At::Config;
        constexpr bool has_gain = has<Config>(Feature::multiple_scattering);
        RoughConductor<Real, has_gain> lobe(at.colour(reflectance), at.roughness(alpha), -at.path.direction,
                                            at.vertex.normal());
        if constexpr (has_gain) {
            if (scatters_multiply != 0) {
                lobe.scatter_multiply();
            }
        }
        const bool is_connected = at.connect_if_wide(lobe);
        const LobeSample<Real> sample = lobe.sample(unit_interval<Real>(at.words.y), unit_interval<Real>(at.words.z));
        if (!(sample.cosine > Real(0))) {
            return false;
        }
        at.path.throughput *= sample.value.weight;
        leave_on_same_side(at.path, at.vertex, sample.direction);
        if (is_connected) {
            at.path.bsdf_pdf = kept_pdf<Config>(at.path, sample.value.pdf);
        }
        return true;
    }
};

}  // namespace pt
