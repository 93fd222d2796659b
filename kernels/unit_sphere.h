// The unit sphere, for a ray f + t g; g of any length. Discriminant and roots as in Haines, Günther and Akenine-Möller,
// "Precision Improvements for Ray/Sphere Intersection", Ray Tracing Gems ch. 7, 2019. Spheres and ellipsoids are solved
// in this way in the object's own frame, so the arithmetic does not see the scene's scale.
// A ray that starts on the surface never uses an epsilon: it knows which root it starts from and takes the other one
// (docs/numerics.md S15: no self-hit and chords to 3e-7 for radii 1e-6 to 1e6).
#pragma once

#include "kernels/shape.h"

namespace pt {

template <class Real>
PT_HD inline Interval<Real> unit_sphere_interval(const Vec3<Real>& f, const Vec3<Real>& g) {
    const Real a = dot(g, g);
    const Real b = -dot(f, g);
    const Vec3<Real> closest = f + g * (b / a);
    const Real discriminant = Real(1) - dot(closest, closest);
    if (!(discriminant > Real(0))) {
        return {Real(0), Real(0), false};
    }
    const Real root = square_root(a * discriminant);
    const Real q = b < Real(0) ? b - root : b + root;
    const Real first = (dot(f, f) - Real(1)) / q;
    const Real second = q / a;
    return {min(first, second), max(first, second), true};
}

// The second root for a ray that starts on the unit sphere and runs inside it: t = -2 f.g / g.g.
template <class Real>
PT_HD inline Real unit_sphere_chord(const Vec3<Real>& f, const Vec3<Real>& g) {
    return max(Real(0), Real(-2) * dot(f, g) / dot(g, g));
}

}  // namespace pt
