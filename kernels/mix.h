// Imperfect specular: a mirror with probability p, a Lambertian surface otherwise. The lobe is drawn with exactly the
// weight that it has in the BSDF, so p cancels from the throughput; p = 0 and p = 1 are the pure materials bit for bit.
#pragma once

#include "kernels/mirror.h"

namespace pt {

// Whether u in [0, 1) chooses the mirror: never at probability 0, always at 1.
template <class Real>
PT_HD constexpr bool chooses_mirror(Real u, Real mirror_probability) {
    return u < mirror_probability;
}

}  // namespace pt
