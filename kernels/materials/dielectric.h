// A smooth dielectric (kernels/boundary.h) that may be tinted and may absorb (kernels/absorption.h).
#pragma once

#include "kernels/boundary.h"
#include "kernels/scattering.h"

namespace pt {

template <class Real>
struct DielectricMaterial {
    Vec3<Real> tint;  // colour factor on each transmission through the surface
    Boundary<Real> entering, leaving;

    PT_HD const Boundary<Real>& seen_from(bool inside) const { return inside ? leaving : entering; }

    // Picks reflection or transmission in proportion to their energy, so the weight of either is 1 (and the tint of the
    // transmission). Radiance is not scaled by the relative index squared: light that enters must leave, and sources
    // inside are not compared with outside.
    template <class At>
    PT_HD bool scatter(const At& at, const Material<Real>& material) const {
        using Config = typename At::Config;
        const bool passes = scatter_by<Config>(at.path, at.vertex, at.random_lobe());
        if constexpr (has<Config>(Feature::absorption)) {
            if (passes) {
                at.path.medium = medium_behind(at.vertex, material);
            }
        }
        return true;
    }

    // Reflects or refracts the path by u in [0, 1), and leaves path.medium alone; returns whether it is refracted.
    template <class Config>
    PT_HD bool scatter_by(Path<Real>& path, const Vertex<Real>& vertex, Real u) const {
        const Boundary<Real>& boundary = seen_from(vertex.inside);
        const Real cosine = cosine_of_incidence(path.direction, vertex.normal());
        const Refraction<Real> refraction = fresnel<Config>(boundary, cosine);
        if (u < refraction.reflectance) {
            leave_on_same_side(path, vertex, reflect(path.direction, vertex.normal()));
            return false;
        }
        path.throughput *= tint;
        leave_on_other_side(path, vertex, refract(boundary, path.direction, vertex.normal(), cosine, refraction.q));
        return true;
    }
};

}  // namespace pt
