// Paths that are on a subsurface walk while they lie in a queue. A kernel that shades puts them into a list; a kernel
// of their own (walk_paths.cuh) takes their steps. A warp that shades then waits for no walk, and a warp that walks is
// full. The rest of a shading kernel needs no registers for walks. For NVRTC, nvcc and the host compiler alike.
#pragma once

#include "kernels/film.h"
#include "kernels/materials/subsurface.h"
#include "variants/cuda/device/list_counts.h"
#include "variants/cuda/device/parameters.h"
#include "variants/cuda/device/path_store.h"

namespace pt::cuda {

// A path on a subsurface walk. The rest of the path's state lies in its slot.
template <class Walk>
struct Walker {
    std::uint32_t slot;
    std::uint32_t place;  // queue position, if samplers are seeded by it; or part of the queue, where kernels append
    Walk walk;
};

template <class Real>
constexpr std::size_t walker_bytes(bool may_be_guided) {
    return may_be_guided ? sizeof(Walker<GuidedWalk<Real>>) : sizeof(Walker<Walk>);
}

// A list of walkers with room for every path of the queue. Null: kernels take walks where they shade.
struct WalkerList {
    void* walkers = nullptr;  // the list's walkers, of type Walker<WalkOf<..>>
    ListCounts* counts = nullptr;
};

// Parameters of the kernel that takes the subsurface walks of a list.
template <class Real>
struct WalkPathsParameters {
    static constexpr const char* kernel = "walk_paths";
    SceneView<Real> scene;
    FilmView film;
    WalkerList list;
    PathStore in;              // store of the walkers' paths
    PathStore out;             // store for paths that have left their body, unless out_count is null
    std::uint32_t* out_count;  // a counter for each part of the queue `out`; null: paths stay in their slots
    std::uint32_t parts;
    SegmentNumber segment;
    Totals* totals;
};

}  // namespace pt::cuda
