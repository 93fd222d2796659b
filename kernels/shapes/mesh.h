// Triangle meshes: an object is an instance of a mesh, and several may share one. A ray hits a primitive, one of the
// mesh's triangles, on either side; outside is the side on which a, b, c go round anticlockwise.
#pragma once

#include "kernels/mesh_view.h"
#include "kernels/naive.h"
#include "kernels/solid_angle.h"

namespace pt {

template <class Real>
PT_HD inline Vec3<Real> vector_of(const float (&v)[3]) {
    return {v[0], v[1], v[2]};
}

template <class Real>
struct MeshInstance {
    MeshView geometry;
    // The maps from the scene to the mesh's own space (row, offset), and back (column, centre). The only instance of a
    // mesh needs neither: its mesh has been placed in the scene already (is_placed).
    Vec3<Real> row[3], offset;
    Vec3<Real> column[3], centre;
    Vec3<float> low, high;  // bounding box of the mesh in the scene, relative to the eye
    float area;             // surface area of the mesh in the scene; 0: not emissive
    std::uint32_t is_placed;

    static constexpr const char* file_name = "mesh";
    static constexpr bool is_flat = true;
    static constexpr UnitShape unit_shape = UnitShape::none;
    static bool is_kind_of(const Placement&) { return true; }
    // Places the mesh without its geometry, which comes from the scene's meshes (harness/scene/scene_buffers.cpp).
    static MeshInstance placed(const Placement& object) {
        MeshInstance mesh{};
        for (int axis = 0; axis < 3; ++axis) {
            mesh.row[axis] = rounded_to<Real>(object.column[axis] / object.scale[axis]);
            mesh.offset[axis] = static_cast<Real>(-dot(object.column[axis], object.centre) / object.scale[axis]);
            mesh.column[axis] = rounded_to<Real>(object.column[axis] * object.scale[axis]);
        }
        mesh.centre = rounded_to<Real>(object.centre);
        return mesh;
    }
    static bool contains(const Vec3<double>&) { return false; }

    // Takes a direction into the mesh's own space. Every call rounds each entry in the same way: the triangle that a
    // traversal has hit must be hit by the same ray again when its surface point is asked for.
    PT_HD Vec3<Real> direction_in(const Vec3<Real>& v) const {
        return is_placed != 0 ? v : Vec3<Real>(rounded_dot(row[0], v), rounded_dot(row[1], v), rounded_dot(row[2], v));
    }
    PT_HD Vec3<Real> point_in(const Vec3<Real>& p) const { return is_placed != 0 ? p : direction_in(p) + offset; }
    PT_HD Vec3<Real> point_out(const Vec3<Real>& p) const {
        return is_placed != 0 ? p : centre + column[0] * p.x + column[1] * p.y + column[2] * p.z;
    }
    PT_HD Triangle<Real> triangle(std::uint32_t primitive) const {
        const Triangle<float>& t = geometry.triangles[primitive];
        return {Vec3<Real>(t.a), Vec3<Real>(t.b), Vec3<Real>(t.c)};
    }
};

// One triangle of a mesh, as a hit names it.
template <class Real>
struct MeshTriangle {
    const MeshInstance<Real>& mesh;
    std::uint32_t primitive;

    static constexpr bool is_flat = true;
};

// A mesh triangle's outward normal in the scene; in double, as a small triangle's edge products leave float's range.
template <class Real>
PT_HD inline Vec3<double> scaled_normal(const MeshTriangle<Real>& met) {
    const Triangle<Real> t = met.mesh.triangle(met.primitive);
    const Vec3<double> a(t.a);
    const Vec3<double> n = cross(Vec3<double>(t.b) - a, Vec3<double>(t.c) - a);
    const MeshInstance<Real>& mesh = met.mesh;
    return mesh.is_placed != 0
               ? n
               : Vec3<double>(mesh.row[0]) * n.x + Vec3<double>(mesh.row[1]) * n.y + Vec3<double>(mesh.row[2]) * n.z;
}
template <class Real>
PT_HD inline Vec3<Real> normal_of(const MeshTriangle<Real>& met) {
    const Vec3<double> n = scaled_normal(met);
    return Vec3<Real>(n * (1.0 / square_root(dot(n, n))));
}

template <class Real>
PT_HD inline Real length_of(const Vec3<Real>& v) {
    return square_root(dot(v, v));
}

template <class Real>
PT_HD inline Real largest_component(const Vec3<Real>& v) {
    return max(absolute(v.x), max(absolute(v.y), absolute(v.z)));
}

// A point of a triangle by its weights of a, b and c, and how far from the triangle's plane rounding may put it.
template <class Real>
struct KeptWeights {
    Vec3<Real> weights;
    Real reach;  // how far rounding may put the point off the triangle's plane, in the mesh's units
};

// Moves barycentric weights off the edges by twice a bound on the rounding of the point formed with them: a path that
// starts in a corner is then in front of the neighbour's plane, not on it or behind it. A triangle thinner than that
// bound cannot be kept off its long edges, and is left alone there. Lengths are in units of a power of two near the
// triangle's size: the product of four of them would leave the range of float at 2^32.
template <class Real>
PT_HD inline KeptWeights<Real> off_the_edges(const Vec3<Real>& weights, const Triangle<Real>& t) {
    Vec3<Real> sides[3] = {t.c - t.b, t.a - t.c, t.b - t.a};
    const Real unit = power_of_two_below(max(largest_component(sides[1]), largest_component(sides[2])));
    const Real per_unit = reciprocal_of_power_of_two(unit);
    for (Vec3<Real>& side : sides) {
        side = side * per_unit;
    }
    const Real twice_area = length_of(cross(sides[0], sides[1]));
    const Real reach = gamma<Real>(16) * ((absolute(t.a.x) + absolute(t.a.y) + absolute(t.a.z)) * per_unit +
                                          length_of(sides[2]) + length_of(sides[1]));
    Vec3<Real> kept = weights;
    for (int i = 0; i < 3; ++i) {
        const Real margin = reach * length_of(sides[i]) / twice_area;
        if (margin < Real(0.25) && kept[i] < margin) {
            kept[i] = margin;
        }
    }
    return {kept * (Real(1) / (kept.x + kept.y + kept.z)), Real(0.5) * reach * unit};
}

// A bound on how far a point, taken from the mesh's own space to the scene, may be off its triangle's plane when a ray
// from it is taken back: the rounding along each axis of the mesh, as far as it lies along the normal.
template <class Real>
PT_HD inline Real reach_of_instance(const MeshInstance<Real>& mesh, const Vec3<Real>& local, const Vec3<Real>& placed,
                                    const Vec3<Real>& normal, Real local_reach) {
    Real reach = gamma<Real>(8) * (absolute(placed.x) + absolute(placed.y) + absolute(placed.z) +
                                   absolute(mesh.centre.x) + absolute(mesh.centre.y) + absolute(mesh.centre.z));
    for (int i = 0; i < 3; ++i) {
        const Vec3<Real>& row = mesh.row[i];
        const Real rounded = absolute(row.x * placed.x) + absolute(row.y * placed.y) + absolute(row.z * placed.z) +
                             absolute(mesh.offset[i]) + absolute(local[i]);
        reach += absolute(dot(normal, mesh.column[i])) * (gamma<Real>(8) * rounded + local_reach);
    }
    return reach;
}

// Moves the hit point in front of the triangle's plane, to the side that the ray comes from, by the bound on its
// rounding (as pbrt's OffsetRayOrigin): a point that rounding puts behind the plane would hit a neighbour in the same
// plane from behind, and be outside.
template <class Real>
PT_HD inline SurfacePoint<Real> surface_point(const MeshTriangle<Real>& met, const Vec3<Real>& origin,
                                              const Vec3<Real>& direction, Real, bool = false) {
    const MeshInstance<Real>& mesh = met.mesh;
    const Triangle<Real> t = mesh.triangle(met.primitive);
    const TriangleHit<Real> hit =
        intersect(t, mesh.point_in(origin), ShearedDirection<Real>::of(mesh.direction_in(direction)));
    const KeptWeights<Real> kept = off_the_edges(Vec3<Real>(hit.u, hit.v, hit.w) * (Real(1) / hit.det), t);
    const Vec3<Real> local = t.a * kept.weights.x + t.b * kept.weights.y + t.c * kept.weights.z;
    const Vec3<Real> placed = mesh.point_out(local), normal = normal_of(met);
    const Real reach = mesh.is_placed != 0 ? kept.reach : reach_of_instance(mesh, local, placed, normal, kept.reach);
    return {placed + normal * (hit.from_behind ? -reach : reach), normal};
}

// Triangle of a mesh with the first cumulative area above `area`, by binary search.
template <class Real>
PT_HD inline std::uint32_t primitive_at_area(const MeshInstance<Real>& mesh, float area) {
    std::uint32_t low = 0, high = mesh.geometry.triangle_count - 1;
    while (low < high) {
        const std::uint32_t middle = low + (high - low) / 2;
        if (mesh.geometry.cumulative_area[middle] > area) {
            high = middle;
        } else {
            low = middle + 1;
        }
    }
    return low;
}

// Samples a point of a mesh uniformly by area: the triangle by w, the point in it by Turk's map of the unit square
// ("Generating random points in triangles", Graphics Gems, 1990).
template <class Real>
PT_HD inline LightSample<Real> sample_point(const MeshInstance<Real>& mesh, Real u, Real v, Real w) {
    const std::uint32_t primitive = primitive_at_area(
        mesh, static_cast<float>(w) * mesh.geometry.cumulative_area[mesh.geometry.triangle_count - 1]);
    const Triangle<Real> t = mesh.triangle(primitive);
    const Real root = square_root(u);
    const Vec3<Real> weights = off_the_edges(Vec3<Real>(Real(1) - root, root * (Real(1) - v), root * v), t).weights;
    return {mesh.point_out(t.a * weights.x + t.b * weights.y + t.c * weights.z),
            normal_of(MeshTriangle<Real>{mesh, primitive}), static_cast<Real>(mesh.area), primitive};
}

// 1 / pdf, by solid angle, with which sample_direction draws the direction of a ray that hits a triangle at `distance`.
template <class Real>
PT_HD inline Real inverse_direction_pdf(const MeshTriangle<Real>& met, const Vec3<Real>&, const Vec3<Real>& direction,
                                        Real distance) {
    const Real away = distance / square_root(static_cast<Real>(met.mesh.area));
    return absolute(dot(normal_of(met), direction)) / (away * away);
}

template <class Real>
PT_HD inline DirectionSample<Real> sample_direction(const MeshInstance<Real>& mesh, const Vec3<Real>& observer, Real u,
                                                    Real v, Real w) {
    const LightSample<Real> point = sample_point(mesh, u, v, w);
    const Vec3<Real> to_point = point.position - observer;
    const Real distance = length_of(to_point);
    if (!(distance > Real(0))) {
        return {{Real(0), Real(0), Real(1)}, Real(0)};
    }
    const Vec3<Real> direction = to_point * (Real(1) / distance);
    return {direction, inverse_direction_pdf(MeshTriangle<Real>{mesh, point.primitive}, observer, direction, distance),
            point.primitive};
}

template <class Real>
PT_HD inline Real size_of(const MeshInstance<Real>& mesh) {
    const Vec3<float> half = (mesh.high - mesh.low) * 0.5f;
    return max(Real(half.x), max(Real(half.y), Real(half.z)));
}

template <class Real>
PT_HD inline Bounds<Real> bounds_of(const MeshInstance<Real>& mesh) {
    return {Vec3<Real>(mesh.low), Vec3<Real>(mesh.high)};
}

PT_HD inline MeshInstance<double> widened(const MeshInstance<float>& m) {
    return {m.geometry,
            {widened(m.row[0]), widened(m.row[1]), widened(m.row[2])},
            widened(m.offset),
            {widened(m.column[0]), widened(m.column[1]), widened(m.column[2])},
            widened(m.centre),
            m.low,
            m.high,
            m.area,
            m.is_placed};
}

// Nothing is inside a mesh: the loader refuses a subsurface body of one.
template <class Real>
PT_HD inline Real distance_out_of(const MeshInstance<Real>&, const Vec3<Real>&, const Vec3<Real>&, bool) {
    return Real(0);
}

namespace naive {

template <class Real>
PT_HD inline Interval<Real> interval(const MeshInstance<Real>&, const Vec3<Real>&, const Vec3<Real>&) {
    return {Real(0), Real(0), false};
}

template <class Real>
PT_HD inline Real inverse_direction_pdf(const MeshTriangle<Real>& met, const Vec3<Real>& observer,
                                        const Vec3<Real>& direction, Real distance) {
    return pt::inverse_direction_pdf(met, observer, direction, distance);
}

template <class Real>
PT_HD inline DirectionSample<Real> sample_direction(const MeshInstance<Real>& mesh, const Vec3<Real>& observer, Real u,
                                                    Real v, Real w) {
    return pt::sample_direction(mesh, observer, u, v, w);
}

template <class Real>
PT_HD inline Vec3<Real> normal_at(const MeshTriangle<Real>& met, const Vec3<Real>&) {
    return normal_of(met);
}

}  // namespace naive

}  // namespace pt
