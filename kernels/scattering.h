// What a material's scatter() is given at a path vertex, and what materials share: connecting their lobes to lights,
// and colours and roughnesses that may be textures.
#pragma once

#include "kernels/absorption.h"
#include "kernels/next_event.h"
#include "kernels/texture.h"

namespace pt {

// GGX roughness (alpha) at the vertex at the end of the path's ray: the material's, unless it is a texture.
template <class Config>
PT_HD inline typename Config::Real facet_width(const SceneView<typename Config::Real>& scene,
                                               const Path<typename Config::Real>& path, const VertexOf<Config>& vertex,
                                               typename Config::Real of_material) {
    using Real = typename Config::Real;
    Real alpha = of_material;
    if constexpr (has<Config>(Feature::textures)) {
        Hit<Real> hit;
        hit.side = vertex.hit;
        hit.primitive = vertex.primitive;
        put_roughness<Config>(alpha, scene, ray_of(path), hit, vertex.position, geometric_normal<Config>(vertex));
    }
    return alpha;
}

// A path at a vertex that is about to scatter. A material's scatter() leaves the path with its next direction and
// throughput, and returns whether the path goes on.
template <class ConfigT, class Counters, class Walk>
struct Scattering {
    using Config = ConfigT;
    using Real = typename Config::Real;

    const SceneView<Real>& scene;
    const SceneView<Real>& traced;  // the scene in the form that rays traverse
    Path<Real>& path;
    const VertexOf<Config>& vertex;
    const Surface<Real>& surface;
    const RandomWords& words;
    bool is_last;  // last vertex of a final-bounce path: a diffuse lobe is connected only
    Counters& counters;
    Walk& walk;  // subsurface walk, if one begins at this vertex

    PT_HD Real random_lobe() const { return unit_interval<Real>(words.x); }

    PT_HD void count_connections(std::uint32_t connections) const {
        counters.rays += connections;
        counters.connections += connections;
    }

    // Connects the vertex to a light if the variant asks for it and the lobe is wide enough; returns whether it did.
    template <class Lobe>
    PT_HD bool connect_if_wide(const Lobe& lobe) const {
        bool is_connected = false;
        if constexpr (has<Config>(Feature::next_event)) {
            is_connected = scene.next_event != 0 && lobe.is_connectable();
            if (is_connected) {
                count_connections(connect_next_event<Config>(scene, traced, path, vertex, lobe));
            }
        }
        return is_connected;
    }

    PT_HD Real roughness(Real of_material) const { return facet_width<Config>(scene, path, vertex, of_material); }

    // Colour to shade with: the surface's in kernels with textures, else the material's.
    PT_HD const Vec3<Real>& colour(const Vec3<Real>& of_material) const {
        if constexpr (has<Config>(Feature::textures)) {
            return surface.colour;
        } else {
            return of_material;
        }
    }

    // Samples a lobe that may transmit light (the cosine is then below 0), and sends the path by the sample. Returns
    // whether the path goes on: it does not where a facet sends it to the wrong side of the surface.
    template <class Lobe>
    PT_HD bool leave_by(const Lobe& lobe, LobeSample<Real>& sample) const {
        sample = lobe.sample(random_lobe(), unit_interval<Real>(words.y), unit_interval<Real>(words.z));
        if (sample.cosine == Real(0)) {
            return false;
        }
        path.throughput *= sample.value.weight;
        if (sample.cosine > Real(0)) {
            leave_on_same_side(path, vertex, sample.direction);
        } else {
            leave_on_other_side(path, vertex, sample.direction);
            if constexpr (has<Config>(Feature::absorption)) {
                path.medium = lobe.medium_beyond;
            }
        }
        return true;
    }
};

}  // namespace pt
