// Absorption by the medium within a dielectric, by Beer-Lambert.
#pragma once

#include "kernels/vertex.h"

namespace pt {

// Index of the material whose medium absorbs along the path once it has crossed the surface at the vertex, or
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

// Absorbs from the throughput along the path's segment, which ran `distance` through the medium up to the vertex.
template <class Real>
PT_HD inline void attenuate(Path<Real>& path, const Material<Real>& medium, Real distance) {
    path.throughput *= transmittance(medium, distance);
}

}  // namespace pt
