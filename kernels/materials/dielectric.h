// A smooth dielectric (kernels/boundary.h) that may be tinted and may absorb (kernels/absorption.h).
#pragma once

#include "kernels/boundary.h"
#include "kernels/scattering.h"

namespace pt {

template <class Real>
struct DielectricMaterial {
    Vec3<Real> tint;  // factor on each transmission
    Boundary<Real> entering, leaving;

    PT_HD const Boundary<Real>& seen_from(bool inside) const { return inside ? leaving : entering; }

    // Picks reflection or transmission in proportion to their energy, so the weight of either is 1 (and the tint of the
    // transmission). Radiance is not scaled by n^2: what enters must leave, and sources inside are not compared with
    // outside.
    template <class At>
    PT_HD bool scatter(const At& at, const Material<Real>& material) const {
        using Config = typename At::Config;
        Path<Real>& path = at.path;
        const VertexOf<Config>& vertex = at.vertex;
        const Boundary<Real>& boundary = seen_from(vertex.inside);
        const Real cosine = cosine_of_incidence(path.direction, vertex.normal());
        const Refraction<Real> refraction = fresnel<Config>(boundary, cosine);
        if (at.random_lobe() < refraction.reflectance) {
            leave_on_same_side(path, vertex, reflect(path.direction, vertex.normal()));
            return true;
        }
        path.throughput *= tint;
        leave_on_other_side(path, vertex, refract(boundary, path.direction, vertex.normal(), cosine, refraction.q));
        if constexpr (has<Config>(Feature::absorption)) {
            path.medium = medium_behind(vertex, material);
        }
        return true;
    }
};

}  // namespace pt
