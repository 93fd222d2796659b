// A ray prepared for box tests. The slab test of Kay and Kajiya (SIGGRAPH 1986) is made to err only towards a hit:
// relative rounding is covered by a factor (Ize, "Robust BVH Ray Traversal", JCGT 2 (2), 2013), the triangle test's own
// rounding, relative to the farthest vertex, by shifted ray origins (Woop, Benthin, Wald, JCGT 2 (1), 2013).
#pragma once

#include "kernels/triangle.h"

namespace pt {

// The bounds of a tree's root box along one axis.
struct BoxSpan {
    float low, high;
};

template <class Real>
struct BoxRay {
    Vec3<Real> near_origin, far_origin;  // ray origins shifted so that boxes are entered early and left late
    Vec3<Real> inverse;                  // reciprocal of the direction; infinite for components of 0

    // Prepares a ray for the box tests of a tree. Every operation rounds on its own in every arithmetic, so a ray
    // enters the same boxes on a GPU as on a CPU.
    PT_HD static BoxRay of(const Vec3<Real>& origin, const Vec3<Real>& direction, const BoxSpan (&spans)[3]) {
        const ShearedDirection<Real> s = ShearedDirection<Real>::of(direction);
        Vec3<Real> reach;
        for (int axis = 0; axis < 3; ++axis) {
            const Real below = absolute(static_cast<Real>(spans[axis].low) - origin[axis]);
            const Real above = absolute(static_cast<Real>(spans[axis].high) - origin[axis]);
            reach[axis] = max(below, above);
        }
        const Real along = component_of(reach, s.kz);
        BoxRay ray{origin, origin, {Real(1) / direction.x, Real(1) / direction.y, Real(1) / direction.z}};
        for (std::uint32_t axis = 0; axis < 3; ++axis) {
            if (axis == s.kz) {
                continue;
            }
            // Ray origins are shifted by a margin for six roundings of a triangle's sheared vertex, two of the shift.
            const Real sheared = rounded_product(absolute(axis == s.kx ? s.shear.x : s.shear.y), along);
            const Real margin = rounded_product(gamma<Real>(8), reach[axis] + sheared) +
                                rounded_product(gamma<Real>(2), absolute(origin[axis]));
            const Real shift = ray.inverse[axis] < Real(0) ? -margin : margin;
            ray.near_origin[axis] += shift;
            ray.far_origin[axis] -= shift;
        }
        return ray;
    }

    // Whether the ray enters boxes at the high side of an axis. A direction of -0 counts as negative: it has reciprocal
    // -infinity.
    PT_HD bool is_reversed(int axis) const { return inverse[axis] < Real(0); }

    // The ray parameter, at least 0, at which the ray enters a box, or `no_entry` if it misses the box or enters it
    // beyond best_t (not at best_t). The product 0 * infinity, on a side's plane, is NaN, and is passed over.
    static constexpr Real no_entry = Real(-1);
    PT_HD Real entry(const Vec3<Real>& entry_sides, const Vec3<Real>& exit_sides, const Real& best_t) const {
        Real nearest = Real(0), farthest = best_t;
        for (int axis = 0; axis < 3; ++axis) {
            nearest = keep_larger(nearest, (entry_sides[axis] - near_origin[axis]) * inverse[axis]);
            farthest = keep_smaller(farthest, (exit_sides[axis] - far_origin[axis]) * inverse[axis]);
        }
        // A box's entry distance is lowered by the roundings of two slab planes (three each) and of a triangle's t.
        nearest = nearest * (Real(1) - gamma<Real>(16));
        return nearest <= farthest ? nearest : no_entry;
    }
};

}  // namespace pt
