// Absorption by the medium within a dielectric, by Beer-Lambert.
#pragma once

#include "kernels/vertex.h"

namespace pt {

// Index of the material whose medium absorbs along the path once the path has crossed the surface at this vertex, or
// `no_medium`.
template <class Real>
PT_HD inline std::uint32_t medium_behind(const Vertex<Real>& vertex, const Material<Real>& material) {
    return vertex.inside || material.absorbs == 0 ? Path<Real>::no_medium : vertex.material;
}

// Transmittance of an absorbing medium over a distance in scene units, by Beer-Lambert.
template <class Real>
PT_HD inline Vec3<Real> transmittance(const Material<Real>& medium, Real distance) {
    return {exponential(-medium.sigma_a.x * distance), exponential(-medium.sigma_a.y * distance),
            exponential(-medium.sigma_a.z * distance)};
}

// Absorbs the throughput along the path's segment that ends at this vertex, which ran `distance` through the medium.
template <class Real>
PT_HD inline void attenuate(Path<Real>& path, const Material<Real>& medium, Real distance) {
    path.throughput *= transmittance(medium, distance);
}

}  // namespace pt
