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

// A triangle relative to the ray origin, sheared so that the ray is the z axis, which passes through the origin.
template <class Real>
struct ShearedTriangle {
    Real ax, ay, bx, by, cx, cy;
    Vec3<Real> depth;  // of the corners a, b and c, in multiples of the largest component of the ray's direction
    Real u, v, w;      // edge functions, each opposite to its corner; a sign other than 0 is exact

    // x, y, z: coordinates of the corners a, b and c along the axes kx, ky and kz, relative to the ray origin.
    PT_HD static ShearedTriangle of(const Vec3<Real>& x, const Vec3<Real>& y, const Vec3<Real>& z,
                                    const Vec3<Real>& shear) {
        ShearedTriangle t;
        t.depth = z;
        t.ax = x.x - rounded_product(shear.x, z.x), t.ay = y.x - rounded_product(shear.y, z.x);
        t.bx = x.y - rounded_product(shear.x, z.y), t.by = y.y - rounded_product(shear.y, z.y);
        t.cx = x.z - rounded_product(shear.x, z.z), t.cy = y.z - rounded_product(shear.y, z.z);
        t.u = edge_function(t.cx, t.cy, t.bx, t.by);
        t.v = edge_function(t.ax, t.ay, t.cx, t.cy);
        t.w = edge_function(t.bx, t.by, t.ax, t.ay);
        return t;
    }
    // Whether the ray passes the edges on different sides. An edge function rounded to 0 tells no side.
    PT_HD bool is_missed() const {
        return u != Real(0) && v != Real(0) && w != Real(0) &&
               ((u < Real(0)) != (v < Real(0)) || (u < Real(0)) != (w < Real(0)));
    }
};

// Intersects a triangle where t > 0. On an edge both triangles that share it are hit: a closed mesh has no gap, and of
// equal distances the lowest primitive wins. A triangle seen edge-on (det = 0) is not hit. shear_z: 1 / the largest
// component of the ray's direction.
template <class Real>
PT_HD inline TriangleHit<Real> intersect(const ShearedTriangle<Real>& t, Real shear_z) {
    TriangleHit<Real> hit{Real(0), Real(0), t.u, t.v, t.w, false, false};
    if (t.is_missed()) {
        return hit;
    }
    // The weights are formed in twice the precision for hits too: those of a needle triangle are differences of almost
    // equal products, and bounding boxes may only be culled by t if t is that of a point of the triangle. An edge
    // function rounded to 0 has its exact sign in double; in double, with no wider type, 0 is inside.
    const double u = edge_function_in_double(t.cx, t.cy, t.bx, t.by),
                 v = edge_function_in_double(t.ax, t.ay, t.cx, t.cy),
                 w = edge_function_in_double(t.bx, t.by, t.ax, t.ay), det = u + v + w;
    hit.u = static_cast<Real>(u);
    hit.v = static_cast<Real>(v);
    hit.w = static_cast<Real>(w);
    hit.det = static_cast<Real>(det);
    const bool below = u < 0.0 || v < 0.0 || w < 0.0;
    const bool above = u > 0.0 || v > 0.0 || w > 0.0;
    if ((below && above) || hit.det == Real(0)) {
        return hit;
    }
    hit.t = static_cast<Real>(
        rounded_product(rounded_dot(Vec3<double>(u, v, w), Vec3<double>(t.depth)) / det, static_cast<double>(shear_z)));
    hit.hits = hit.t > Real(0);
    hit.from_behind = (hit.det < Real(0)) == (shear_z > Real(0));
    return hit;
}

// Intersects a triangle, given by the coordinates that ShearedTriangle::of takes, where t > 0.
template <class Real>
PT_HD inline TriangleHit<Real> intersect_along(const Vec3<Real>& x, const Vec3<Real>& y, const Vec3<Real>& z,
                                               const Vec3<Real>& shear) {
    return intersect(ShearedTriangle<Real>::of(x, y, z, shear), shear.z);
}

// What single precision tells of a ray and a triangle. A ray that passes all edges on the same side hits the triangle
// between its nearest and its farthest corner, so that most distances need not be computed, which takes double: on GPUs
// that are not made for data centres that is 32 to 64 times as slow.
struct TriangleGlance {
    bool misses;  // the ray surely misses the triangle
    bool hits;    // the ray surely hits it where nearest <= t < farthest
    float nearest, farthest;

    PT_HD static TriangleGlance of(const ShearedTriangle<float>& triangle, float shear_z) {
        // The exact test's t is off by less than this from that of a point of the triangle.
        constexpr float round_off = 4.76837158203125e-07f;
        // Above this edge functions are far enough from 0 for their sum not to be one that is rounded to 0.
        constexpr float least = 8.0779356694631609e-28f;
        const float a = triangle.depth.x * shear_z, b = triangle.depth.y * shear_z, c = triangle.depth.z * shear_z;
        const float nearest = min(a, min(b, c)), farthest = max(a, max(b, c));
        const float u = triangle.u, v = triangle.v, w = triangle.w;
        const bool is_inside = (u > least && v > least && w > least) || (u < -least && v < -least && w < -least);
        return {triangle.is_missed() || farthest < 0.0f, is_inside && nearest > least, nearest * (1.0f - round_off),
                farthest * (1.0f + round_off)};
    }
};

// The triangle that a search has met last, if it is surely the nearest so far: its distance is computed when another
// comes as near, or after the search. So the lanes of a warp compute distances at the same time, about once a ray.
// `limit` is the distance of the closest hit or, while a triangle waits, an upper bound of it; exact(slot) computes the
// hit of a triangle and lowers the limit to its distance, if it is nearer.
class WaitingTriangle {
public:
    PT_HD void start(float limit) { slot_ = none, nearest_ = limit; }

    template <class Exact>
    PT_HD void meet(float& limit, std::uint32_t slot, const TriangleGlance& glance, Exact&& exact) {
        if (glance.misses || glance.nearest > limit) {
            return;
        }
        if (glance.hits && glance.farthest < nearest_) {
            slot_ = slot;
            nearest_ = glance.nearest;
            limit = glance.farthest;
            return;
        }
        finish(exact);
        exact(slot);
        nearest_ = limit;
    }
    template <class Exact>
    PT_HD void finish(Exact&& exact) {
        if (slot_ != none) {
            exact(slot_);
            slot_ = none;
        }
    }

private:
    static constexpr std::uint32_t none = ~0u;

    std::uint32_t slot_;
    float nearest_;  // lower bound of the distance of the triangle that waits; the limit if none does
};

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
