// Functions that find the slot at a position of a queue, and the path of a given number in a batch of samples.
#pragma once

#include "variants/cuda/device/device.cuh"

namespace pt::cuda {

// The slot of the path at a position of the queue; without an index order slot i is at position i.
__device__ inline std::uint32_t slot_at(const std::uint32_t* order, std::uint32_t position) {
    return order != nullptr ? order[position] : position;
}

// Start of path n of a batch, which is of pixel n mod pixels and sample first_sample + n / pixels.
__device__ inline ::Path path_of_number(const ::Scene& scene, std::uint32_t number, std::uint32_t first_sample,
                                        const ::HitCache& cache) {
    const std::uint32_t pixels = own_pixels(scene);
    const std::uint32_t pixel = image_pixel(number % pixels, scene.camera.width);
    return first_path(scene, pixel, first_sample + number / pixels, cache);
}

}  // namespace pt::cuda
