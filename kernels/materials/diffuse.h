// Lambertian reflection, sampled by the cosine: BSDF * cosine / density = albedo.
#pragma once

#include "kernels/sampling.h"
#include "kernels/scattering.h"

namespace pt {

// The Lambertian lobe with the interface of the other lobes.
template <class Real>
struct DiffuseLobe {
    static constexpr bool transmits = false, may_be_opaque = false;
    Vec3<Real> albedo;

    PT_HD LobeValue<Real> towards(const Vec3<Real>&, Real cosine) const {
        return {albedo, cosine * (Real(1) / pi<Real>)};
    }
};

// Frame::to_world for a normal along a coordinate axis: the frame's entries are 0, 1 and -1, so coordinates are only
// permuted and negated. Returns false if a coordinate is 0, unless samples are approximate: only the sums in to_world
// give that zero the right sign.
template <class Real>
PT_HD inline bool axis_to_world(const SurfaceId& face, const Vec3<Real>& local, Vec3<Real>& world) {
    const Real sign = face.face_looks_up() ? Real(1) : Real(-1);
    const std::uint32_t axis = face.face_axis();
    const Real along = sign * local.z;
    world = {axis == 0 ? along : local.x,
             axis == 1   ? along
             : axis == 2 ? sign * local.y
                         : local.y,
             axis == 2 ? along : -sign * (axis == 0 ? local.x : local.y)};
    return draws_approximately<Real> || local.x * local.y * local.z != Real(0);
}

// Scatters the path by a Lambertian surface, in a direction that two random words of 32 bits give.
template <class Config>
PT_HD inline void scatter_diffuse(Path<typename Config::Real>& path, const Vertex<typename Config::Real>& vertex,
                                  const Vec3<typename Config::Real>& albedo, std::uint32_t u, std::uint32_t v) {
    using Real = typename Config::Real;
    path.throughput *= albedo;
    const Vec3<Real> local = cosine_hemisphere_of_square(symmetric_interval<Real>(u), symmetric_interval<Real>(v));
    Vec3<Real> direction;
    if (!has<Config>(Feature::enclosure) || !vertex.hit.has_face() || !axis_to_world(vertex.hit, local, direction)) {
        direction = Frame<Real>(vertex.normal()).to_world(local);
    }
    // The direction is not renormalised: that takes nine operations, and only sums in Frame round its length off 1.
    leave_on_same_side(path, vertex, direction);
}

// Shades a vertex's diffuse lobe: connects it to a light where the variant asks for it, and then samples it. The last
// vertex of a final-bounce path is connected only. Returns whether the path goes on.
template <class At>
PT_HD inline bool shade_diffuse(const At& at, const Vec3<typename At::Real>& albedo) {
    using Config = typename At::Config;
    using Real = typename At::Real;
    Path<Real>& path = at.path;
    if constexpr (has<Config>(Feature::final_bounce)) {
        if (at.is_last) {
            at.count_connections(connect<Config>(at.scene, at.traced, path, at.vertex, albedo, at.words));
            return false;
        }
    }
    bool is_connected = false;
    if constexpr (has<Config>(Feature::next_event)) {
        is_connected = at.scene.next_event != 0;
        if (is_connected) {
            at.count_connections(
                connect_next_event<Config>(at.scene, at.traced, path, at.vertex, DiffuseLobe<Real>{albedo}));
        }
    }
    scatter_diffuse<Config>(path, at.vertex, albedo, at.words.y, at.words.z);
    if (is_connected) {
        if constexpr (has<Config>(Feature::multiple_importance)) {
            constexpr Real least = Real(0x1p-60);
            path.bsdf_pdf =
                kept_pdf<Config>(path, max(at.vertex.dot_normal(path.direction), least) * (Real(1) / pi<Real>));
        } else {
            // Where MIS does not weigh the lights that are hit, the stored pdf may be any number but 0, which would
            // mean that the vertex was not connected.
            path.bsdf_pdf = Real(1);
        }
    }
    return true;
}

template <class Real>
struct DiffuseMaterial {
    template <class At>
    PT_HD static bool scatter(const At& at) {
        return shade_diffuse(at, at.surface.colour);
    }
};

}  // namespace pt
