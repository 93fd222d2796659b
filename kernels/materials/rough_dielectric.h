// Rough dielectric: smooth microfacets under the GGX distribution of normals (kernels/ggx.h; Walter et al. 2007), each
// of which reflects and refracts as in kernels/boundary.h. Radiance is not scaled by n^2 either.
// With n = index ahead / index behind, c the cosine of incidence on the facet and q = n cos(theta_t), the facet normal
// is along +-(outgoing + n incoming), and the pdf of a refracted direction is the facet's mirrored pdf times
//   4 c n^2 cos(theta_t) / (q - c)^2 = 4 c n q (q + c)^2 / k^2.
// Single scattering; refracted light is masked on each side independently (Smith; Walter et al., eq. 23).
#pragma once

#include "kernels/ggx.h"
#include "kernels/materials/dielectric.h"

namespace pt {

// The lobe of a rough dielectric at one vertex, seen from one direction. All vectors are unit.
template <class ConfigT>
struct RoughDielectric {
    using Config = ConfigT;
    using Real = typename Config::Real;
    static constexpr bool transmits = true, may_be_opaque = false;

    GgxFacets<Real> facets;
    Boundary<Real> boundary;
    Vec3<Real> tint;
    std::uint32_t medium_beyond;

    // `beyond`: material whose medium absorbs along the path once it has crossed the surface, or `no_medium`.
    PT_HD RoughDielectric(const DielectricMaterial<Real>& glass, std::uint32_t beyond, Real alpha,
                          const Vec3<Real>& outgoing, const Vertex<Real>& vertex)
        : facets(alpha, outgoing, vertex.normal()),
          boundary(glass.seen_from(vertex.inside)),
          tint(glass.tint),
          medium_beyond(beyond) {}

    // Narrow lobes are not connected to lights, as smooth glass is not. Nearly equal indices bend light less than
    // facets are turned, which narrows the lobe.
    PT_HD bool is_connectable() const {
        return facets.are_wide() && facets.alpha * absolute(boundary.k) >= Real(0x1p-7);
    }

    // Value of a rough dielectric's lobe for a direction on either side; the lobe must be connectable. `cosine`: of the
    // direction to the normal, not 0.
    PT_HD LobeValue<Real> towards(const Vec3<Real>& incoming, Real cosine) const {
        const bool passes = !(cosine > Real(0));
        const Real index = passes ? boundary.relative_ior : Real(1);
        const Real along = facets.cosine + index * cosine;
        const Vec3<Real> across = facets.outgoing + incoming * index - facets.normal * along;
        const Real across_squared = dot(across, across);
        const Real square = along * along + across_squared;
        const Real length = (along < Real(0) ? Real(-1) : Real(1)) * square_root(square);
        // Cosines of the outgoing and the incoming direction to the facet normal, turned to the surface normal's side.
        const Real between = dot(facets.outgoing, incoming);
        const Real facet_cosine = passes ? (Real(1) + index * between) / length : Real(0.5) * length;
        const Real beyond = (between + index) / length;
        if (!(facet_cosine > Real(0)) || (passes && !(beyond < Real(0)))) {
            return {Vec3<Real>(Real(0)), Real(0)};
        }
        const Refraction<Real> refraction = fresnel<Config>(boundary, min(facet_cosine, Real(1)));
        return value(passes, absolute(cosine), min(facet_cosine, Real(1)), refraction,
                     facets.mirrored_pdf(along, across_squared, square));
    }

    // Samples a facet and reflects or refracts by it, as `lobe` in [0, 1) picks in proportion to their energy. The
    // sample's cosine is below 0 where it is refracted.
    PT_HD LobeSample<Real> sample(Real lobe, Real u, Real v) const {
        const GgxFacet<Real> facet = facets.sample(u, v);
        const Vec3<Real> direction = -facets.outgoing;
        const Real facet_cosine = cosine_of_incidence(direction, facet.normal);
        const Refraction<Real> refraction = fresnel<Config>(boundary, facet_cosine);
        const bool passes = !(lobe < refraction.reflectance);
        LobeSample<Real> sample{passes ? refract(boundary, direction, facet.normal, facet_cosine, refraction.q)
                                       : reflect(direction, facet.normal),
                                Real(0),
                                {Vec3<Real>(Real(0)), Real(0)}};
        const Real cosine = dot(sample.direction, facets.normal);
        if (!((passes ? -cosine : cosine) > least_cosine<Real>)) {
            return sample;
        }
        sample.cosine = cosine;
        sample.value = value(passes, absolute(cosine), facet_cosine, refraction,
                             is_connectable() ? facets.mirrored_pdf(facet) : Real(0));
        return sample;
    }

    // Sample of a rough dielectric's lobe that is refracted by a facet which sample() has drawn.
    PT_HD LobeSample<Real> refracted(const GgxFacet<Real>& facet, Real facet_cosine,
                                     const Refraction<Real>& refraction) const {
        LobeSample<Real> sample{refract(boundary, -facets.outgoing, facet.normal, facet_cosine, refraction.q),
                                Real(0),
                                {Vec3<Real>(Real(0)), Real(0)}};
        const Real cosine = dot(sample.direction, facets.normal);
        if (-cosine > least_cosine<Real>) {
            sample.cosine = cosine;
            sample.value =
                value(true, -cosine, facet_cosine, refraction, is_connectable() ? facets.mirrored_pdf(facet) : Real(0));
        }
        return sample;
    }

private:
    // Value of a rough dielectric's lobe for a direction by a facet; `mirrored`: pdf of the facet's mirrored direction.
    PT_HD LobeValue<Real> value(bool passes, Real cosine, Real facet_cosine, const Refraction<Real>& refraction,
                                Real mirrored) const {
        if (!passes) {
            return {Vec3<Real>(facets.share_above(cosine)), mirrored * refraction.reflectance};
        }
        const Vec3<Real> weight = tint * facets.share_below(cosine);
        if (!(mirrored > Real(0))) {
            return {weight, Real(0)};
        }
        const Real sum = (refraction.q + facet_cosine) / boundary.k;
        const Real spread = Real(4) * facet_cosine * boundary.relative_ior * refraction.q * (sum * sum);
        return {weight, mirrored * ((Real(1) - refraction.reflectance) * spread)};
    }
};

template <class Real>
struct RoughDielectricMaterial {
    DielectricMaterial<Real> glass;
    Real alpha;  // width of the GGX distribution, roughness^2

    template <class At>
    PT_HD bool scatter(const At& at, const Material<Real>& material) const {
        using Config = typename At::Config;
        const RoughDielectric<Config> lobe(glass, medium_behind(at.vertex, material), at.roughness(alpha),
                                           -at.path.direction, at.vertex);
        const bool is_connected = at.connect_if_wide(lobe);
        LobeSample<Real> sample;
        if (!at.leave_by(lobe, sample)) {
            return false;
        }
        if (is_connected) {
            // The pdf that the path stores is never 0, since 0 would mean that the vertex was not connected to a light.
            constexpr Real least = Real(0x1p-60);
            at.path.bsdf_pdf = kept_pdf<Config>(at.path, max(sample.value.pdf, least));
        }
        return true;
    }
};

}  // namespace pt
