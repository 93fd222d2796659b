// The parameters of the wavefront's kernels, for both sides.
#pragma once

#include "kernels/film.h"
#include "variants/cuda/key_bounds.h"
#include "variants/cuda/parameters.h"
#include "variants/cuda/path_store.h"

namespace pt::cuda {

// Parameters of the kernel that starts path i in slot i: pixel i mod pixels, sample first_sample + i / pixels; with a
// cursor the first sample is read from there.
template <class Real>
struct GeneratePathsParameters {
    static constexpr const char* kernel = "generate_paths";
    SceneView<Real> scene;
    PathStore store;
    std::uint32_t* count;
    std::uint32_t pool;
    std::uint32_t first_sample;
    const std::uint32_t* cursor;
    HitCache<Real> cache;
};

// Parameters of the intersection kernel. With `keys`, it also writes the sort key of every position below `bound`:
// ended paths and positions beyond the count have the last one.
template <class Real>
struct IntersectPathsParameters {
    static constexpr const char* kernel = "intersect_paths";
    SceneView<Real> scene;
    PathStore store;
    const std::uint32_t* order;  // null: slot i at position i
    const std::uint32_t* count;
    std::uint32_t bound;
    StoredHit<Real>* hits;
    HitCache<Real> cache;
    SegmentNumber segment;
    SegmentCounts segments;
    std::uint32_t* keys;
    std::uint32_t bits;
    std::uint32_t chunk;  // slots; read by keys by chunk only
    std::uint32_t last_key;
    KeyBounds bounds;
};

// Parameters of the kernel that writes the sort keys of rays that are yet to be traced: ended paths and positions
// beyond the count have the last one.
struct WriteRayKeysParameters {
    static constexpr const char* kernel = "write_ray_keys";
    PathStore store;
    const std::uint32_t* order;
    const std::uint32_t* count;
    std::uint32_t bound;
    std::uint32_t* keys;
    std::uint32_t last_key;
    KeyBounds bounds;
};

template <class Real>
struct ShadePathsParameters {
    static constexpr const char* kernel = "shade_paths";
    SceneView<Real> scene;
    FilmView film;
    PathStore store;
    const std::uint32_t* order;
    const std::uint32_t* count;
    const StoredHit<Real>* hits;
    Totals* totals;
};

}  // namespace pt::cuda
