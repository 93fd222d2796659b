// What the host's and the device's side of rays_optix share.
#pragma once

#include <cstdint>

#include <optix.h>

#include "harness/rays/ray_batch.h"

namespace pt::rays {

// A batch of rays and where their hits go. The launch's index is the ray's.
struct OptixBatch {
    OptixTraversableHandle tree;
    const Ray* rays;
    Hit* hits;
    std::uint32_t any;  // 1: whether there is a hit, not which
};

}  // namespace pt::rays
