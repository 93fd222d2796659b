// The parameters of the refilled wavefront's kernels, for both sides.
#pragma once

#include "kernels/film.h"
#include "variants/cuda/key_bounds.h"
#include "variants/cuda/parameters.h"
#include "variants/cuda/path_store.h"

namespace pt::cuda {

// The paths of one go, by number: path n is pixel n mod pixels, sample first_sample + n / pixels.
struct PathSupply {
    std::uint32_t* next;  // device: the path that is handed out next; total and beyond: none is left
    std::uint32_t total;
    std::uint32_t first_sample;
};

// How far the device has come, as it tells the host without being asked: a word in the host's memory, written when a
// round begins. Upper half: rounds before it; lower half: paths that these have handed out.
struct ProgressReport {
    std::uint64_t* word;
    std::uint32_t round;
};

// Parameters of the kernel that starts path n in slot n, for every slot.
template <class Real>
struct FillQueueParameters {
    static constexpr const char* kernel = "fill_queue";
    SceneView<Real> scene;
    PathStore store;
    std::uint32_t* count;
    std::uint32_t slots;
    PathSupply supply;
    HitCache<Real> cache;  // none: first_path takes one
};

// Parameters of the intersection kernel. With `keys`, it also writes the sort key of every position; ended paths have
// the last one.
template <class Real>
struct IntersectQueueParameters {
    static constexpr const char* kernel = "intersect_queue";
    SceneView<Real> scene;
    PathStore store;
    const std::uint32_t* order;  // null: slot i at position i
    std::uint32_t slots;
    StoredHit<Real>* hits;
    std::uint32_t* keys;
    std::uint32_t bits;
    std::uint32_t chunk;  // slots; read by keys by chunk only
    std::uint32_t last_key;
    KeyBounds bounds;
    PathSupply supply;
    ProgressReport report;
    Totals* totals;
};

// Shades the paths in slots order[0..*count-1]. The next path takes the slot of one that ends, but where
// supply.total is 0: no path is handed out then, and the slot waits for refill_queue.
template <class Real>
struct ShadeAndRefillParameters {
    static constexpr const char* kernel = "shade_and_refill";
    SceneView<Real> scene;
    FilmView film;
    PathStore store;
    const std::uint32_t* order;
    const std::uint32_t* count;
    const StoredHit<Real>* hits;
    PathSupply supply;
    HitCache<Real> cache;
    Totals* totals;
    std::uint64_t* ended;  // paths by their number of segments; null: not counted
};

// Parameters of the kernel that starts the next path in every slot whose path has ended.
template <class Real>
struct RefillQueueParameters {
    static constexpr const char* kernel = "refill_queue";
    SceneView<Real> scene;
    PathStore store;
    std::uint32_t slots;
    PathSupply supply;
    HitCache<Real> cache;
};

}  // namespace pt::cuda
