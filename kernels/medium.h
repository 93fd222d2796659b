// The homogeneous scattering medium of a subsurface body.
#pragma once

#include "kernels/math.h"

namespace pt {

template <class Real>
struct ScatteringMedium {
    Vec3<Real> sigma_s;            // scattering coefficient, 1 / scene unit
    Vec3<Real> sigma_t;            // extinction coefficient, sigma_a + sigma_s
    Vec3<Real> scattering_albedo;  // single-scattering albedo sigma_s / sigma_t, 0 where sigma_t is 0
    std::uint32_t grey;            // 1 if sigma_t is the same in all three channels
    Real g;                        // Henyey-Greenstein mean cosine
    // Parameters of guided random walks (kernels/guided_walk.h).
    Real guided_share;        // share of a walk's steps that are guided; 0: walks are not guided
    Vec3<Real> guide_decay;   // kappa per channel: decay rate of light's importance with depth, per mean free path
    Vec3<Real> guide_albedo;  // albedo of each channel's guide, guide_decay / artanh(guide_decay)

    // Whether the guided walks of all three colour channels are drawn alike.
    PT_HD constexpr bool has_one_guide() const {
        return grey != 0 && guide_decay.x == guide_decay.y && guide_decay.y == guide_decay.z;
    }
};

}  // namespace pt
