// Adjoint-driven Russian roulette and splitting. The expected contribution of a path is its throughput times an
// estimate of the radiance that leaves the vertex towards it, over an estimate of its pixel's value. A path below the
// weight window is likely to be ended before it scatters, a path above the window is split into several branches
// (kernels/path_tree.h), and within the window neither happens. The estimates come from separate paths
// (harness/render/adjoint_table.h); whatever they are, the mean of the image is the same.
// Vorba and Krivanek, "Adjoint-Driven Russian Roulette and Splitting in Light Transport Simulation", SIGGRAPH 2016.
#pragma once

#include "kernels/vertex.h"

namespace pt {

// Bounds of adjoint-driven Russian roulette: the least survival probability, and the most throughput to which a
// survivor is scaled up. Without them an estimate that is far too small would leave samples beyond the film's range.
template <class Real>
inline constexpr Real least_survival = Real(0.0625);
template <class Real>
inline constexpr Real most_carried = Real(64);

template <class Real>
struct AdjointCache {
    Vec3<Real> low;  // lowest corner of the adjoint grid, in scene units from the eye
    Vec3<Real> cells_a_unit;
    std::uint32_t cells;  // number of the adjoint grid's cells along each axis
    // Weight window, from lowest to highest, on a path's expected contribution in units of its pixel's value.
    Real lowest, highest;
    std::uint32_t most_branches;  // most branches into which a path splits at a vertex; 1: paths do not split
    // Adjoint estimates, relative to the image's mean. by_place: the radiance that paths bring from a grid cell and
    // side, per throughput there; by_segment: a factor per number of segments; by_pixel: 1 / each pixel's value.
    View<float> by_place;
    View<float> by_segment;
    View<float> by_pixel;
};

// Returns which of the six directions +-x, +-y and +-z a unit vector is nearest to, as a number from 0 to 5: twice the
// axis, and 1 more if the vector looks down that axis.
template <class Real>
PT_HD inline std::uint32_t nearest_side(const Vec3<Real>& normal) {
    const Vec3<Real> size{absolute(normal.x), absolute(normal.y), absolute(normal.z)};
    const std::uint32_t axis = size.x >= size.y && size.x >= size.z ? 0u : size.y >= size.z ? 1u : 2u;
    return 2 * axis + (component_of(normal, axis) < Real(0) ? 1u : 0u);
}

// Index, from 0 to cells - 1, of the adjoint grid's cell along one axis for a coordinate in units of cells. A
// coordinate outside the grid belongs to the outermost cell.
template <class Real>
PT_HD inline std::uint32_t cell_along(Real coordinate, std::uint32_t cells) {
    return coordinate > Real(0) ? static_cast<std::uint32_t>(min(coordinate, static_cast<Real>(cells - 1))) : 0u;
}

template <class Real>
PT_HD inline std::uint32_t adjoint_place(const AdjointCache<Real>& cache, const Vec3<Real>& position,
                                         const Vec3<Real>& normal) {
    const Vec3<Real> cell = (position - cache.low) * cache.cells_a_unit;
    const std::uint32_t x = cell_along(cell.x, cache.cells);
    const std::uint32_t y = cell_along(cell.y, cache.cells);
    const std::uint32_t z = cell_along(cell.z, cache.cells);
    return ((nearest_side(normal) * cache.cells + z) * cache.cells + y) * cache.cells + x;
}

template <class Real>
PT_HD inline Real sum_of_channels(const Vec3<Real>& colour) {
    return colour.x + colour.y + colour.z;
}

// Expected contribution of a path at a vertex, after `segments` segments, as a share of its pixel's value.
template <class Real>
PT_HD inline Real expected_share(const AdjointCache<Real>& cache, const Path<Real>& path, const Vertex<Real>& vertex,
                                 std::uint32_t segments) {
    const std::uint32_t step = min(segments, cache.by_segment.size) - 1;
    const Real place = static_cast<Real>(cache.by_place[adjoint_place(cache, vertex.position, vertex.normal())]);
    return sum_of_channels(path.throughput) * place * static_cast<Real>(cache.by_segment[step]) *
           static_cast<Real>(cache.by_pixel[path.pixel]);
}

// Survival probability of a path in adjoint-driven Russian roulette: 1 within the weight window and above it. An
// expected contribution that is NaN does not end the path, so the film will count it.
template <class Real>
PT_HD inline Real survival_probability(Real share, Real lowest, const Vec3<Real>& throughput) {
    const Real wanted = min(share / lowest, Real(1));
    const Real carried = max(throughput.x, max(throughput.y, throughput.z));
    return min(max(wanted, max(least_survival<Real>, carried * (Real(1) / most_carried<Real>))), Real(1));
}

// Number of branches that a path splits into by its expected contribution: 1 within the weight window and below it.
template <class Real>
PT_HD inline std::uint32_t branch_count(Real share, Real highest, std::uint32_t most) {
    return share > highest ? 1 + static_cast<std::uint32_t>(min(share / highest, static_cast<Real>(most - 1))) : 1u;
}

// Plays adjoint-driven Russian roulette with u in [0, 1) and scales the throughput of a path that survives. Returns
// whether the path goes on.
template <class Real>
PT_HD inline bool survives_by_share(Path<Real>& path, Real share, Real lowest, Real u) {
    const Real probability = survival_probability(share, lowest, path.throughput);
    if (u >= probability) {
        return false;
    }
    if (probability < Real(1)) {
        path.throughput *= Real(1) / probability;
    }
    return true;
}

// Branch policy of kernels without path splitting: at most adjoint-driven roulette is played before a path scatters.
struct OneBranch {
    template <class Config>
    static constexpr bool acts_in = has<Config>(Feature::adjoint_roulette);
    // Whether a path is a branch that resumes at the vertex where it split, and so has arrived at that vertex before.
    PT_HD static constexpr bool resumes() { return false; }
    // Plays adjoint-driven Russian roulette before a path scatters, with u in [0, 1). Returns whether the path goes on.
    template <class Config>
    PT_HD bool goes_on(const SceneView<typename Config::Real>& scene, Path<typename Config::Real>& path,
                       const Vertex<typename Config::Real>& vertex, const Hit<typename Config::Real>&,
                       typename Config::Real u) const {
        if (scene.adjoint == nullptr) {
            return true;
        }
        const auto share = expected_share(*scene.adjoint, path, vertex, segments_of<Config>(path));
        return survives_by_share(path, share, scene.adjoint->lowest, u);
    }
};

}  // namespace pt
