// Perfect specular reflection.
#pragma once

#include "kernels/diffuse.h"

namespace pt {

template <class Real>
PT_HD inline Vec3<Real> reflect(const Vec3<Real>& direction, const Vec3<Real>& normal) {
    return renormalize(direction - normal * (Real(2) * dot(direction, normal)));
}

template <class Real>
PT_HD inline void scatter_mirror(Path<Real>& path, const Vertex<Real>& vertex, const Vec3<Real>& reflectance) {
    path.throughput *= reflectance;
    leave_on_same_side(path, vertex, reflect(path.direction, vertex.normal()));
}

}  // namespace pt
