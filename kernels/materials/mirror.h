// Perfect specular reflection (material type mirror).
#pragma once

#include "kernels/boundary.h"
#include "kernels/scattering.h"

namespace pt {

template <class Real>
PT_HD inline void scatter_mirror(Path<Real>& path, const Vertex<Real>& vertex, const Vec3<Real>& reflectance) {
    path.throughput *= reflectance;
    leave_on_same_side(path, vertex, reflect(path.direction, vertex.normal()));
}

template <class Real>
struct MirrorMaterial {
    template <class At>
    PT_HD static bool scatter(const At& at) {
        scatter_mirror(at.path, at.vertex, at.surface.colour);
        return true;
    }
};

}  // namespace pt
