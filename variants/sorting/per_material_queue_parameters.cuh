// The parameters of per_material_queue's kernel, for both sides.
#pragma once

#include <cstdint>

namespace pt::cuda {

// Parameters of the kernel that appends slot numbers to one queue a material: queue k holds `capacity` slots from
// queues + k * capacity.
struct AppendToQueuesParameters {
    static constexpr const char* kernel = "append_to_queues";
    const std::uint32_t* keys;
    const std::uint32_t* order;  // null: slot i at position i
    const std::uint32_t* count;
    std::uint32_t queue_count;
    std::uint32_t capacity;
    std::uint32_t* queues;
    std::uint32_t* counts;
};

}  // namespace pt::cuda
