// A binary tree as it lies in a GPU's memory between a builder and an encoder there.
#pragma once

#include <cstdint>

namespace pt {

// Nodes 0 to n - 1 are the leaves, in the order of their Morton codes, one primitive each; inner nodes follow.
struct alignas(32) GpuNode {
    float low[3];
    std::uint32_t left;  // inner: a node; leaf: the primitive
    float high[3];
    std::uint32_t right;  // inner: a node
};

}  // namespace pt
