// The point where a path meets a surface and is shaded, and the ways to leave it.
#pragma once

#include "kernels/intersect.h"

namespace pt {

// The point where a path meets a surface, oriented to the side that the path comes from.
template <class Real>
struct Vertex {
    Vec3<Real> position;
    Vec3<Real> surface_normal;  // unit normal on the incoming ray's side; not set for hits with a box face
    std::uint32_t object;
    bool inside;  // the incoming ray ran inside the object that it hit
    std::uint32_t material;
    SurfaceId hit;  // surface that was hit, with its box face where that is known
    std::uint32_t primitive = 0;
    // Unit normal that the vertex is shaded with, on the incoming ray's side: outward for a box face, hit from outside.
    PT_HD Vec3<Real> normal() const { return hit.has_face() ? face_normal<Real>(hit) : surface_normal; }
    // The dot product of a finite vector with the normal. A face's normal has one entry that is not 0, so it is one
    // entry of the vector.
    PT_HD Real dot_normal(const Vec3<Real>& v) const {
        if (!hit.has_face()) {
            return dot(v, surface_normal);
        }
        const Real along = component_of(v, hit.face_axis());
        return hit.face_looks_up() ? along : -along;
    }
};

// A vertex that may be shaded with another normal than the surface's own, which `unbent` keeps.
template <class Real>
struct BentVertex : Vertex<Real> {
    bool is_bent = false;
    Vec3<Real> unbent{};
};

// The type of vertex that a kernel has. Without shading normals it is plain Vertex: a larger one would take memory
// where vertices wait in queues.
template <class Config, bool bends = has<Config>(Feature::shading_normals)>
struct VertexOfKernel {
    using Type = Vertex<typename Config::Real>;
};
template <class Config>
struct VertexOfKernel<Config, true> {
    using Type = BentVertex<typename Config::Real>;
};
template <class Config>
using VertexOf = typename VertexOfKernel<Config>::Type;

// The surface's geometric unit normal, on the incoming ray's side: with it the surface's two sides are told apart.
template <class Config>
PT_HD inline Vec3<typename Config::Real> geometric_normal(const VertexOf<Config>& vertex) {
    if constexpr (has<Config>(Feature::shading_normals)) {
        return vertex.is_bent ? vertex.unbent : vertex.normal();
    } else {
        return vertex.normal();
    }
}

// Whether a direction away from the vertex is on the same side for the geometric normal as for the shading normal: on
// the side that the path comes from or, where it `passes`, on the other one.
template <class Config>
PT_HD inline bool is_on_one_side(const VertexOf<Config>& vertex, const Vec3<typename Config::Real>& direction,
                                 bool passes) {
    if constexpr (has<Config>(Feature::shading_normals)) {
        using Real = typename Config::Real;
        const Real cosine = dot(direction, vertex.unbent);
        return !vertex.is_bent || (passes ? cosine < Real(0) : cosine > Real(0));
    } else {
        return true;
    }
}

// Sends the path away from the vertex on the side that it came from.
template <class Real>
PT_HD inline void leave_on_same_side(Path<Real>& path, const Vertex<Real>& vertex, const Vec3<Real>& direction) {
    path.origin = vertex.position;
    path.direction = direction;
    path.origin_surface = SurfaceId::of(vertex.object, vertex.inside);
    path.primitive = vertex.primitive;
}

// Sends the path away from the vertex through the surface.
template <class Real>
PT_HD inline void leave_on_other_side(Path<Real>& path, const Vertex<Real>& vertex, const Vec3<Real>& direction) {
    path.origin = vertex.position;
    path.direction = direction;
    path.origin_surface = SurfaceId::of(vertex.object, !vertex.inside);
    path.primitive = vertex.primitive;
}

}  // namespace pt
