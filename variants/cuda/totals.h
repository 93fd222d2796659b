// What the kernels of a render count, in device memory. Shared by host, nvcc and NVRTC.
#pragma once

#include "kernels/shade.h"

namespace pt::cuda {

struct Totals {
    PathCounters paths;               // paths.rays: rays traced, connections to lights included
    std::uint64_t cache_fills = 0;    // camera rays traced for the first-bounce cache
    std::uint64_t cache_uses = 0;     // paths that took their first hit from it
    std::uint64_t sorted = 0;         // paths that were given a sort key
};

// Counts by segment (0: the camera ray's), over all batches of a render.
struct SegmentCounts {
    std::uint64_t* live = nullptr;     // paths that were alive when the segment was traced
    std::uint64_t* in_play = nullptr;  // paths that were looked at, alive or not
};

// Kept first hits: `rays` camera rays a pixel, of which sample s uses number s % rays. Null hits: no cache.
template <class Real>
struct HitCache {
    Hit<Real>* hits = nullptr;
    std::uint32_t rays = 0;
};

}  // namespace pt::cuda
