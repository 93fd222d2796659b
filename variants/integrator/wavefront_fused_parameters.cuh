// The parameters of the fused wavefront's kernels, for both sides.
#pragma once

#include "kernels/film.h"
#include "variants/cuda/parameters.h"
#include "variants/cuda/path_store.h"

namespace pt::cuda {

// Parameters of the kernel that starts path i (pixel i mod pixels, sample first_sample + i / pixels) and traces its
// first bounce; with a cursor the first sample is read from there.
template <class Real>
struct FirstBounceParameters {
    static constexpr const char* kernel = "first_bounce";
    SceneView<Real> scene;
    FilmView film;
    PathStore out;
    std::uint32_t* out_count;
    std::uint32_t pool;
    std::uint32_t first_sample;
    const std::uint32_t* cursor;
    HitCache<Real> cache;
    Totals* totals;
    SegmentCounts segments;
};

// Parameters of the kernel for one bounce of the paths at order[0..*in_count-1] of `in` (no order: at 0..*in_count-1;
// where the kernel appends: as located).
template <class Real>
struct NextBounceParameters {
    static constexpr const char* kernel = "next_bounce";
    SceneView<Real> scene;
    FilmView film;
    PathStore in;
    const std::uint32_t* order;
    const std::uint32_t* in_count;
    PathStore out;
    std::uint32_t* out_count;
    SegmentNumber segment;
    Totals* totals;
    SegmentCounts segments;
};

}  // namespace pt::cuda
