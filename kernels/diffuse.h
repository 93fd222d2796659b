// Lambertian reflection, sampled by the cosine: BSDF * cosine / density = albedo.
#pragma once

#include "kernels/intersect.h"
#include "kernels/sampling.h"

namespace pt {

// Where a path meets a surface, oriented to the side that it comes from.
template <class Real>
struct Vertex {
    Vec3<Real> position;
    Vec3<Real> normal;  // unit, on the incoming ray's side
    std::uint32_t object;
    bool inside;  // the incoming ray ran inside the object
    std::uint32_t material;
};

// Sends the path away from the vertex on the side that it came from.
template <class Real>
PT_HD inline void leave_on_same_side(Path<Real>& path, const Vertex<Real>& vertex, const Vec3<Real>& direction) {
    path.origin = vertex.position;
    path.direction = direction;
    path.departed = ObjectSide::of(vertex.object, vertex.inside);
}

// Sends the path through the surface.
template <class Real>
PT_HD inline void leave_on_other_side(Path<Real>& path, const Vertex<Real>& vertex, const Vec3<Real>& direction) {
    path.origin = vertex.position;
    path.direction = direction;
    path.departed = ObjectSide::of(vertex.object, !vertex.inside);
}

template <class Real>
PT_HD inline void scatter_diffuse(Path<Real>& path, const Vertex<Real>& vertex, const Vec3<Real>& albedo, Real u,
                                  Real v) {
    path.throughput *= albedo;
    const Vec3<Real> direction = Frame<Real>(vertex.normal).to_world(cosine_hemisphere(u, v));
    leave_on_same_side(path, vertex, normalize(direction));
}

}  // namespace pt
