// Watertight ray/triangle intersection: two triangles that share an edge, vertex for vertex, let no ray through between
// them, and there is no epsilon. Woop, Benthin, Wald, "Watertight Ray/Triangle Intersection", JCGT 2 (1), 2013. Every
// accelerator calls this test and no other, and its operations are IEEE ones in a fixed order, none of them fused with
// another in any arithmetic: equal bits. (Where denormals are flushed to zero, in arithmetic=fast, nothing of this is
// promised.)
#pragma once

#include "kernels/math.h"

namespace pt {

template <class Real>
struct Triangle {
    Vec3<Real> a, b, c;
};

// The shear and the axis permutation that turn a ray's direction into the z axis, shared by the tests of all triangles
// against the ray. The direction need not be a unit vector; distances come in multiples of it.
template <class Real>
struct ShearedDirection {
    std::uint32_t kx, ky, kz;  // kz: the axis of the largest component of the ray's direction
    Vec3<Real> shear;          // shift in x and y per unit of z, and 1 / the direction's largest component

    PT_HD static ShearedDirection of(const Vec3<Real>& direction) {
        const Vec3<Real> size{absolute(direction.x), absolute(direction.y), absolute(direction.z)};
        ShearedDirection s;
        s.kz = size.x > size.y ? (size.x > size.z ? 0u : 2u) : (size.y > size.z ? 1u : 2u);
        s.kx = s.kz == 2u ? 0u : s.kz + 1u;
        s.ky = s.kx == 2u ? 0u : s.kx + 1u;
        const Real z = component_of(direction, s.kz);
        s.shear = {component_of(direction, s.kx) / z, component_of(direction, s.ky) / z, Real(1) / z};
        return s;
    }
};

template <class Real>
struct TriangleHit {
    Real t;        // distance to the triangle, in multiples of the ray direction's length
    Real det;      // determinant u + v + w, the sum of the edge functions
    Real u, v, w;  // barycentric weights of the triangle's corners a, b, c, times det
    bool hits;
    bool from_behind;  // the side on which a, b, c go round clockwise was hit
};

// Edge function ax by - ay bx: two triangles that share the edge from a to b get exact negatives of each other.
template <class Real>
PT_HD inline Real edge_function(Real ax, Real ay, Real bx, Real by) {
    return rounded_product(ax, by) - rounded_product(ay, bx);
}

// edge_function in double: its sign is exact for float, whose products fit a double.
template <class Real>
PT_HD inline double edge_function_in_double(Real ax, Real ay, Real bx, Real by) {
    return edge_function(static_cast<double>(ax), static_cast<double>(ay), static_cast<double>(bx),
                         static_cast<double>(by));
}

// Intersects a triangle where t > 0. On an edge both triangles that share it are hit: a closed mesh has no gap, and of
// equal distances the lowest primitive wins. A triangle seen edge-on (det = 0) is not hit. x, y, z: coordinates of the
// corners a, b and c along the axes kx, ky and kz, relative to the ray origin.
template <class Real>
PT_HD inline TriangleHit<Real> intersect_along(const Vec3<Real>& x, const Vec3<Real>& y, const Vec3<Real>& z,
                                               const Vec3<Real>& shear) {
    const Real az = z.x, bz = z.y, cz = z.z;
    const Real ax = x.x - rounded_product(shear.x, az), ay = y.x - rounded_product(shear.y, az);
    const Real bx = x.y - rounded_product(shear.x, bz), by = y.y - rounded_product(shear.y, bz);
    const Real cx = x.z - rounded_product(shear.x, cz), cy = y.z - rounded_product(shear.y, cz);
    TriangleHit<Real> hit{
        Real(0), Real(0), edge_function(cx, cy, bx, by), edge_function(ax, ay, cx, cy), edge_function(bx, by, ax, ay),
        false,   false};
    // An edge function rounded to 0 tells no side, but its exact sign does. In double, with no wider type, 0 is inside.
    if (hit.u != Real(0) && hit.v != Real(0) && hit.w != Real(0) &&
        ((hit.u < Real(0)) != (hit.v < Real(0)) || (hit.u < Real(0)) != (hit.w < Real(0)))) {
        return hit;
    }
    // The weights are formed in twice the precision for hits too: those of a needle triangle are differences of almost
    // equal products, and bounding boxes may only be culled by t if t is that of a point of the triangle.
    const double u = edge_function_in_double(cx, cy, bx, by), v = edge_function_in_double(ax, ay, cx, cy),
                 w = edge_function_in_double(bx, by, ax, ay), det = u + v + w;
    hit.u = static_cast<Real>(u);
    hit.v = static_cast<Real>(v);
    hit.w = static_cast<Real>(w);
    hit.det = static_cast<Real>(det);
    const bool below = u < 0.0 || v < 0.0 || w < 0.0;
    const bool above = u > 0.0 || v > 0.0 || w > 0.0;
    if ((below && above) || hit.det == Real(0)) {
        return hit;
    }
    hit.t = static_cast<Real>(rounded_product(rounded_dot(Vec3<double>(u, v, w), Vec3<double>(az, bz, cz)) / det,
                                              static_cast<double>(shear.z)));
    hit.hits = hit.t > Real(0);
    hit.from_behind = (hit.det < Real(0)) == (shear.z > Real(0));
    return hit;
}

// Coordinates of the corners of a triangle along one axis, relative to the ray origin.
template <class Real>
PT_HD inline Vec3<Real> corners_along(const Triangle<Real>& triangle, const Vec3<Real>& origin, std::uint32_t axis) {
    return {component_of(triangle.a - origin, axis), component_of(triangle.b - origin, axis),
            component_of(triangle.c - origin, axis)};
}

template <class Real>
PT_HD inline TriangleHit<Real> intersect(const Triangle<Real>& triangle, const Vec3<Real>& origin,
                                         const ShearedDirection<Real>& s) {
    return intersect_along(corners_along(triangle, origin, s.kx), corners_along(triangle, origin, s.ky),
                           corners_along(triangle, origin, s.kz), s.shear);
}

}  // namespace pt
