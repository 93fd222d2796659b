// A binary tree in GPU memory, as a GPU builder hands it to a GPU encoder.
#pragma once

#include <cstdint>

namespace pt {

// A node of a GPU-built tree: nodes 0 to n - 1 are leaves in Morton order, one primitive each; inner nodes follow.
struct alignas(32) GpuNode {
    float low[3];
    std::uint32_t left;  // inner node: number of its left child; leaf: its primitive
    float high[3];
    std::uint32_t right;  // inner node: number of its right child
};

}  // namespace pt
