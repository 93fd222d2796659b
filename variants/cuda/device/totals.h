// What the kernels of a render count, in device memory. Shared by host, nvcc and NVRTC.
#pragma once

#include "kernels/health.h"
#include "kernels/shade.h"

namespace pt::cuda {

// Counters are kept in several copies, and a block adds to the one of its number: thousands of blocks adding to one
// address would wait for each other. The host adds the copies up.
inline constexpr std::uint32_t counter_copies = 64;

// Distance in words between the counters of a queue's parts, which puts them in different cache lines.
inline constexpr std::uint32_t counter_stride = 32;

struct Totals {
    PathCounters paths;             // paths.rays: rays traced, connections to lights included
    std::uint64_t cache_fills = 0;  // camera rays traced for the first-bounce cache
    std::uint64_t cache_uses = 0;   // paths that took their first hit from the cache
};

// Rays and paths that each of the 1024 threads of the largest block can count so that their sum fits in 32 bits.
inline constexpr std::uint32_t few_rays = 1u << 22;

// Most segments of a path at which a render still keeps its counts by segment in several copies (counter_copies).
inline constexpr std::uint32_t few_segments = 4096;

// Counts by segment (0: the camera ray's), over all batches of a render; copy c of a segment's count is at
// segment * copies + c.
struct SegmentCounts {
    std::uint64_t* live = nullptr;     // number of paths that were alive as the segment was traced
    std::uint64_t* in_play = nullptr;  // number of paths in play as the segment was traced, alive or ended
    std::uint32_t copies = 1;
};

// Segment that a kernel traces: `number` or, in the loop of a CUDA graph, `number` plus the loop's count so far.
struct SegmentNumber {
    std::uint32_t number = 0;
    const std::uint32_t* offset = nullptr;  // count of the graph loop's segments, in device memory; null: no loop

    PT_HD std::uint32_t passed() const { return offset != nullptr ? *offset : 0; }
    PT_HD operator std::uint32_t() const { return number + passed(); }  // NOLINT: it is that number
};

// The first-bounce cache: the hits of `rays` camera rays a pixel, of which sample s uses number s % rays. Null hits:
// there is no cache.
template <class Real>
struct HitCache {
    StoredHit<Real>* hits = nullptr;
    std::uint32_t* primitives = nullptr;  // triangles of the cached hits; null in kernels without meshes
    std::uint32_t rays = 0;

    PT_HD std::size_t index(std::uint32_t pixel, std::uint32_t sample) const {
        return static_cast<std::size_t>(pixel) * rays + sample % rays;
    }
    template <class Config>
    PT_HD Hit<Real> load(std::size_t i) const {
        const StoredHit<Real> hit = hits[i];
        return {hit.t, hit.side, has<Config>(Feature::mesh) ? primitives[i] : 0u};
    }
    template <class Config>
    PT_HD void store(std::size_t i, const Hit<Real>& hit) const {
        hits[i] = {hit.t, hit.side};
        if constexpr (has<Config>(Feature::mesh)) {
            primitives[i] = hit.primitive;
        }
    }
};

}  // namespace pt::cuda
