// No sort of one queue but a queue a material: after the intersection each path's slot is appended to the queue of the
// material that it hit (and one for the paths that left the scene), and shading runs once a queue.
#pragma once

#include "variants/cuda/device.cuh"
#include "variants/sorting/per_material_queue_parameters.cuh"

// Appends slot numbers to one queue a material: queue k holds `capacity` slots from queues + k * capacity. Lanes of one
// key share one atomic operation.
PT_KERNEL(append_to_queues, pt::cuda::AppendToQueuesParameters,
          (const std::uint32_t* keys, const std::uint32_t* order, const std::uint32_t* count, std::uint32_t queue_count,
           std::uint32_t capacity, std::uint32_t* queues, std::uint32_t* counts)) {
    const std::uint32_t i = pt::cuda::thread_number();
    const std::uint32_t key = i < *count ? keys[i] : queue_count;
    const unsigned together = __match_any_sync(0xffffffffu, key);
    const int leader = __ffs(static_cast<int>(together)) - 1;
    std::uint32_t first = 0;
    if (key < queue_count && pt::cuda::lane() == static_cast<unsigned>(leader)) {
        first = atomicAdd(&counts[key], static_cast<unsigned>(__popc(together)));
    }
    first = __shfl_sync(0xffffffffu, first, leader);
    if (key < queue_count) {
        const std::uint32_t position =
            first + static_cast<std::uint32_t>(__popc(together & ((1u << pt::cuda::lane()) - 1u)));
        queues[static_cast<std::size_t>(key) * capacity + position] = order != nullptr ? order[i] : i;
    }
}
