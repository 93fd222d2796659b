// GGX microfacets as seen from one direction: the distribution of normals (Walter et al. 2007), Smith's masking,
// height-correlated for reflection (Heitz, JCGT 3(2), 2014), and sampling of visible normals (Heitz, JCGT 7(4), 2018).
// With c the cosine of a direction, s its sine and q = sqrt(c^2 + alpha^2 s^2), Smith's Lambda is (q - c) / (2 c), so
//   pdf of the mirrored direction = D / (2 (co + qo)),
//   unmasked share of the incoming light = ci (co + qo) / (co qi + ci qo) above, 2 ci / (ci + qi) below the surface.
#pragma once

#include "kernels/boundary.h"
#include "kernels/lobe.h"
#include "kernels/sampling.h"

namespace pt {

template <class Real>
struct GgxFacet {
    Vec3<Real> normal;
    // Facet normal in the stretched space, where the ellipsoid of facets is a sphere: its component along the surface
    // normal, and the squared length of the rest.
    Real along, across;
};

// GGX microfacets at one vertex as seen from the direction `outgoing`. All vectors are unit.
template <class Real>
struct GgxFacets {
    Vec3<Real> outgoing, normal;
    Real alpha;      // GGX roughness; 0: all facets lie in the surface
    Real cosine, q;  // cosine c of `outgoing` to the normal, and sqrt(c^2 + alpha^2 (1 - c^2))

    PT_HD GgxFacets(Real alpha_of, const Vec3<Real>& outgoing_to, const Vec3<Real>& normal_of)
        : outgoing(outgoing_to),
          normal(normal_of),
          alpha(alpha_of),
          cosine(max(dot(outgoing_to, normal_of), least_cosine<Real>)),
          q(stretched(cosine)) {}

    // Whether alpha is large enough for pdfs of directions in single precision: for a smaller alpha a pdf depends on
    // how the directions round.
    PT_HD bool are_wide() const { return alpha >= Real(0x1p-7); }

    // sqrt(c^2 + alpha^2 (1 - c^2)) of a cosine c, for Smith's masking; at least c, so no unmasked share is above 1.
    PT_HD Real stretched(Real c) const {
        return max(square_root(c * c + alpha * alpha * ((Real(1) - c) * (Real(1) + c))), c);
    }

    PT_HD Real share_above(Real incoming_cosine) const {
        const Real shared = incoming_cosine * q;
        return (incoming_cosine * cosine + shared) / (stretched(incoming_cosine) * cosine + shared);
    }

    // Share of refracted light not masked below the surface; `incoming_cosine` is to the normal on that side.
    PT_HD Real share_below(Real incoming_cosine) const {
        return Real(2) * incoming_cosine / (incoming_cosine + stretched(incoming_cosine));
    }

    PT_HD Real mirrored_pdf(Real distribution) const { return distribution / (Real(2) * (cosine + q)); }

    // Pdf of the direction mirrored by a facet (with are_wide()) whose normal is along a vector of any length, given by
    // its component along the surface normal, the squared length of the rest and the squared length of the whole.
    PT_HD Real mirrored_pdf(Real along, Real across_squared, Real square) const {
        const Real ratio = square / (alpha * alpha * (along * along) + across_squared);
        return mirrored_pdf(alpha * alpha * (ratio * ratio) * (Real(1) / pi<Real>));
    }

    // Density of the direction in which a facet drawn by sample() mirrors the outgoing direction.
    PT_HD Real mirrored_pdf(const GgxFacet<Real>& facet) const {
        const Real stretch = facet.along * facet.along + alpha * alpha * facet.across;
        return mirrored_pdf(stretch * stretch / (alpha * alpha) * (Real(1) / pi<Real>));
    }

    // Samples a facet that faces the viewer (visible normals), by a point on the projected disc in the stretched space,
    // where the ellipsoid of facets is a sphere; the disc's x is along the viewer's azimuth.
    PT_HD GgxFacet<Real> sample(Real u, Real v) const {
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

        // Slopes of the sampled facet in surface space: 0 for alpha = 0, where the facet normal is the surface normal.
        const Real scale = alpha / facet_z;
        const Real slope_x = scale * (facet_x * turn_x - a * turn_y);
        const Real slope_y = scale * (facet_x * turn_y + a * turn_x);
        const Real length = Real(1) / square_root(Real(1) + slope_x * slope_x + slope_y * slope_y);
        return {frame.to_world({slope_x * length, slope_y * length, length}), facet_z, facet_x * facet_x + a * a};
    }
};

}  // namespace pt
