// Device code of rays_optix: each thread traces one ray by OptiX's own traversal of built-in triangles.
#include <optix.h>

#include "tools/rays/rays_optix.h"

extern "C" {
__constant__ pt::rays::OptixBatch batch;
}

extern "C" __global__ void __raygen__trace() {
    const std::uint32_t i = optixGetLaunchIndex().x;
    const float4* const words = reinterpret_cast<const float4*>(batch.rays + i);
    const float4 origin = words[0], direction = words[1];
    const unsigned flags =
        OPTIX_RAY_FLAG_DISABLE_ANYHIT | (batch.any != 0 ? OPTIX_RAY_FLAG_TERMINATE_ON_FIRST_HIT : 0u);
    optixTraverse(batch.tree, make_float3(origin.x, origin.y, origin.z),
                  make_float3(direction.x, direction.y, direction.z), 0.0f, origin.w, 0.0f, OptixVisibilityMask(255),
                  flags, 0, 1, 0);
    batch.hits[i] = optixHitObjectIsHit() ? pt::rays::Hit{optixHitObjectGetRayTmax(), optixHitObjectGetPrimitiveIndex()}
                                          : pt::rays::Hit{origin.w, pt::rays::no_primitive};
}

extern "C" __global__ void __miss__nothing() {}
extern "C" __global__ void __closesthit__nothing() {}
