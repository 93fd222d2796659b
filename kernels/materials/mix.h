// Imperfect specular: a mirror with probability p, a Lambertian surface otherwise. The lobe is drawn with exactly the
// weight that it has in the BSDF, so p cancels from the throughput; p = 0 and p = 1 are the pure materials bit for bit.
#pragma once

#include "kernels/materials/diffuse.h"
#include "kernels/materials/mirror.h"

namespace pt {

// Whether u in [0, 1) chooses the mirror: never at probability 0, always at 1.
template <class Real>
PT_HD constexpr bool chooses_mirror(Real u, Real mirror_probability) {
    return u < mirror_probability;
}

template <class Real>
struct MixMaterial {
    Vec3<Real> albedo;
    Vec3<Real> reflectance;
    Real mirror_probability;

    template <class At>
    PT_HD bool scatter(const At& at, const Material<Real>&) const {
        if (chooses_mirror(at.random_lobe(), mirror_probability)) {
            scatter_mirror(at.path, at.vertex, reflectance);
            return true;
        }
        return shade_diffuse(at, at.colour(albedo));
    }
};

}  // namespace pt
