// Declarations shared by the host and device code of rays_optix.
#pragma once

#include <cstdint>

#include <optix.h>

#include "harness/rays/ray_batch.h"

namespace pt::rays {

// A batch of rays with the buffer for its hits; the launch index is the index of the ray.
struct OptixBatch {
    OptixTraversableHandle tree;
    const Ray* rays;
    Hit* hits;
    std::uint32_t any;  // 1 for any-hit queries, which report whether there is a hit but not the closest one
};

}  // namespace pt::rays
