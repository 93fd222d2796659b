// Sort keys of paths whose rays have been traced. Device code, which a program includes after the choice's sort_key.
#pragma once

#include "variants/cuda/device/device.cuh"
#include "variants/cuda/device/key_bounds.h"

namespace pt::cuda {

// Sort key of a path by its hit: the material (the number of materials after a miss), then the bits that the axis
// sort_key adds. With sort_key by chunk: the chunk that the path's slot lies in, then the material.
__device__ inline std::uint32_t key_of(const ::Scene& scene, const Ray<Real>& ray, const Hit<Real>& hit,
                                       std::uint32_t slot, std::uint32_t bits, std::uint32_t chunk,
                                       const KeyBounds& bounds) {
    const std::uint32_t material = hit.side.exists() ? scene.object_material[hit.side.object()] : scene.materials.size;
    if constexpr (::sort_key::by_chunk) {
        return slot / chunk * (scene.materials.size + 1) + material;
    } else {
        return (material << bits) | ::sort_key::rest(ray, hit, bounds);
    }
}

}  // namespace pt::cuda
