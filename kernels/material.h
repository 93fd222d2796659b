// One material as the kernels read it. Which fields mean something depends on the type; the scene loader fills the rest
// with neutral values, so no kernel tests for "present".
#pragma once

#include "kernels/math.h"

namespace pt {

enum class MaterialType : std::uint32_t {
    diffuse,
    emitter,
    mirror,
    mix,
    dielectric,
    subsurface,
    rough_conductor,
    rough_dielectric,
    principled
};

// Whether light passes the material by a single refraction.
PT_HD constexpr bool is_glass(MaterialType type) {
    return type == MaterialType::dielectric || type == MaterialType::rough_dielectric;
}

// A dielectric boundary seen from one side. relative_ior = ior ahead / ior behind; `k` = (n - 1)(n + 1) is formed in
// double at load, where 1 - n^2 cannot cancel.
template <class Real>
struct Boundary {
    Real relative_ior;
    Real inverse_relative_ior;
    Real k;
};

template <class Real>
struct Material {
    MaterialType type;
    std::uint32_t emits;  // 1 if emission is not black
    Vec3<Real> emission;  // radiance, linear RGB
    union {
        Vec3<Real> albedo;       // diffuse, mix; principled: base colour
        Vec3<Real> guide_decay;  // subsurface that is guided (guided_walk.h): decay with depth, per mean free path
    };
    union {
        Vec3<Real> reflectance;   // mirror, mix; rough_conductor: at normal incidence
        Vec3<Real> guide_albedo;  // subsurface that is guided: guide_decay / artanh(guide_decay)
    };
    union {
        Real mirror_probability;  // mix
        Real metallic;            // principled
        Real guided_share;        // subsurface: the share of steps that is guided (kernels/guided_walk.h); 0: none
    };
    Vec3<Real> tint;                   // dielectrics: factor on each transmission
    Boundary<Real> entering, leaving;  // dielectrics, subsurface, principled
    std::uint32_t has_boundary;        // subsurface: 1 if ior != 1
    union {
        std::uint32_t absorbs;            // dielectrics: 1 if sigma_a is not 0
        std::uint32_t scatters_multiply;  // rough_conductor: 1 if what facets send into others is not lost
    };
    Vec3<Real> sigma_a;            // 1 / scene unit
    Vec3<Real> sigma_s;            // subsurface, 1 / scene unit
    Vec3<Real> sigma_t;            // sigma_a + sigma_s
    Vec3<Real> scattering_albedo;  // sigma_s / sigma_t, 0 where sigma_t is 0
    union {
        std::uint32_t grey;  // 1 if the three sigma_t are equal
        Real transmission;   // principled
    };
    union {
        Real g;      // subsurface: Henyey-Greenstein mean cosine
        Real alpha;  // rough materials: width of the GGX distribution, roughness^2
    };
    std::uint32_t max_scatterings;  // cap of one walk

    // Whether the guided walks of all three colour channels are drawn alike.
    PT_HD constexpr bool has_one_guide() const {
        return grey != 0 && guide_decay.x == guide_decay.y && guide_decay.y == guide_decay.z;
    }
};

// What most hits need of an object's material, in one 16-byte read.
template <class Real>
struct alignas(4 * sizeof(Real)) Surface {
    Vec3<Real> colour;  // albedo of a diffuse, reflectance of a mirror, radiance of an emitter material
    MaterialType type;
};

}  // namespace pt
