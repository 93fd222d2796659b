// A rough metal: mirrors of one kind under the GGX distribution of normals (Walter et al. 2007), with the
// height-correlated masking and shadowing of Smith (Heitz, JCGT 3(2), 2014), sampled by the normals that can be seen
// (Heitz, JCGT 7(4), 2018), and Schlick's reflectance, which takes the colour at normal incidence.
// Single scattering: what one facet sends into another is lost, so a rough white metal is darker than white.
// With c the cosine of a direction, s its sine and q = sqrt(c^2 + alpha^2 s^2), Smith's Lambda is (q - c) / (2 c), so
//   density of wi = D / (2 (co + qo)),   BSDF * ci / density = F ci (co + qo) / (co qi + ci qo) <= F.
#pragma once

#include "kernels/mirror.h"

namespace pt {

// The least cosine that counts as above the surface: squares of it stay within single precision.
template <class Real>
inline constexpr Real least_cosine = Real(0x1p-40);

// What a lobe sends in one direction.
template <class Real>
struct LobeValue {
    Vec3<Real> weight;  // BSDF * cosine / density
    Real pdf;           // density, by solid angle, with which the lobe draws the direction
};

template <class Real>
struct LobeSample {
    Vec3<Real> direction;
    Real cosine;  // not above 0: the direction leads into the surface, and the rest is not set
    LobeValue<Real> value;
};

// Schlick 1994.
template <class Real>
PT_HD inline Vec3<Real> schlick_reflectance(const Vec3<Real>& at_normal_incidence, Real cosine) {
    const Real rest = Real(1) - min(cosine, Real(1));
    const Real square = rest * rest;
    return at_normal_incidence + (Vec3<Real>(Real(1)) - at_normal_incidence) * (square * square * rest);
}

// A rough conductor at one vertex, seen from one direction. All vectors are unit.
template <class Real>
struct RoughConductor {
    Vec3<Real> reflectance, outgoing, normal;
    Real alpha;      // 0: a mirror
    Real cosine, q;  // of `outgoing`

    PT_HD RoughConductor(const Vec3<Real>& reflectance_of, Real alpha_of, const Vec3<Real>& outgoing_to,
                         const Vec3<Real>& normal_of)
        : reflectance(reflectance_of),
          outgoing(outgoing_to),
          normal(normal_of),
          alpha(alpha_of),
          cosine(max(dot(outgoing_to, normal_of), least_cosine<Real>)),
          q(stretched(cosine)) {}

    // A narrower lobe is not connected to lights, as a mirror is not: in single precision its density hangs on the
    // rounding of directions, and next to no connection would bring light. It depends on the surface alone, so either
    // way the expectation is the same.
    PT_HD bool is_connectable() const { return alpha >= Real(0x1p-7); }

    // Never below c, so that no weight is above its reflectance.
    PT_HD Real stretched(Real c) const {
        return max(square_root(c * c + alpha * alpha * ((Real(1) - c) * (Real(1) + c))), c);
    }

    PT_HD Vec3<Real> weight(Real incoming_cosine, Real facet_cosine) const {
        const Real shared = incoming_cosine * q;
        const Real shadowing = (incoming_cosine * cosine + shared) / (stretched(incoming_cosine) * cosine + shared);
        return schlick_reflectance(reflectance, facet_cosine) * shadowing;
    }

    // Of a connectable lobe, for a direction above the surface. The half vector is not normalised: its square divides
    // out of D.
    PT_HD LobeValue<Real> towards(const Vec3<Real>& incoming, Real incoming_cosine) const {
        const Real along = cosine + incoming_cosine;
        const Vec3<Real> across = outgoing + incoming - normal * along;
        const Real across_squared = dot(across, across);
        const Real square = along * along + across_squared;
        const Real ratio = square / (alpha * alpha * (along * along) + across_squared);
        return {weight(incoming_cosine, Real(0.5) * square_root(square)),
                density(alpha * alpha * (ratio * ratio) * (Real(1) / pi<Real>))};
    }

    PT_HD Real density(Real distribution) const { return distribution / (Real(2) * (cosine + q)); }

    // In the space where the facets' ellipsoid is a sphere: a point of its disc that faces the viewer, and the normal
    // there. x is along the viewer's azimuth.
    PT_HD LobeSample<Real> sample(Real u, Real v) const {
        const Frame<Real> frame(normal);
        const Real x = dot(outgoing, frame.tangent);
        const Real y = dot(outgoing, frame.bitangent);
        const Real sine_squared = x * x + y * y;
        const bool is_upright = !(sine_squared > Real(1e-30));
        const Real sine = is_upright ? Real(0) : square_root(sine_squared);
        const Real turn_x = is_upright ? Real(1) : x / sine;
        const Real turn_y = is_upright ? Real(0) : y / sine;
        const Real view_z = cosine / q;
        const Real view_x = alpha * sine / q;

        const Vec2<Real> disc = concentric_disc(u, v);
        const Real visible = Real(0.5) * (Real(1) + view_z);
        const Real a = disc.x;
        const Real b = (Real(1) - visible) * square_root(max(Real(0), Real(1) - a * a)) + visible * disc.y;
        const Real c = square_root(max(Real(0), Real(1) - a * a - b * b));
        const Real facet_x = c * view_x - b * view_z;
        const Real facet_z = max(b * view_x + c * view_z, least_cosine<Real>);

        // Back in the surface's space, as slopes: of a mirror they are 0, and the facet's normal is the surface's.
        const Real scale = alpha / facet_z;
        const Real slope_x = scale * (facet_x * turn_x - a * turn_y);
        const Real slope_y = scale * (facet_x * turn_y + a * turn_x);
        const Real length = Real(1) / square_root(Real(1) + slope_x * slope_x + slope_y * slope_y);
        const Vec3<Real> facet = frame.to_world({slope_x * length, slope_y * length, length});

        LobeSample<Real> sample{reflect(-outgoing, facet), Real(0), {Vec3<Real>(Real(0)), Real(0)}};
        const Real incoming_cosine = dot(sample.direction, normal);
        if (!(incoming_cosine > least_cosine<Real>)) {
            return sample;
        }
        sample.cosine = incoming_cosine;
        sample.value.weight = weight(incoming_cosine, max(dot(outgoing, facet), Real(0)));
        if (is_connectable()) {
            const Real across = facet_x * facet_x + a * a;
            const Real stretch = facet_z * facet_z + alpha * alpha * across;
            sample.value.pdf = density(stretch * stretch / (alpha * alpha) * (Real(1) / pi<Real>));
        }
        return sample;
    }
};

}  // namespace pt
